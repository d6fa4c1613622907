/* One element makes one communication step, including retries and partial steps. */
#ifndef DSE_COSIM_STEPPING_H
#define DSE_COSIM_STEPPING_H

#include "events.h"
#include "slopes.h"

#if defined(_WIN32)
__declspec(dllimport) void __stdcall Sleep(unsigned long milliseconds);
#else
#include <time.h>
#endif

/* ---- FMI 1 and 2 ---- */

static void keep_step_status(Element *element, int status)
{
    __atomic_store_n(&element->finished_at, element->system->progress->step, __ATOMIC_RELAXED);
    __atomic_store_n(&element->finished, (int64_t)status, __ATOMIC_RELEASE);
}

static void nap(void)
{
#if defined(_WIN32)
    Sleep(1);
#else
    nanosleep(&(struct timespec){0, 20000}, NULL);
#endif
}

/* Status of an asynchronous step when it is over. The FMU reports it by callback, or is polled. */
static int wait_for_step(System *system, Element *element)
{
    for (;; nap()) {
        const int64_t told = __atomic_load_n(&element->finished, __ATOMIC_ACQUIRE);
        /* An FMU may also call back for a step that was over when it returned. The loop does not clear that: the step's
         * number identifies the callback. */
        if (told >= 0 && __atomic_load_n(&element->finished_at, __ATOMIC_RELAXED) == system->progress->step)
            return (int)told;
        if (!element->get_status)
            continue;
        int found = FMI_PENDING;
        enter_call(system, element->stepping.element, GET_STATUS);
        const int status = ((Fmi2GetStatus)element->get_status)(element->instance, FMI_STEP_STATUS, &found);
        if (!is_good(status) && status != FMI_PENDING)
            return status;
        if (found != FMI_PENDING)
            return found;
    }
}

static int call_step(System *system, Element *element, double time, double step)
{
    system->progress->place = element->stepping;
    __atomic_store_n(&element->finished, (int64_t)-1, __ATOMIC_RELAXED);
    return element->version == 1
               ? ((Fmi1DoStep)element->do_step)(element->instance, time, step, 1)
               : ((Fmi2DoStep)element->do_step)(element->instance, time, step, system->may_roll_back ? 0 : 1);
}

/* Whether a discarded step made progress: sets *time* to the time it reached. */
static bool got_on(System *system, const Element *element, double *time, double end)
{
    double reached = *time;
    if (!element->get_real_status)
        return false;
    enter_call(system, element->stepping.element, GET_REAL_STATUS);
    if (!is_good(((Fmi2GetRealStatus)element->get_real_status)(element->instance, FMI_LAST_SUCCESSFUL_TIME, &reached)))
        return false;
    /* Not beyond the end: then its state is unknown. */
    const bool is_on = reached > *time && reached <= end + NEARLY * (end - *time);
    *time = reached;
    return is_on;
}

static bool wants_to_end(System *system, const Element *element)
{
    int ends = 0;
    if (element->version != 2 || !element->get_boolean_status)
        return false;
    enter_call(system, element->stepping.element, GET_BOOLEAN_STATUS);
    return is_good(((Fmi2GetStatus)element->get_boolean_status)(element->instance, FMI_TERMINATED, &ends)) && ends;
}

/* A step from *time* returned *status*, which is not good: the rest is stepped again, if the FMU supports it. */
RARE static bool make_up(System *system, const Element *constant, double time, double step, int status)
{
    Element *element = &system->elements[constant->stepping.element];
    const double end = time + step;
    for (;;) {
        if (status == FMI_PENDING) {
            status = wait_for_step(system, element);
            system->progress->place = element->stepping;
        }
        if (is_good(status))
            return true;
        if (status != FMI_DISCARD)
            return fail_status(system, status);
        const double began = time;
        const bool ends = wants_to_end(system, element), is_on = got_on(system, element, &time, end);
        system->progress->place = element->stepping;
        if (ends)
            return fail(system, STEP_CUT_SHORT, 1, 0, is_on ? time : began) || ends_at(system, end, step);
        if (!is_on)
            return fail_status(system, status);
        if (time >= end)
            return true;
        status = call_step(system, element, time, end - time);
    }
}

HOT bool step_fmi2(System *system, Progress *progress, const Element *element, double time, double step)
{
    progress->place = element->stepping;
    const int status = ((Fmi2DoStep)element->do_step)(element->instance, time, step, 1);
    return is_good(status) ? true : make_up(system, element, time, step, status);
}

/* ---- FMI 3 ---- */

/* One call of fmi3DoStep from *time* to *target*; returns the reached time and whether there is an event. */
static bool step_once(System *system, Element *element, double *time, double step, double target, bool *has_event)
{
    bool terminate = false, early_return = false;
    double reached = target;
    *has_event = false;
    system->progress->place = element->stepping;
    const int status = ((Fmi3DoStep)element->do_step)(element->instance, *time, step, !system->may_roll_back,
                                                      has_event, &terminate, &early_return, &reached);
    if (element->broken)
        return false; /* the failure is filled in */
    if (!is_good(status))
        return fail_status(system, status);
    /* Some FMUs report an early return with an event at the very end. */
    early_return = early_return && !(*has_event && reached >= target - NEARLY * step);
    *has_event = *has_event && element->abilities & HAS_EVENTS;
    if (terminate)
        return fail(system, STEP_CUT_SHORT, 1, 0, reached < target ? reached : target);
    if (early_return && !(element->abilities & CAN_RETURN_EARLY))
        return fail(system, STEP_CUT_SHORT, 0, 0, 0);
    *time = early_return && reached < target ? reached : target;
    return true;
}

static bool step_fmi3(System *system, Element *element, double time, double step)
{
    const double end = time + step;
    const bool splits = element->abilities & HAS_EVENTS && element->abilities & CAN_VARY_STEP;
    int64_t standstill = 0;
    for (double at = time;;) {
        const double began = at;
        const bool stops = splits && element->next_event > at && element->next_event < end;
        const double target = stops ? element->next_event : end;
        bool has_event;
        if (!step_once(system, element, &at, at == time && !stops ? step : target - at, target, &has_event))
            return ends_at(system, end, step);
        if (!(at > began) && (!has_event || ++standstill > MOST_EVENT_ITERATIONS))
            return fail(system, has_event ? ENDLESS_EVENTS : STEP_CUT_SHORT, 0, 0, 0);
        if (has_event && !pass_event(system, element)) {
            if (is_asked_to_end(system))
                system->failure.value = at;
            return ends_at(system, end, step);
        }
        if (at >= end)
            return true;
    }
}

#endif
