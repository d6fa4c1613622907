/* When clocks tick (FMI 3.0.2, 2.2.8). */
#ifndef DSE_COSIM_TICKS_H
#define DSE_COSIM_TICKS_H

#include "sweep.h"

RARE static bool fail_clock(System *system, int64_t kind, const Clock *clock, double value)
{
    const Plan *plan = system->plan;
    return fail(system, kind, 0, clock ? clock - plan->clocks : -1, value);
}

static bool is_timed(const Clock *clock)
{
    return clock->kind != TRIGGERED;
}

/* Read the interval, in *parts* of a second. */
static bool ask_interval(System *system, const Clock *clock, double *interval, double *parts, int *qualifier)
{
    void *const instance = system->elements[clock->element].instance;
    const uint32_t reference = (uint32_t)clock->reference;
    uint64_t counter = 0, resolution = 1;
    *qualifier = NOT_YET_KNOWN;
    *interval = 0.0;
    *parts = 1.0;
    enter_call(system, clock->element, clock->has_fractions ? GET_INTERVAL_FRACTION : GET_INTERVAL_DECIMAL);
    if (!clock->has_fractions) {
        if (!accept(system, ((Fmi3GetInterval)clock->get_interval)(instance, &reference, 1, interval, qualifier)))
            return false;
    } else {
        if (!accept(system, ((Fmi3GetIntervalFraction)clock->get_interval)(instance, &reference, 1, &counter,
                                                                           &resolution, qualifier)))
            return false;
        *interval = (double)counter;
        *parts = (double)resolution;
    }
    return true;
}

/* Only used values must be valid: if an interval is not new, an FMU need not return any. */
static bool fits(System *system, const Clock *clock, double interval, double parts, bool is_known)
{
    const double seconds = is_known ? interval / parts : NAN;
    const bool is_periodic = clock->kind <= TUNABLE;
    return (seconds >= 0.0 && seconds <= DBL_MAX && !(is_periodic && seconds == 0.0)) ||
           fail_clock(system, BAD_INTERVAL, clock, seconds);
}

static bool ask_shift(System *system, const Clock *clock, double parts, double *shift)
{
    void *const instance = system->elements[clock->element].instance;
    const uint32_t reference = (uint32_t)clock->reference;
    uint64_t counter = 0, resolution = 1;
    *shift = 0.0;
    enter_call(system, clock->element, clock->has_fractions ? GET_SHIFT_FRACTION : GET_SHIFT_DECIMAL);
    if (!clock->has_fractions) {
        if (!accept(system, ((Fmi3GetShift)clock->get_shift)(instance, &reference, 1, shift)))
            return false;
    } else {
        if (!accept(system,
                    ((Fmi3GetShiftFraction)clock->get_shift)(instance, &reference, 1, &counter, &resolution)))
            return false;
        *shift = (double)counter * (parts / (double)resolution);
    }
    return (*shift >= 0.0 && *shift <= DBL_MAX) || fail_clock(system, BAD_INTERVAL, clock, *shift);
}

/* Never accumulated. */
static void find_next(Clock *clock)
{
    clock->next = (clock->first + (double)clock->ticks * clock->period) / clock->parts;
}

static bool start_clock(System *system, Clock *clock)
{
    int qualifier;
    clock->ticks = 0;
    clock->next = INFINITY;
    if (!is_timed(clock))
        return true;
    clock->period = clock->interval;
    clock->first = clock->shift;
    clock->parts = clock->resolution;
    if (clock->kind >= CHANGING) {
        if (!ask_interval(system, clock, &clock->period, &clock->parts, &qualifier))
            return false;
        if (clock->kind == COUNTDOWN && qualifier != CHANGED)
            return true;
        clock->next = clock->period / clock->parts;
        return fits(system, clock, clock->period, clock->parts, qualifier != NOT_YET_KNOWN);
    }
    if (!clock->is_told && (!ask_interval(system, clock, &clock->period, &clock->parts, &qualifier) ||
                            !fits(system, clock, clock->period, clock->parts, qualifier != NOT_YET_KNOWN) ||
                            !ask_shift(system, clock, clock->parts, &clock->first)))
        return false;
    find_next(clock);
    return true;
}

/* After an update at *time*: the FMU's present clock intervals. */
static bool reschedule(System *system, Clock *clock, double time)
{
    int qualifier;
    double interval, parts;
    const bool changes = (clock->kind == CHANGING && clock->is_set) || clock->kind == COUNTDOWN ||
                         (clock->kind == TUNABLE && !clock->is_told);
    if (!changes)
        return true;
    if (!ask_interval(system, clock, &interval, &parts, &qualifier))
        return false;
    if (clock->kind != CHANGING && qualifier != CHANGED)
        return true;
    if (!fits(system, clock, interval, parts, qualifier != NOT_YET_KNOWN))
        return false;
    if (clock->kind == TUNABLE) {
        clock->ticks = 0;
        clock->period = interval / parts;
        clock->first = time + clock->period;
        clock->parts = 1.0;
        find_next(clock);
    } else
        clock->next = time + interval / parts;
    return true;
}

#endif
