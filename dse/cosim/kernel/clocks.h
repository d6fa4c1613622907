/* Instants at which clocks tick (FMI 3.0.2, 2.2.8 and 2.3.5). Clocks that are due tick together. In the same instant
 * all clocks that they trigger tick, and the values of their variables are passed on. This is repeated, as further
 * instants at the same time, until no clock is due and no FMU requests another update. */
#ifndef DSE_COSIM_CLOCKS_H
#define DSE_COSIM_CLOCKS_H

#include "floating.h"
#include "ticks.h"

/* In initialization mode, when all values are available. */
static bool start_clocks(System *system, double step)
{
    Plan *plan = system->plan;
    plan->spare = NEARLY * step;
    for (const ClockGroup *group = plan->groups; group < plan->groups + plan->n_groups; group++) {
        for (Clock *clock = group->clocks; clock < group->no_clocks; clock++)
            if (!start_clock(system, clock))
                return false;
        /* Before the first tick of its clock a value is that of the initialization. */
        for (const ClockStep *at = group->steps; at < group->no_steps; at++)
            if (at->act == SAMPLE && !at->is_message && !read_some(system, &at->operation.groups))
                return false;
        /* After the initialization they are in event mode, and the first update is due. */
        for (int64_t i = 0; i < group->n_elements; i++)
            plan->ticking[group->elements[i]] = (Ticking){1, 1, 0};
    }
    return true;
}

/* ---- an instant ---- */

static bool enter_events(System *system, int64_t e)
{
    Ticking *ticking = &((Plan *)system->plan)->ticking[e];
    Element *element = &system->elements[e];
    if (ticking->in_events)
        return true;
    ticking->in_events = 1;
    element->next_event = INFINITY;
    return call_plain(system, element, ENTER_EVENT_MODE, element->enter_event_mode);
}

/* Begin another instant: finds the timed clocks that tick and the elements that are due. False if there are none. */
static bool begin_instant(System *system, const ClockGroup *group, double until)
{
    Plan *plan = system->plan;
    bool any = false;
    plan->instant = 0;
    for (ClockStep *step = group->steps; step < group->no_steps; step++)
        step->stamp = step->read_at = 0;
    for (int64_t i = 0; i < group->n_elements; i++) {
        Ticking *ticking = &plan->ticking[group->elements[i]];
        ticking->news = 1;
        ticking->is_due |= system->elements[group->elements[i]].next_event <= until;
        any |= ticking->is_due;
    }
    for (Clock *clock = group->clocks; clock < group->no_clocks; clock++) {
        clock->is_active = is_timed(clock) && clock->next <= until;
        clock->is_set = clock->asked_at = 0;
        if (!clock->is_active)
            continue;
        plan->ticking[clock->element].is_due = 1;
        any = true;
        clock->ticks++;
        if (clock->kind <= TUNABLE)
            find_next(clock);
        else
            clock->next = INFINITY;
    }
    return any;
}

static bool any_active(const Plan *plan, const int64_t *clocks, int64_t count)
{
    bool any = false;
    for (int64_t i = 0; i < count; i++)
        any |= plan->clocks[clocks[i]].is_active;
    return any;
}

static bool any_set(const Plan *plan, const ClockStep *step)
{
    bool any = false;
    for (int64_t i = 0; i < step->n_clocks; i++)
        any |= plan->clocks[step->clocks[i]].is_set;
    return any;
}

static bool call_clock(System *system, const Clock *clock, int64_t call, bool *value)
{
    const uint32_t reference = (uint32_t)clock->reference;
    enter_call(system, clock->element, call);
    return accept(system, ((Fmi3Clocks)clock->access)(system->elements[clock->element].instance, &reference, 1, value));
}

