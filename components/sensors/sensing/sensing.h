/* What all sensors share: their noise, what rain and snow take from a wave, and what the sun adds. */
#ifndef SENSING_H
#define SENSING_H

#include <stdint.h>

/* SplitMix64 (Steele, Lea, Flood 2014): uniform on (0, 1], never 0 so that its logarithm exists. */
double sensing_uniform(uint64_t *state);

/* As if *count* numbers had been drawn. */
void sensing_skip(uint64_t *state, uint64_t count);

/* What a rain or snow of *rate* m/s takes from a wave, 1/m, one way: loss * r^exponent dB/km at r mm/h. */
double sensing_attenuation(double rate, double loss, double exponent);

/* How much more light than the surroundings send the sun's scattered light lays over all that one sees, with the sun *beside*
 * (rad, either side) and *above* where one looks: 10 E / (L theta^2), *glare* is E / L in lx per cd/m2, theta degrees to the sun, not nearer than 1 and nothing from 90 on. Stiles and
 * Holladay's formula is of light in an eye (CIE 31, 1976: 1 to 30 degrees); that a windscreen and a lens scatter as much is
 * assumed. Contrasts become 1 / (1 + veil) of what they were. */
double sensing_veil(double beside, double above, double glare);

#endif
