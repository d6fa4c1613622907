/* Random numbers of a road user for a seed. */
#ifndef RANDOM_DRAW_H
#define RANDOM_DRAW_H

#include "stream_traffic.h"

/* From 0 to less than 1: the *number*-th one of that id (splitmix64; G. Steele, D. Lea, C. Flood: OOPSLA 2014). */
static inline double random_draw(const stream_traffic *self, int32_t id, int32_t number) {
    uint64_t z = (uint64_t)self->par.seed * 1000003u + (uint64_t)id * 64u + (uint64_t)number;
    z = (z + 1) * 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

#endif
