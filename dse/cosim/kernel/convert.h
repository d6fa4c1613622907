/* Conversion between the table of doubles and the types of FMI: exact, or refused. */
#ifndef DSE_COSIM_CONVERT_H
#define DSE_COSIM_CONVERT_H

#include "kernel.h"

#include <float.h>
#include <math.h>

#define EXACT_INTEGER 9007199254740992.0 /* 2^53: beyond it a double cannot represent all integers */

/* ---- types ---- */

/* Bytes of one value in the room of a group. */
static inline size_t size_of(int64_t type)
{
    static const uint8_t sizes[] = {8, 4, 1, 1, 2, 2, 4, 4, 8, 8, sizeof(bool), 4, 0, 0, 1};
    return sizes[type];
}

/* Convert the accessor's values to double; returns the first that is too large, or n_values. */
static int64_t widen(const Group *group)
{
    const int64_t count = group->n_values;
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
        PLAIN(FLOAT64, double)
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
        TRUTH(FMI1_BOOLEAN, char)
    }
    return count;
}

/* Convert n_values to the type of the group's accessor; returns the first that does not fit, or n_values. */
static int64_t narrow(const Group *group, const double *values)
{
    const int64_t count = group->n_values;
    switch (group->type) {
    case FLOAT64:
        for (int64_t i = 0; i < count; i++)
            ((double *)group->room)[i] = values[i];
        break;
    case FLOAT32:
        for (int64_t i = 0; i < count; i++) {
            ((float *)group->room)[i] = (float)values[i];
            if (fabs(values[i]) <= DBL_MAX && !(fabsf(((float *)group->room)[i]) <= FLT_MAX))
                return i;
        }
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
        EITHER(FMI1_BOOLEAN, char)
    }
    return count;
}

/* ---- units and items ---- */

/* The value outside of the FMU; false if it is not a known item. */
static inline bool go_out(const Conversion *conversion, double *value)
{
    if (!conversion->n_pairs) {
        *value = conversion->factor * *value + conversion->offset;
        return true;
    }
    for (int64_t i = 0; i < conversion->n_pairs; i++)
        if (conversion->pairs[2 * i] == *value) {
            *value = conversion->pairs[2 * i + 1];
            return true;
        }
    return false;
}

/* The value inside of the FMU; false if it is not a known item. */
static inline bool go_in(const Conversion *conversion, double *value)
{
    if (!conversion->n_pairs) {
        *value = (*value - conversion->offset) / conversion->factor;
        return true;
    }
    for (int64_t i = 0; i < conversion->n_pairs; i++)
        if (conversion->pairs[2 * i + 1] == *value) {
            *value = conversion->pairs[2 * i];
            return true;
        }
    return false;
}

/* The first of *count* values that was finite *before* and is not *after*, or count. */
static int64_t first_overflow(int64_t count, const double *before, const double *after)
{
    for (int64_t i = 0; i < count; i++)
        if (!(fabs(after[i]) <= DBL_MAX) && fabs(before[i]) <= DBL_MAX)
            return i;
    return count;
}

/* Apply the transforms of the wires that end at a group's inputs. */
static void carry(const Group *group, double *values)
{
    if (group->transforms)
        for (int64_t i = 0; i < group->n_values; i++)
            go_out(&group->transforms[i], &values[i]); /* a wire passes on values without an item */
}

/* Convert values to those inside of the FMU; returns the first that is not an item, or n_values. */
static int64_t turn_inside(const Group *group, double *values)
{
    if (group->conversions)
        for (int64_t i = 0; i < group->n_values; i++)
            if (!go_in(&group->conversions[i], &values[i]))
                return i;
    return group->n_values;
}

/* Convert values to those outside; returns the first that is not an item, or n_values. */
static int64_t turn_outside(const Group *group, double *values)
{
    if (group->conversions)
        for (int64_t i = 0; i < group->n_values; i++)
            if (!go_out(&group->conversions[i], &values[i]))
                return i;
    return group->n_values;
}

#endif
