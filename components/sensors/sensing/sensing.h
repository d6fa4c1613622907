/* Shared by all sensors: noise, attenuation by rain and snow, and the veil of the sun. */
#ifndef SENSING_H
#define SENSING_H

#include <stdint.h>

/* SplitMix64 (Steele, Lea, Flood 2014): uniform on (0, 1], never 0 so that its logarithm exists. */
double sensing_uniform(uint64_t *state);

/* Advances the state by *count* numbers. */
void sensing_skip(uint64_t *state, uint64_t count);

/* Two independent standard normal numbers, from two uniform ones (Box, Muller 1958). */
typedef struct {
    double first, second;
} sensing_pair;

sensing_pair sensing_normal(uint64_t *state);

/* The next value of a Gauss-Markov process of *deviation*; *fade*: exp(-time / correlation time), 0 for the first. */
double sensing_drifted(double last, double deviation, double fade, double normal);

/* Attenuation of a wave by rain or snow of *rate* m/s, 1/m, one way: loss * r^exponent dB/km at r mm/h. */
double sensing_attenuation(double rate, double loss, double exponent);

/* Veiling luminance of the sun's scattered light, relative to that of the surroundings, with the sun *beside* (rad,
 * either side) and *above* the viewing direction: 10 E / (L theta^2). *glare* is E / L in lx per cd/m2, theta degrees
 * to the sun, at least 1; 0 from 90 on. The formula of Stiles and Holladay is for an eye (CIE 31, 1976: 1 to 30
 * degrees); the same scatter is assumed for a windscreen and a lens. Contrasts are multiplied by 1 / (1 + veil). */
double sensing_veil(double beside, double above, double glare);

#endif
