/* What all sensors share: their noise, and what rain and snow take from a wave. */
#ifndef SENSING_H
#define SENSING_H

#include <stdint.h>

/* SplitMix64 (Steele, Lea, Flood 2014): uniform on (0, 1], never 0 so that its logarithm exists. */
double sensing_uniform(uint64_t *state);

/* What a rain or snow of *rate* m/s takes from a wave, 1/m, one way: loss * r^exponent dB/km at r mm/h. */
double sensing_attenuation(double rate, double loss, double exponent);

#endif
