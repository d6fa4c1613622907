/* The place of a call, and how a run fails. */
#ifndef DSE_COSIM_FAILING_H
#define DSE_COSIM_FAILING_H

#include "kernel.h"

/* A short loop is a fast loop: its functions are inlined, all others are kept out of it. */
#if defined(__GNUC__)
#define RARE __attribute__((cold, noinline))
#define APART __attribute__((noinline))
#define HOT static inline __attribute__((always_inline))
#define OFFERED __attribute__((unused)) /* for the algorithms, which do not all use it */
#else
#define RARE
#define APART
#define HOT static inline
#define OFFERED
#endif

/* The block is in memory before the FMU runs: compilers may not delay a store to it past an unknown function. */
static inline void enter_call(System *system, int64_t element, int64_t call)
{
    system->progress->place = (Place){element, call};
}

RARE static bool fail(System *system, int64_t kind, int64_t status, int64_t position, double value)
{
    system->failure = (Failure){kind, status, *system->progress, -1, position, value, system->now};
    return false;
}

static inline bool is_asked_to_end(const System *system)
{
    return system->failure.kind == STEP_CUT_SHORT && system->failure.status;
}

#define NEARLY 1e-9 /* of a step: FMUs add up their times */

/* Called when a step to *end* failed. True if the step counts, as the FMU requested the end of the simulation there and
 * not before. The other elements also step to *end*, and the run ends with that row. */
RARE static bool ends_at(System *system, double end, double step)
{
    const bool is_there = is_asked_to_end(system) && system->takes_end && system->failure.value >= end - NEARLY * step;
    system->has_ended |= is_there;
    return is_there;
}

/* For one value of a group. */
RARE static bool fail_value(System *system, int64_t kind, const Group *group, int64_t position, double value)
{
    system->progress->place = group->place;
    system->failure = (Failure){kind, 0, *system->progress, group->id, position, value, system->now};
    return false;
}

RARE static bool fail_status(System *system, int status)
{
    return fail(system, BAD_STATUS, status, 0, 0);
}

static inline bool is_good(int status)
{
    return (unsigned)status <= FMI_WARNING;
}

static inline bool accept(System *system, int status)
{
    return is_good(status) ? true : fail_status(system, status);
}

#endif
