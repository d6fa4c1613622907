#include "sensing.h"

#include <math.h>

#define DEGREES 57.29577951308232 /* in 1 rad */
#define GAMMA UINT64_C(0x9E3779B97F4A7C15)

double sensing_uniform(uint64_t *state) {
    uint64_t z = *state += GAMMA;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    z ^= z >> 31;
    return (double)((z >> 11) + 1) * 0x1p-53;
}

void sensing_skip(uint64_t *state, uint64_t count) { *state += count * GAMMA; }

double sensing_attenuation(double rate, double loss, double exponent) {
    if (!(rate > 0 && loss > 0)) return 0;
    return loss * pow(rate * 3.6e6, exponent) * (log(10) / 10 / 1000);
}

double sensing_veil(double beside, double above, double glare) {
    double facing = cos(above) * cos(beside);
    if (!(glare > 0 && facing > 0)) return 0;
    double degrees = fmax(acos(fmin(facing, 1)) * DEGREES, 1);
    return 10 * glare * facing / (degrees * degrees);
}
