/* Reading and writing variables. */
#ifndef DSE_COSIM_ACCESS_H
#define DSE_COSIM_ACCESS_H

#include "convert.h"
#include "failing.h"
#include "texts.h"

#include <string.h>

/* ---- groups of variables ---- */

HOT bool call_fmi2(System *system, Progress *progress, const Group *group)
{
    progress->place = group->place;
    const int status =
        ((Fmi2Access)group->access)(group->instance, group->references, (size_t)group->count, group->room);
    return is_good(status) ? true : fail_status(system, status);
}

HOT bool call_fmi3(System *system, Progress *progress, const Group *group)
{
    progress->place = group->place;
    const int status = ((Fmi3Access)group->access)(group->instance, group->references, (size_t)group->count,
                                                   group->room, (size_t)group->n_values);
    return is_good(status) ? true : fail_status(system, status);
}

/* Unrolled by four: the processor predicts the target of a call by the address of the call instruction. */
HOT bool call_all(System *system, Progress *progress, const Groups *groups)
{
    const Group *group = groups->fmi2;
    for (; groups->fmi3 - group >= 4; group += 4)
        if (!call_fmi2(system, progress, group) || !call_fmi2(system, progress, group + 1) ||
            !call_fmi2(system, progress, group + 2) || !call_fmi2(system, progress, group + 3))
            return false;
    for (; group < groups->fmi3; group++)
        if (!call_fmi2(system, progress, group))
            return false;
    for (; group < groups->end; group++)
        if (!call_fmi3(system, progress, group))
            return false;
    return true;
}

static bool widen_checked(System *system, const Group *group)
{
    int64_t good = widen(group);
    if (good < group->n_values)
        return fail_value(system, TOO_LARGE, group, good, group->values[good]);
    if (!group->conversions)
        return true;
    good = turn_outside(group, group->values);
    return good == group->n_values || fail_value(system, NO_ITEM, group, good, group->values[good]);
}

/* Whether the converted values in scratch are finite wherever their sources are. */
static bool keeps_finite(System *system, const Group *group, int64_t unfit)
{
    const int64_t good = first_overflow(group->n_values, group->values, group->scratch);
    return good == group->n_values || fail_value(system, unfit, group, good, group->scratch[good]);
}

static bool narrow_checked(System *system, const Group *group, int64_t unfit)
{
    const double *values = group->values;
    if (group->scratch) {
        memcpy(group->scratch, values, (size_t)group->n_values * sizeof *values);
        values = group->scratch;
        carry(group, group->scratch);
        if (!keeps_finite(system, group, unfit))
            return false;
        int64_t known = turn_inside(group, group->scratch);
        if (known < group->n_values)
            return fail_value(system, unfit == UNFIT_START ? NO_ITEM_START : NO_ITEM_INPUT, group, known,
                              values[known]);
        if (!keeps_finite(system, group, unfit))
            return false;
    }
    int64_t good = narrow(group, values);
    return good == group->n_values || fail_value(system, unfit, group, good, values[good]);
}

HOT bool read_groups(System *system, Progress *progress, const Groups *groups)
{
    if (!call_all(system, progress, groups))
        return false;
    for (const Truth *truth = groups->truths; truth < groups->no_truths; truth++) {
        const int32_t is_true = *truth->room != 0;
        *truth->room = is_true;
        *truth->value = is_true;
    }
    for (Group *const *group = groups->converted; *group; group++)
        if (!widen_checked(system, *group))
            return false;
    return true;
}

HOT bool write_groups(System *system, Progress *progress, const Groups *groups, int64_t unfit)
{
    for (Group *const *group = groups->converted; *group; group++)
        if (!narrow_checked(system, *group, unfit))
            return false;
    return call_all(system, progress, groups);
}

/* The same outside the loop, including strings and binaries. */
APART static bool read_some(System *system, const Groups *groups)
{
    return read_groups(system, system->progress, groups) && read_texts(system, groups);
}

APART static bool write_some(System *system, const Groups *groups, int64_t unfit)
{
    return write_groups(system, system->progress, groups, unfit) && write_texts(system, groups);
}

/* ---- moving values ---- */

/* to[i] = table[positions[i]]; returns the sum: one test shows whether all were finite. */
HOT double gather(double *to, const double *table, const int32_t *positions, int64_t count)
{
    /* Unrolled by two: for a few values the loop costs more than the copying. Two loads, even for adjacent values: data
     * that an FMU has just stored in two parts cannot be forwarded to one wide load, only read from the cache. */
    typedef double Pair __attribute__((vector_size(2 * sizeof(double)), aligned(sizeof(double)), may_alias));
    Pair sum = {0.0, 0.0};
    int64_t i = 0;
    for (; i + 1 < count; i += 2) {
        Pair pair = {table[positions[i]], table[positions[i + 1]]};
        *(Pair *)(to + i) = pair;
        sum += pair;
    }
    if (i < count)
        sum[0] += to[i] = table[positions[i]];
    return sum[0] + sum[1];
}

/* Copies *count* outputs along the wires to staged inputs, from input *first* on. */
static inline double stage(const System *system, int64_t first, int64_t count)
{
    return gather(system->staged + first, system->values, system->sources + first, count);
}

RARE static bool all_finite(System *system)
{
    int64_t position = system->n_values;
    for (int64_t i = 0; i < system->n_staged; i++)
        if (system->staged[i] - system->staged[i] != 0.0 && system->sources[i] < position)
            position = system->sources[i];
    return position == system->n_values || fail(system, NOT_FINITE, 0, position, system->values[position]);
}

#endif