/* An FMU may report the tick of an output clock only once: a clock that has ticked is not polled again. */
static bool poll(System *system, const ClockStep *step, bool *went_on)
{
    const Plan *plan = system->plan;
    const Ticking *ticking = &plan->ticking[step->element];
    Clock *clock = &plan->clocks[step->clock];
    bool ticks = false;
    if (!ticking->is_due || clock->is_set || clock->asked_at == ticking->news || (step->n_clocks && !any_set(plan, step)))
        return true;
    clock->asked_at = ticking->news;
    if (!enter_events(system, step->element) || !call_clock(system, clock, GET_CLOCK, &ticks))
        return false;
    clock->is_active = clock->is_set = ticks;
    clock->count += ticks;
    *went_on |= ticks;
    return true;
}

static bool tick(System *system, const ClockStep *step, bool *went_on)
{
    Plan *plan = system->plan;
    Ticking *ticking = &plan->ticking[step->element];
    Clock *clock = &plan->clocks[step->clock];
    bool ticks = true;
    if (clock->is_set || !(clock->is_active || any_active(plan, clock->sources, clock->n_sources)))
        return true;
    clock->is_active = clock->is_set = ticking->is_due = 1;
    clock->count++;
    ticking->news = ++plan->instant + 1;
    *went_on = true;
    return enter_events(system, step->element) && call_clock(system, clock, SET_CLOCK, &ticks);
}

/* Numbers are read again after their element got new inputs; a message is read once. */
static bool sample(System *system, ClockStep *step, bool *went_on)
{
    Plan *plan = system->plan;
    const size_t size = (size_t)step->n_values * sizeof(double);
    const bool is_first = !step->stamp;
    if (!any_set(plan, step) || (!is_first && (step->is_message || plan->ticking[step->element].news <= step->read_at)))
        return true;
    memcpy(step->before, system->values + step->first, size);
    if (!read_some(system, &step->operation.groups))
        return false;
    for (const TextGroup *group = step->operation.groups.texts; group < step->operation.groups.no_texts; group++)
        for (int64_t i = 0; i < group->count; i++)
            step->bytes += (int64_t)group->texts[i]->size;
    step->read_at = ++plan->instant + 1;
    if (!is_first && memcmp(step->before, system->values + step->first, size) == 0)
        return true;
    step->stamp = step->read_at;
    *went_on = true;
    return true;
}

static bool deliver(System *system, ClockStep *step, bool *went_on)
{
    Plan *plan = system->plan;
    const int32_t *sources = plan->sources + step->operation.first;
    int64_t newest = 0;
    for (int64_t i = 0; i < step->n_sources; i++) {
        const int64_t stamp = plan->clock_steps[step->sources[i]].stamp;
        newest = stamp > newest ? stamp : newest;
    }
    const bool is_new = newest > step->stamp || !(step->stamp || (step->is_message && step->n_sources));
    if (!any_set(plan, step) || !is_new)
        return true;
    gather(plan->staged + step->operation.first, system->values, sources, step->operation.count);
    if (!are_finite(system, sources, step->operation.count))
        return fail_not_finite(system, sources, step->operation.count);
    step->stamp = plan->ticking[step->element].news = ++plan->instant + 1;
    *went_on = true;
    return write_some(system, &step->operation.groups, UNFIT_INPUT);
}

static bool carry_out(System *system, ClockStep *step, bool *went_on)
{
    return step->act == POLL      ? poll(system, step, went_on)
           : step->act == TICK    ? tick(system, step, went_on)
           : step->act == SAMPLE  ? sample(system, step, went_on)
                                  : deliver(system, step, went_on);
}

/* All operations of one instant. */
static bool settle(System *system, const ClockGroup *group)
{
    bool went_on = true;
    const Clock *last = NULL;
    for (int64_t i = 0; went_on && i < MOST_EVENT_ITERATIONS; i++) {
        went_on = false;
        for (ClockStep *step = group->steps; step < group->no_steps; step++) {
            bool did = false;
            if (!carry_out(system, step, &did))
                return false;
            last = did ? &((Plan *)system->plan)->clocks[step->clock >= 0 ? step->clock : step->clocks[0]] : last;
            went_on |= did;
        }
    }
    return !went_on || fail_clock(system, ENDLESS_TICKS, last, 1.0);
}

