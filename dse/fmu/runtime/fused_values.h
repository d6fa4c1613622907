/* Access to the components' members for a fused loop, as by FMI's accessors, without their messages. */
#ifndef DSE_FUSED_VALUES_H
#define DSE_FUSED_VALUES_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "csolve/fused_abi.h"

#if defined _WIN32
#define DSE_EXPORT __declspec(dllexport)
#else
#define DSE_EXPORT __attribute__((visibility("default")))
#endif

static inline char *dse_instance_at(const dse_fused_run *run, int64_t element) {
    return *(char *const *)((const char *)run->instances + element * run->stride);
}

#define DSE_MEMBER(name, type, wide)                                                                                   \
    static inline wide dse_get_##name(const char *from) {                                                              \
        type typed;                                                                                                    \
        memcpy(&typed, from, sizeof typed);                                                                            \
        return (wide)typed;                                                                                            \
    }                                                                                                                  \
    static inline void dse_put_##name(char *to, wide value) {                                                          \
        const type typed = (type)value;                                                                                \
        memcpy(to, &typed, sizeof typed);                                                                              \
    }

DSE_MEMBER(f64, double, double)
DSE_MEMBER(f32, float, double)
DSE_MEMBER(bool, bool, int64_t)
DSE_MEMBER(i8, int8_t, int64_t)
DSE_MEMBER(i16, int16_t, int64_t)
DSE_MEMBER(i32, int32_t, int64_t)
DSE_MEMBER(i64, int64_t, int64_t)
DSE_MEMBER(u8, uint8_t, int64_t)
DSE_MEMBER(u16, uint16_t, int64_t)
DSE_MEMBER(u32, uint32_t, int64_t)
DSE_MEMBER(u64, uint64_t, int64_t) /* a value beyond int64_t is read as a negative number */
DSE_MEMBER(whole, double, double)  /* a double with integer values only */

/* Whether *count* doubles that lie in a row are finite. The exponent of one that is not has all its bits set. */
static inline bool dse_are_finite(const char *from, int64_t count) {
    const uint64_t exponent = UINT64_C(0x7ff0000000000000), lowest = UINT64_C(0x0010000000000000);
    uint64_t found = 0;
    for (int64_t k = 0; k < count; k++) {
        uint64_t bits;
        memcpy(&bits, from + k * (int64_t)sizeof bits, sizeof bits);
        found |= (bits & exponent) + lowest;
    }
    return found >> 63 == 0;
}

static inline bool dse_is_within(int64_t value, int64_t lowest, int64_t highest) {
    return value >= lowest && value <= highest;
}

/* Whether *value* is an integer in a range of at most 62 bits; *whole* becomes the integer, else 0. */
static inline bool dse_is_whole(double value, int64_t lowest, int64_t highest, int64_t *whole) {
    const bool is_fit = value >= (double)lowest && value <= (double)highest && value == floor(value);
    *whole = is_fit ? (int64_t)value : 0;
    return is_fit;
}

/* Whether a float can represent *value*; other code reports infinities and NaN. */
static inline bool dse_is_float(double value) { return !isfinite(value) || fabs(value) <= (double)FLT_MAX; }

#endif
