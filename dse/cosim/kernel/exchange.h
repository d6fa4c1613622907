/* FMUs for model exchange as elements: the kernel integrates them from one communication point to the next. At a
 * communication point an element with connected inputs stays in event mode, where FMI allows every input to be set. Its
 * next step begins with the event iteration for these inputs. Between the points its continuous inputs move along their
 * slopes, if they have any. An element without connected inputs continues directly. Events on a communication point are
 * handled at the end of the step that leads there. */
#ifndef DSE_COSIM_EXCHANGE_H
#define DSE_COSIM_EXCHANGE_H

#include "exchange_solver.h"
#include "log.h"

enum { MOST_STEPS = 1000000, MOST_PASSES = 100, CLOSE_EVENTS = 32 };

/* Tolerance, in communication steps, between an FMU's event time and the master's time, for rounding. */
#define SPARE 1e-9

static bool exchange_make(System *system, int64_t e)
{
    Element *element = &system->elements[e];
    const Exchange *x = element->exchange;
    enter_call(system, e, INSTANTIATE);
    element->instance =
        element->version == 2
            ? ((Fmi2Instantiate)x->instantiate)(element->name, FMI2_MODEL_EXCHANGE, element->token, element->resources,
                                                &element->callbacks, 0, 0)
            : ((Fmi3InstantiateExchange)x->instantiate)(element->name, element->token, element->resources, false, false,
                                                        element, keep_fmi3_line);
    return element->instance ? true : fail(system, NO_INSTANCE, 0, 0, 0);
}

/* ---- events ---- */

/* In event mode: iterate until nothing changes, and store new event information. */
static bool settle_events(System *system, const Element *element)
{
    Exchange *x = element->exchange;
    bool has_new_states = false, has_new_nominals = false;
    Fmi2EventInfo info = {.again = 1};
    for (int64_t pass = 0; info.again; pass++) {
        if (pass == MOST_PASSES)
            return fail_at(system, x, EVENTS_UNSETTLED, 0);
        if (!update_discrete_states(system, element, &info))
            return false;
        if (info.terminate)
            return ask_to_end(system, x);
        has_new_states |= info.states_changed != 0;
        has_new_nominals |= info.nominals_changed != 0;
    }
    if (info.has_next && isnan(info.next))
        return fail_at(system, x, EVENT_NEVER, 0);
    x->now.next_event = info.has_next ? info.next : INFINITY;
    return (!has_new_states || get_states(system, element)) && (!has_new_nominals || get_nominals(system, element));
}

/* After event mode: computes slope and indicators at the present point. */
static bool go_on(System *system, const Element *element)
{
    Exchange *x = element->exchange;
    return change_mode(system, element, ENTER_CONTINUOUS_TIME, x->enter_continuous_time) &&
           must(system, element,
                get_doubles(system, element, GET_DERIVATIVES, x->get_derivatives, x->n_states, SLOPE_NOT_FINITE,
                            x->solver.slope)) &&
           must(system, element, get_indicators(system, element, x->solver.at_end));
}

static bool meet_event(System *system, const Element *element)
{
    Exchange *x = element->exchange;
    struct dse_solver *s = &x->solver;
    if (dse_chatters(s, x->now.time, CLOSE_EVENTS))
        return fail_at(system, x, CHATTERS, s->has_event ? dse_first_crossed(element, s->high) : -1);
    s->past.events++;
    s->past.next_width = 0.0; /* the experience of the error control is from before the event */
    s->has_event = 0;
    return change_mode(system, element, ENTER_EVENT_MODE, x->enter_event_mode) && settle_events(system, element) &&
           go_on(system, element);
}

/* ---- time ---- */

/* One step of the solver, at most to *limit*, and the event at its end, if any. */
static bool proceed(System *system, const Element *element, double limit)
{
    Exchange *x = element->exchange;
    const struct dse_solver *s = &x->solver;
    bool wants_event = false;
    if (x->now.time < limit) {
        if (!take_step(system, element, limit))
            return false;
        x->now.time = s->end;
        if (!s->is_at_end && !must(system, element, put_point(system, element, s->end, s->to)))
            return false;
        if (!complete_step(system, element, &wants_event))
            return false;
    }
    return !(s->has_event || wants_event || x->now.time >= x->now.next_event) || meet_event(system, element);
}

/* To *target*, which becomes now.time, except for rounding. */
static bool integrate(System *system, const Element *element, double target)
{
    Exchange *x = element->exchange;
    struct dse_solver *s = &x->solver;
    const double spare = SPARE * s->span, least = 16.0 * DBL_EPSILON * fmax(fabs(target), s->span);
    const int64_t most = s->past.steps + s->past.events + MOST_STEPS;
    s->has_event = 0;
    for (;;) {
        const bool is_due = x->now.next_event <= target + spare;
        if (!is_due && target - x->now.time <= least)
            return true;
        if (s->past.steps + s->past.events >= most)
            return fail_at(system, x, TOO_MANY_STEPS, 0);
        if (!proceed(system, element, is_due ? x->now.next_event : target))
            return false;
    }
}

/* ---- functions for element.h ---- */

/* Leaves initialization and does the first event iteration. */
static bool exchange_start(System *system, int64_t e)
{
    const Element *element = &system->elements[e];
    Exchange *x = element->exchange;
    x->now = (Standing){.next_event = INFINITY, .in_event_mode = 1};
    x->solver.past = (struct dse_past){0};
    x->solver.has_event = 0;
    enter_call(system, e, EXIT_INITIALIZATION);
    return accept(system, ((FmiPlain)element->exit_initialization)(element->instance)) &&
           check_counts(system, element) && get_nominals(system, element) && settle_events(system, element) &&
           get_states(system, element) && (x->has_inputs || go_on(system, element));
}

static bool exchange_step(System *system, const Element *element, double time, double step)
{
    Exchange *x = element->exchange;
    x->solver.span = step;
    if (x->now.in_event_mode && !(settle_events(system, element) && go_on(system, element)))
        return false;
    if (!integrate(system, element, time + step))
        return ends_at(system, time + step, step);
    return !x->has_inputs || change_mode(system, element, ENTER_EVENT_MODE, x->enter_event_mode);
}

/* Save the state of the integration, in addition to the FMU's own state. */
static void exchange_save(Element *element)
{
    Exchange *x = element->exchange;
    x->kept = x->now;
    x->kept_past = x->solver.past;
    dse_copy(x->kept_values, x->solver.to, x->n_kept);
}

static void exchange_restore(Element *element)
{
    Exchange *x = element->exchange;
    x->now = x->kept;
    x->solver.past = x->kept_past;
    dse_copy(x->solver.to, x->kept_values, x->n_kept);
}

#endif
