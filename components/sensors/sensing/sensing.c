#include "sensing.h"

#include <math.h>

#define DEGREES 57.29577951308232 /* in 1 rad */
#define PI 3.141592653589793
#define GAMMA UINT64_C(0x9E3779B97F4A7C15)

double sensing_uniform(uint64_t *state) {
    uint64_t z = *state += GAMMA;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    z ^= z >> 31;
    return (double)((z >> 11) + 1) * 0x1p-53;
}

void sensing_skip(uint64_t *state, uint64_t count) { *state += count * GAMMA; }

sensing_pair sensing_normal(uint64_t *state) {
    double length = sqrt(-2 * log(sensing_uniform(state))), angle = 2 * PI * sensing_uniform(state);
    sensing_pair drawn = {length * cos(angle), length * sin(angle)};
    return drawn;
}

double sensing_drifted(double last, double deviation, double fade, double normal) {
    return fade * last + deviation * sqrt(1 - fade * fade) * normal;
}

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
