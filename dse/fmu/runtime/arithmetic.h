/* Modelica's scalar operators that C does not have: well defined for every double, NaN included. */
#ifndef DSE_ARITHMETIC_H
#define DSE_ARITHMETIC_H

#include <math.h>

/* The least; NaN if either is NaN. */
static inline double dse_min(double a, double b) {
    return (a < b || a != a) ? a : b;
}

/* The greatest; NaN if either is NaN. */
static inline double dse_max(double a, double b) {
    return (a > b || a != a) ? a : b;
}

/* -1, 0 or 1; NaN of NaN. */
static inline double dse_sign(double a) {
    return a > 0.0 ? 1.0 : a < 0.0 ? -1.0 : a;
}

/* base to the integer power *exponent*, a compile-time constant; 1 for the power 0. */
static inline double dse_whole_power(double base, int exponent) {
    const int is_below = exponent < 0;
    unsigned rest = is_below ? (unsigned)-exponent : (unsigned)exponent;
    double power = 1.0;
    double factor = base;
    switch (rest) {
    case 1:
        power = base;
        break;
    case 2:
        power = base * base;
        break;
    case 3:
        power = base * base * base;
        break;
    case 4:
        factor = base * base;
        power = factor * factor;
        break;
    default:
        for (; rest; rest >>= 1) {
            if (rest & 1u) {
                power *= factor;
            }
            factor *= factor;
        }
        break;
    }
    return is_below ? 1.0 / power : power;
}

/* Place from 0 of the element *index* from 1 of *size* elements; -1 if there is none. */
static inline int dse_index(double index, int size) {
    const int place = index >= 1.0 && index <= (double)size ? (int)index : 0;
    return (double)place == index ? place - 1 : -1;
}

#endif
