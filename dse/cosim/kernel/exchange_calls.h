/* The FMI functions of model exchange, one by one: FMI 2.0.4, chapter 3, and FMI 3.0.1, chapter 3. */
#ifndef DSE_COSIM_EXCHANGE_CALLS_H
#define DSE_COSIM_EXCHANGE_CALLS_H

#include "exchange_memory.h"
#include "slopes.h"

#include <math.h>
#include <string.h>

typedef struct {
    int again, terminate, nominals_changed, states_changed, has_next;
    double next;
} Fmi2EventInfo;

typedef void *(*Fmi3InstantiateExchange)(const char *name, const char *token, const char *resources, bool visible,
                                         bool logging, void *environment, Fmi3Log);
typedef int (*FmiSetTime)(void *, double);
typedef int (*FmiSetStates)(void *, const double *, size_t);
typedef int (*FmiGetDoubles)(void *, double *, size_t);
typedef int (*Fmi2NewStates)(void *, Fmi2EventInfo *);
typedef int (*Fmi2CompletedStep)(void *, int never_back, int *event, int *terminate);
typedef int (*Fmi3CompletedStep)(void *, bool never_back, bool *event, bool *terminate);
typedef int (*Fmi3Count)(void *, size_t *);

static bool fail_at(System *system, Exchange *x, int64_t kind, int64_t position)
{
    return fail(system, kind, 0, position, x->now.time);
}

static dse_answer refuse(System *system, Exchange *x, int64_t kind, int64_t status, int64_t position)
{
    x->solver.trouble = (dse_reason){kind, status, position, system->progress->place.call};
    return DSE_REFUSED;
}

/* Reports the last refusal as failure, if there is no other point to try. */
static bool fail_refused(System *system, const Element *element, Exchange *x)
{
    enter_call(system, number_of(system, element), x->solver.trouble.call);
    return fail(system, x->solver.trouble.kind, x->solver.trouble.status, x->solver.trouble.position, x->now.time);
}

static bool must(System *system, const Element *element, dse_answer answer)
{
    return answer == DSE_DONE || (answer == DSE_REFUSED && fail_refused(system, element, element->exchange));
}

/* ---- values ---- */

static dse_answer answer_of(System *system, Exchange *x, int status)
{
    if (is_good(status))
        return DSE_DONE;
    if (status == FMI_DISCARD)
        return refuse(system, x, BAD_STATUS, status, 0);
    fail_status(system, status);
    return DSE_FAILED;
}

/* Get *count* doubles; one that is not finite is refused as *kind*. */
static dse_answer get_doubles(System *system, const Element *element, int64_t call, FmiFunction function, int64_t count,
                          int64_t kind, double *values)
{
    Exchange *x = element->exchange;
    if (count == 0)
        return DSE_DONE;
    enter_call(system, number_of(system, element), call);
    const dse_answer answer = answer_of(system, x, ((FmiGetDoubles)function)(element->instance, values, (size_t)count));
    for (int64_t i = 0; answer == DSE_DONE && i < count; i++)
        if (!isfinite(values[i]))
            return refuse(system, x, kind, 0, i);
    return answer;
}

static dse_answer put_point(System *system, const Element *element, double time, const double *states)
{
    Exchange *x = element->exchange;
    x->solver.is_at_end = 0;
    enter_call(system, number_of(system, element), SET_TIME);
    dse_answer answer = answer_of(system, x, ((FmiSetTime)x->set_time)(element->instance, time));
    if (answer == DSE_DONE && !move_inputs(system, element, time))
        answer = DSE_FAILED;
    if (answer == DSE_DONE && x->n_states > 0) {
        enter_call(system, number_of(system, element), SET_CONTINUOUS_STATES);
        answer = answer_of(system, x,
                           ((FmiSetStates)x->set_states)(element->instance, states, (size_t)x->n_states));
    }
    return answer;
}

static dse_answer find_slope(System *system, const Element *element, double time, const double *states, double *slope)
{
    Exchange *x = element->exchange;
    const dse_answer answer = put_point(system, element, time, states);
    x->solver.past.evaluations++;
    return answer != DSE_DONE ? answer
                          : get_doubles(system, element, GET_DERIVATIVES, x->get_derivatives, x->n_states,
                                        SLOPE_NOT_FINITE, slope);
}

/* The event indicators at the FMU's present point. */
static dse_answer get_indicators(System *system, const Element *element, double *indicators)
{
    const Exchange *x = element->exchange;
    return get_doubles(system, element, GET_EVENT_INDICATORS, x->get_indicators, x->n_indicators, INDICATOR_NOT_FINITE,
                       indicators);
}

static bool get_states(System *system, const Element *element)
{
    const Exchange *x = element->exchange;
    return must(system, element,
                get_doubles(system, element, GET_CONTINUOUS_STATES, x->get_states, x->n_states, STATE_NOT_FINITE,
                            x->solver.to));
}