static bool update_all(System *system, const ClockGroup *group, double time)
{
    const Plan *plan = system->plan;
    for (int64_t i = 0; i < group->n_elements; i++) {
        const int64_t e = group->elements[i];
        bool again;
        if (!plan->ticking[e].is_due)
            continue;
        if (!enter_events(system, e) || !update_once(system, &system->elements[e], &again)) {
            if (is_asked_to_end(system))
                system->failure.value = time;
            return false;
        }
        plan->ticking[e].is_due = again;
        for (Clock *clock = group->clocks; clock < group->no_clocks; clock++)
            if (clock->element == e && !reschedule(system, clock, time))
                return false;
    }
    return true;
}

/* Instants do not end: a clock always ticks again, or an FMU always requests another update. */
RARE static bool fail_endless(System *system, const ClockGroup *group)
{
    for (const Clock *clock = group->clocks; clock < group->no_clocks; clock++)
        if (clock->is_active)
            return fail_clock(system, ENDLESS_TICKS, clock, 0.0);
    int64_t i = 0;
    while (!((Plan *)system->plan)->ticking[group->elements[i]].is_due)
        i++;
    enter_call(system, group->elements[i], UPDATE_DISCRETE_STATES);
    return fail(system, ENDLESS_EVENTS, 0, 0, 0);
}

/* All instants at *time*; at a communication point the elements *show* their outputs afterwards. */
static bool pass_instants(System *system, const ClockGroup *group, double time, bool shows)
{
    const Plan *plan = system->plan;
    system->now = time;
    for (int64_t i = 0; begin_instant(system, group, time + plan->spare); i++) {
        if (i == MOST_EVENT_ITERATIONS)
            return fail_endless(system, group);
        if (!settle(system, group) || !update_all(system, group, time))
            return false;
    }
    for (int64_t i = 0; i < group->n_elements; i++) {
        const int64_t e = group->elements[i];
        Element *element = &system->elements[e];
        if (!plan->ticking[e].in_events)
            continue;
        if ((shows && !read_element(system, element, &element->outputs)) ||
            !call_plain(system, element, ENTER_STEP_MODE, element->enter_step_mode))
            return false;
        plan->ticking[e].in_events = 0;
        if (system->watches && !keeps_floating_mode(system))
            return false;
    }
    return true;
}

/* ---- the next instant ---- */

/* The next time at which a group has to stop, and the clock that requires it, if any; infinite for never. */
static double next_stop(const System *system, const ClockGroup *group, const Clock **stopping)
{
    double next = INFINITY;
    *stopping = NULL;
    for (int64_t i = 0; i < group->n_elements; i++)
        if (system->elements[group->elements[i]].next_event < next)
            next = system->elements[group->elements[i]].next_event;
    for (const Clock *clock = group->clocks; clock < group->no_clocks; clock++)
        if (clock->next < next) {
            next = clock->next;
            *stopping = clock;
        }
    return next;
}

static bool is_due(const System *system, const ClockGroup *group, double until)
{
    const Plan *plan = system->plan;
    const Clock *stopping;
    bool any = next_stop(system, group, &stopping) <= until;
    for (int64_t i = 0; i < group->n_elements; i++)
        any |= plan->ticking[group->elements[i]].is_due;
    return any;
}

/* At a communication point: elements with an instant read what the others show. */
static bool tick_all(System *system, double time)
{
    const Plan *plan = system->plan;
    for (const ClockGroup *group = plan->groups; group < plan->groups + plan->n_groups; group++) {
        if (!is_due(system, group, time + plan->spare))
            continue;
        for (int64_t i = 0; i < group->n_elements; i++) {
            const int64_t e = group->elements[i];
            const Operation *inputs = &plan->paces[e].inputs;
            const int32_t *sources = plan->sources + inputs->first;
            gather(plan->staged + inputs->first, system->values, sources, inputs->count);
            if (!are_finite(system, sources, inputs->count))
                return fail_not_finite(system, sources, inputs->count);
            /* The initialization has written them already. */
            if (!plan->ticking[e].in_events && !write_element(system, &system->elements[e], &inputs->groups))
                return false;
        }
        if (!pass_instants(system, group, time, true))
            return false;
    }
    return true;
}

#endif
