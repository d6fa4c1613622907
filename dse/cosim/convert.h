/* Between the table of doubles and the types FMI passes: exact, or refused. */
#ifndef DSE_COSIM_CONVERT_H
#define DSE_COSIM_CONVERT_H

#include "kernel.h"

#define EXACT_INTEGER 9007199254740992.0 /* 2^53: beyond it a double no longer tells integers apart */

/* Convert what the accessor returned to double; returns the first that is too large, or count. */
static int64_t widen(const Group *group)
{
    const int64_t count = group->count;
    double *values = group->values;
    switch (group->type) {
#define PLAIN(TYPE, C_TYPE)                                                                                           \
    case TYPE:                                                                                                        \
        for (int64_t i = 0; i < count; i++)                                                                           \
            values[i] = (double)((const C_TYPE *)group->room)[i];                                                     \
        break;
#define CHECKED(TYPE, C_TYPE)                                                                                         \
    case TYPE:                                                                                                        \
        for (int64_t i = 0; i < count; i++) {                                                                         \
            C_TYPE whole = ((const C_TYPE *)group->room)[i];                                                          \
            values[i] = (double)whole;                                                                                \
            if (values[i] > EXACT_INTEGER || values[i] < -EXACT_INTEGER || (C_TYPE)values[i] != whole)                \
                return i;                                                                                             \
        }                                                                                                             \
        break;
#define TRUTH(TYPE, C_TYPE)                                                                                           \
    case TYPE:                                                                                                        \
        for (int64_t i = 0; i < count; i++)                                                                           \
            values[i] = ((C_TYPE *)group->room)[i] = ((const C_TYPE *)group->room)[i] != 0;                           \
        break;
        PLAIN(FLOAT32, float)
        PLAIN(INT8, int8_t)
        PLAIN(UINT8, uint8_t)
        PLAIN(INT16, int16_t)
        PLAIN(UINT16, uint16_t)
        PLAIN(INT32, int32_t)
        PLAIN(UINT32, uint32_t)
        CHECKED(INT64, int64_t)
        CHECKED(UINT64, uint64_t)
        TRUTH(BOOLEAN, bool)
        TRUTH(FMI2_BOOLEAN, int32_t)
    }
    return count;
}

/* Convert a group's values to what its accessor wants; returns the first that does not fit, or count. */
static int64_t narrow(const Group *group)
{
    const int64_t count = group->count;
    const double *values = group->values;
    switch (group->type) {
    case FLOAT32:
        for (int64_t i = 0; i < count; i++)
            ((float *)group->room)[i] = (float)values[i];
        break;
#define WHOLE(TYPE, C_TYPE, LOW, HIGH)                                                                                \
    case TYPE:                                                                                                        \
        for (int64_t i = 0; i < count; i++) {                                                                         \
            double value = values[i];                                                                                 \
            if (!(value >= (LOW) && value <= (HIGH)) || (double)(int64_t)value != value)                              \
                return i;                                                                                             \
            ((C_TYPE *)group->room)[i] = (C_TYPE)value;                                                               \
        }                                                                                                             \
        break;
#define EITHER(TYPE, C_TYPE)                                                                                          \
    case TYPE:                                                                                                        \
        for (int64_t i = 0; i < count; i++) {                                                                         \
            if (values[i] != 0.0 && values[i] != 1.0)                                                                 \
                return i;                                                                                             \
            ((C_TYPE *)group->room)[i] = values[i] == 1.0;                                                            \
        }                                                                                                             \
        break;
        WHOLE(INT8, int8_t, INT8_MIN, INT8_MAX)
        WHOLE(UINT8, uint8_t, 0, UINT8_MAX)
        WHOLE(INT16, int16_t, INT16_MIN, INT16_MAX)
        WHOLE(UINT16, uint16_t, 0, UINT16_MAX)
        WHOLE(INT32, int32_t, INT32_MIN, INT32_MAX)
        WHOLE(UINT32, uint32_t, 0, UINT32_MAX)
        WHOLE(INT64, int64_t, -EXACT_INTEGER, EXACT_INTEGER)
        WHOLE(UINT64, uint64_t, 0, EXACT_INTEGER)
        EITHER(BOOLEAN, bool)
        EITHER(FMI2_BOOLEAN, int32_t)
    }
    return count;
}

#endif
