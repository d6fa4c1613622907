#include "sensing.h"

#include <math.h>

double sensing_uniform(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    z ^= z >> 31;
    return (double)((z >> 11) + 1) * 0x1p-53;
}

double sensing_attenuation(double rate, double loss, double exponent) {
    if (!(rate > 0 && loss > 0)) return 0;
    return loss * pow(rate * 3.6e6, exponent) * (log(10) / 10 / 1000);
}