/* FMI's nominal for "unknown" is 1; invalid nominals become 1, too. */
static bool get_nominals(System *system, const Element *element)
{
    const Exchange *x = element->exchange;
    if (x->n_states == 0)
        return true;
    enter_call(system, number_of(system, element), GET_NOMINALS);
    if (!accept(system, ((FmiGetDoubles)x->get_nominals)(element->instance, x->nominals, (size_t)x->n_states)))
        return false;
    for (int64_t k = 0; k < x->n_states; k++)
        x->nominals[k] = isfinite(x->nominals[k]) && x->nominals[k] != 0.0 ? fabs(x->nominals[k]) : 1.0;
    return true;
}

/* sensitivity = (d unknowns / d knowns) seed, all in the FMU's units. */
static bool directional_derivative(System *system, const Element *element, const uint32_t *unknowns,
                                   size_t n_unknowns, const uint32_t *knowns, size_t n_knowns, const double *seed,
                                   size_t n_seed, double *sensitivity, size_t n_sensitivity)
{
    enter_call(system, element->stepping.element, GET_DIRECTIONAL_DERIVATIVE);
    if (!(element->abilities & CAN_DIRECTIONAL))
        return fail(system, NO_FUNCTION, 0, 0, 0);
    const FmiFunction get = element->get_directional_derivative;
    return accept(system, element->version == 2
                              ? ((Fmi2Directional)get)(element->instance, unknowns, n_unknowns, knowns, n_knowns, seed,
                                                       sensitivity)
                              : ((Fmi3Directional)get)(element->instance, unknowns, n_unknowns, knowns, n_knowns, seed,
                                                       n_seed, sensitivity, n_sensitivity));
}

/* ---- modes ---- */

static bool ask_to_end(System *system, const Exchange *x)
{
    return fail(system, STEP_CUT_SHORT, 1, 0, x->now.time);
}

static bool change_mode(System *system, const Element *element, int64_t call, FmiFunction function)
{
    Exchange *x = element->exchange;
    enter_call(system, number_of(system, element), call);
    x->now.in_event_mode = call == ENTER_EVENT_MODE;
    return accept(system, ((FmiPlain)function)(element->instance));
}

/* One pass of the event iteration. */
static bool update_discrete_states(System *system, const Element *element, Fmi2EventInfo *info)
{
    const Exchange *x = element->exchange;
    *info = (Fmi2EventInfo){0};
    enter_call(system, number_of(system, element), UPDATE_DISCRETE_STATES);
    if (element->version == 2)
        return accept(system, ((Fmi2NewStates)x->update_discrete_states)(element->instance, info));
    bool again = false, terminate = false, nominals_changed = false, states_changed = false, has_next = false;
    double next = 0.0;
    const int status = ((Fmi3UpdateStates)x->update_discrete_states)(
        element->instance, &again, &terminate, &nominals_changed, &states_changed, &has_next, &next);
    *info = (Fmi2EventInfo){again, terminate, nominals_changed, states_changed, has_next, next};
    return accept(system, status);
}

/* Report a completed solver step at the FMU's present point; *wants_event*: it has to enter its event mode. */
static bool complete_step(System *system, const Element *element, bool *wants_event)
{
    Exchange *x = element->exchange;
    *wants_event = false;
    if (!x->needs_completed_step)
        return true;
    enter_call(system, number_of(system, element), COMPLETED_INTEGRATOR_STEP);
    const bool never_back = !system->may_roll_back;
    bool event = false, terminate = false;
    int status;
    if (element->version == 2) {
        int event2 = 0, terminate2 = 0;
        status = ((Fmi2CompletedStep)x->completed_step)(element->instance, never_back, &event2, &terminate2);
        event = event2 != 0, terminate = terminate2 != 0;
    } else {
        status = ((Fmi3CompletedStep)x->completed_step)(element->instance, never_back, &event, &terminate);
    }
    *wants_event = event;
    return accept(system, status) && (!terminate || ask_to_end(system, x));
}

static bool check_count(System *system, const Element *element, int64_t call, FmiFunction function, int64_t expected)
{
    size_t count = 0;
    enter_call(system, number_of(system, element), call);
    if (!accept(system, ((Fmi3Count)function)(element->instance, &count)))
        return false;
    return count == (size_t)expected || fail(system, COUNT_DIFFERS, (int64_t)count, call == GET_INDICATOR_COUNT, 0);
}

/* FMI 3 returns the present numbers of values, which structural parameters may have changed. */
static bool check_counts(System *system, const Element *element)
{
    const Exchange *x = element->exchange;
    return element->version == 2 ||
           (check_count(system, element, GET_STATE_COUNT, x->count_states, x->n_states) &&
            check_count(system, element, GET_INDICATOR_COUNT, x->count_indicators, x->n_indicators));
}

#endif
