/* Random numbers of the xorshift generators (S. Vigna, ACM Trans. Math. Softw. 42(4), 2016; public domain).
 *
 * A state is of whole numbers of 32 bits, as in Modelica's Math.Random: two a word, the lower half first. 2 numbers:
 * xorshift64*, whose next state is the product; 4: xorshift128+; 33: xorshift1024*, the last of which is the place.
 */
#ifndef DSE_RANDOM_H
#define DSE_RANDOM_H

#include <math.h>
#include <stdint.h>

enum { DSE_RANDOM_MOST = 33, DSE_RANDOM_TURNS = 10 };

/* Half number k of words, as a signed number. */
static inline double dse_random_half(const uint64_t *words, int k) {
    return (double)(int32_t)(uint32_t)(words[k / 2] >> (k % 2 * 32));
}

static inline uint64_t dse_random_64(uint64_t x) {
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    return x * UINT64_C(2685821657736338717);
}

/* From the state of *count* numbers: a number from 0 to 1 (which = 0), or number *which* of the next state.
 * Nonzero if the state is not of whole numbers of 32 bits. */
static inline int dse_random(double *result, int which, int count, const double *state) {
    uint64_t words[DSE_RANDOM_MOST / 2 + 1] = {0};
    for (int k = 0; k < count; k++) {
        if (!(fabs(state[k] + 0.5) < 2147483648.0) || floor(state[k]) != state[k]) {
            return 1;
        }
        words[k / 2] |= (uint64_t)(uint32_t)(int32_t)state[k] << (k % 2 * 32);
    }
    uint64_t drawn;
    if (count == 2) {
        drawn = words[0] = dse_random_64(words[0]);
    } else if (count == 4) {
        uint64_t s1 = words[0];
        const uint64_t s0 = words[1];
        s1 ^= s1 << 23;
        words[0] = s0;
        drawn = words[1] = (s1 ^ s0 ^ (s1 >> 17) ^ (s0 >> 26)) + s0;
    } else {
        uint64_t s0 = words[words[16] & 15];
        words[16] = (words[16] + 1) & 15;
        uint64_t s1 = words[words[16]];
        s1 ^= s1 << 31;
        s1 ^= s1 >> 11;
        s0 ^= s0 >> 30;
        words[words[16]] = s0 ^ s1;
        drawn = (s0 ^ s1) * UINT64_C(1181783497276652981);
    }
    *result = which ? dse_random_half(words, which - 1) : ldexp((double)(int64_t)drawn, -64) + 0.5;
    return 0;
}

/* Number *which* of the state that two seeds, local and global, begin: of 33 as of 4. Nonzero as before. */
static inline int dse_random_start(double *result, int which, const double *seeds) {
    double state[2] = {seeds[0] == 0 && seeds[1] == 0 ? 126247697 : seeds[0], seeds[1]};
    for (int turn = 0; turn < DSE_RANDOM_TURNS + (which - 1) / 2; turn++) {
        double next[2];
        if (dse_random(&next[0], 1, 2, state) || dse_random(&next[1], 2, 2, state)) {
            return 1;
        }
        state[0] = next[0];
        state[1] = next[1];
    }
    *result = state[(which - 1) % 2];
    return 0;
}

#endif
