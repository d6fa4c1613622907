/* The initialization of a system, and its steps from one communication point to the next, by its plan. */
#ifndef DSE_COSIM_STEP_LOOP_H
#define DSE_COSIM_STEP_LOOP_H

#include "clocks.h"

#define NOTICED 1e-6 /* of an output's size: above residuals of iterating FMUs, below effects of a wrong dependency */

/* ---- the initialization ---- */

static bool differs(double a, double b, double size)
{
    const double magnitude = fabs(a) > fabs(b) ? fabs(a) : fabs(b);
    return a != b && !(fabs(a - b) <= NOTICED * (magnitude > size ? magnitude : size)) && (a == a || b == b);
}

/* Whether outputs differ from those of the initial sweep: they depend on inputs that their FMU does not declare. */
static bool look_again(System *system, bool *is_misled)
{
    const Plan *plan = system->plan;
    const int64_t texts = system->texts_changed;
    gather(plan->passed_on, system->values, plan->doubted, plan->n_doubted);
    if (!do_sweep(system, plan->doubtful, false))
        return false;
    *is_misled = system->texts_changed != texts;
    for (int64_t i = 0; i < plan->n_doubted; i++) {
        const double value = system->values[plan->doubted[i]];
        *is_misled |= i < plan->n_doubted_reals ? differs(value, plan->passed_on[i], plan->doubted_nominals[i])
                                                : value != plan->passed_on[i];
    }
    return true;
}

/* Pass values along the wires, before t = 0; if an FMU's dependencies are wrong, again without dependencies. */
static bool initialize(System *system)
{
    Plan *plan = system->plan;
    bool is_misled = false;
    plan->k = 0;
    if (!do_sweep(system, plan->initial, false))
        return false;
    if (plan->doubtful.begin < plan->doubtful.end && !look_again(system, &is_misled))
        return false;
    if (!is_misled)
        return true;
    return plan->untold.begin < plan->untold.end ? do_sweep(system, plan->untold, false) : fail(system, MISLED, 0, 0, 0);
}

/* ---- one element ---- */

/* The slope of the line through the last two shown values, per second; 0 with fewer than two. */
static double slope_of(const System *system, int32_t position)
{
    const Plan *plan = system->plan;
    const double span = plan->spans[plan->owners[position]];
    return span > 0.0 ? (system->values[position] - plan->before[position]) / span : 0.0;
}

/* Stage inputs for a step of *length* at *time*, and their slopes. */
static void move_along(const System *system, const Operation *inputs, double time, double length)
{
    const Plan *plan = system->plan;
    for (int64_t i = inputs->first; i < inputs->first + inputs->count; i++) {
        const int32_t position = plan->sources[i];
        plan->staged[i] = system->values[position];
        if (plan->moves[i] == HELD)
            continue;
        const double slope = slope_of(system, position), ahead = time - plan->shown[plan->owners[position]];
        plan->staged[i] += slope * (plan->moves[i] == MIDDLE ? ahead + 0.5 * length : ahead);
        plan->slopes[i] = plan->moves[i] == SLOPED ? slope : 0.0;
    }
}

/* Means of the inputs over [time, time + length], for the bonds. */
static void note_used(const System *system, const Operation *inputs, double time, double length)
{
    const Plan *plan = system->plan;
    for (int64_t i = inputs->first; i < inputs->first + inputs->count; i++) {
        const int32_t position = plan->sources[i];
        plan->used[i] = system->values[position];
        if (plan->moves[i] != HELD)
            plan->used[i] += slope_of(system, position) * (time - plan->shown[plan->owners[position]] + 0.5 * length);
    }
}

/* Write the element's inputs and step it from *time* over *length*, in its own number of steps. */
static bool drive(System *system, int64_t e, double time, double length)
{
    const Plan *plan = system->plan;
    Element *element = &system->elements[e];
    const Pace *pace = &plan->paces[e];
    const double step = length / (double)pace->parts;
    /* An FMU may accept no values after its end: then values cannot be passed on at the next row. */
    const bool meets_next = pace->every == 1 && !(plan->tolerance > 0.0) && plan->meeting.begin == plan->meeting.end;
    if (plan->n_bonds)
        note_used(system, &pace->inputs, time, length);
    for (int64_t part = 0; part < pace->parts; part++) {
        const double begin = system->now = time + (double)part * step;
        system->takes_end = meets_next && part + 1 == pace->parts;
        move_along(system, &pace->inputs, begin, step);
        /* Gauss and Seidel pass on unchecked values; with error control a shorter step may still succeed. */
        const int32_t *sources = plan->sources + pace->inputs.first;
        if (plan->is_sequential && !(plan->tolerance > 0.0) && !are_finite(system, sources, pace->inputs.count))
            return fail_not_finite(system, sources, pace->inputs.count);
        if (!write_element(system, element, &pace->inputs.groups) ||
            (pace->has_slopes && !give_slopes(system, element, &pace->inputs.groups, begin)) ||
            !step_element(system, element, begin, step) || (system->watches && !keeps_floating_mode(system)))
            return false;
    }
    return true;
}

/* Read the element's outputs at *time*. */
static bool show(System *system, int64_t e, double time)
{
    const Plan *plan = system->plan;
    Element *element = &system->elements[e];
    memcpy(plan->before + element->first_value, system->values + element->first_value,
           (size_t)element->n_values * sizeof(double));
    plan->spans[e] = time - plan->shown[e];
    plan->shown[e] = system->now = time;
    return read_element(system, element, &element->outputs);
}

/* ---- elements that stop at ticks of clocks ---- */

/* One call of fmi3DoStep from *time* to *target*, or to an earlier time if the element may return early. */
static bool step_ticking(System *system, Element *element, double time, double step, double *target, double end)
{
    const double wanted = *target;
    bool has_event;
    double reached = time;
    if (!step_once(system, element, &reached, step, wanted, &has_event))
        return ends_at(system, end, end - time);
    *target = reached;
    ((Plan *)system->plan)->ticking[element->stepping.element].is_due |= has_event;
    return !system->watches || keeps_floating_mode(system);
}

/* All to *target*, or to where the first of them stops if it returns early; *rest* is the time from here to *end*. */
static bool step_together(System *system, const ClockGroup *group, double time, double rest, double *target, double end)
{
    const Clock *stopping;
    next_stop(system, group, &stopping);
    for (int64_t i = 0; i < group->n_elements && (*target > time || !i); i++) {
        Element *element = &system->elements[group->elements[i]];
        if (*target < end && !(element->abilities & CAN_VARY_STEP)) {
            enter_call(system, group->elements[i], DO_STEP);
            return fail_clock(system, BETWEEN_POINTS, stopping, *target);
        }
        if (!step_ticking(system, element, time, *target == end ? rest : *target - time, target, end))
            return false;
    }
    return true;
}

/* As drive, for all of a group: each sub-step ends at the next tick of a clock. */
static bool drive_group(System *system, const ClockGroup *group, double time, double length, double end)
{
    const Plan *plan = system->plan;
    int64_t standstill = 0;
    for (int64_t i = 0; i < group->n_elements; i++) {
        Element *element = &system->elements[group->elements[i]];
        const Pace *pace = &plan->paces[group->elements[i]];
        const int32_t *sources = plan->sources + pace->inputs.first;
        if (plan->n_bonds)
            note_used(system, &pace->inputs, time, length);
        move_along(system, &pace->inputs, time, length);
        if (plan->is_sequential && !are_finite(system, sources, pace->inputs.count))
            return fail_not_finite(system, sources, pace->inputs.count);
        system->now = time;
        if (!write_element(system, element, &pace->inputs.groups) ||
            (pace->has_slopes && !give_slopes(system, element, &pace->inputs.groups, time)))
            return false;
    }
    for (double at = time; at < end;) {
        const Clock *stopping;
        const double began = at, next = next_stop(system, group, &stopping);
        double target = next < end - plan->spare ? next : end;
        system->now = at;
        system->takes_end = target == end && plan->meeting.begin == plan->meeting.end;
        if (!step_together(system, group, at, at == time ? length : end - at, &target, end))
            return false;
        at = target;
        if (!(at > began)) {
            if (!is_due(system, group, at + plan->spare))
                return fail(system, STEP_CUT_SHORT, 0, 0, 0);
            if (++standstill > MOST_EVENT_ITERATIONS)
                return fail(system, ENDLESS_EVENTS, 0, 0, 0);
        }
        if (at < end && !pass_instants(system, group, at, false))
            return false;
    }
    return true;
}

static bool show_group(System *system, const ClockGroup *group, double time)
{
    for (int64_t i = 0; i < group->n_elements; i++)
        if (!show(system, group->elements[i], time))
            return false;
    return true;
}

/* ---- all elements ---- */

/* From *time* to *end*, which is *length* later. An element whose own step is *every* times as long starts or ends it
 * depending on the number k of the communication point. Elements before *first* have stepped already. The leading
 * elements show their outputs, before the others step, at the beginning of the step. */
static bool advance_from(System *system, int64_t first, double time, double length, double end)
{
    const Plan *plan = system->plan;
    const int64_t n_leading = plan->is_sequential ? 0 : plan->n_leading;
    for (int64_t e = first; e < n_leading; e++)
        if (!drive(system, e, time, length) || !show(system, e, time))
            return false;
    for (int64_t e = first > n_leading ? first : n_leading; e < system->n_elements; e++) {
        const int64_t every = plan->paces[e].every;
        if (plan->n_groups && plan->group_of[e] >= 0) {
            const ClockGroup *group = &plan->groups[plan->group_of[e]];
            if (group->leader == e && (!drive_group(system, group, time, length, end) ||
                                       (plan->is_sequential && !show_group(system, group, end))))
                return false;
            continue;
        }
        if (plan->k % every == 0 && !drive(system, e, time, (double)every * length))
            return false;
        if (plan->is_sequential && (plan->k + 1) % every == 0 && !show(system, e, end))
            return false;
    }
    if (!plan->is_sequential)
        for (int64_t e = n_leading; e < system->n_elements; e++)
            if ((plan->k + 1) % plan->paces[e].every == 0 && !show(system, e, end))
                return false;
    return true;
}

static bool advance(System *system, double time, double length, double end)
{
    return advance_from(system, 0, time, length, end);
}

static bool all_watched_finite(System *system)
{
    const Plan *plan = system->plan;
    for (int64_t i = 0; i < plan->n_watched; i++) {
        const double value = system->values[plan->watched[i]];
        if (!(fabs(value) <= DBL_MAX))
            return fail(system, NOT_FINITE, 0, plan->watched[i], value);
    }
    return true;
}

/* Beyond 2^53 times its nominal value a double cannot represent changes of the size of that value: the variable is
 * meaningless there. A variable that starts at such a value is checked relative to its start value. A variable without
 * a nominal value (infinite here) is not checked: its scale is unknown. */
static void set_limits(System *system)
{
    const Plan *plan = system->plan;
    for (int64_t i = 0; i < plan->n_watched; i++) {
        const double begin = fabs(system->values[plan->watched[i]]);
        plan->limits[i] = EXACT_INTEGER * (begin > plan->nominals[i] ? begin : plan->nominals[i]);
    }
}

/* Checked once, at the end of a run: a diverged value stays beyond its limits, or does not matter. */
static bool within_limits(System *system)
{
    const Plan *plan = system->plan;
    for (int64_t i = 0; i < plan->n_watched; i++) {
        const double value = system->values[plan->watched[i]];
        if (fabs(value) > plan->limits[i])
            return fail(system, DIVERGED, 0, plan->watched[i], value);
    }
    return true;
}

/* Work of the element behind an output on an input in its step that ends here, if one does. Both are means over the
 * step, as values at its end would differ even without loss. *met* is the output at the step's beginning. */
static double work(const System *system, int64_t output, int64_t input, double length, double *met)
{
    const Plan *plan = system->plan;
    const int32_t element = plan->owners[output];
    if (is_ahead(plan, element))
        return 0.0;
    const double mean = 0.5 * (*met + system->values[output]);
    *met = system->values[output];
    return (double)plan->paces[element].every * length * plan->used[input] * mean;
}

/* Pass values on at the communication point at *time*, after a step of *length* (0 for none). */
static bool meet(System *system, double time, double length)
{
    const Plan *plan = system->plan;
    system->now = time;
    if (!all_watched_finite(system))
        return false;
    if (plan->meeting.begin < plan->meeting.end && (!do_sweep(system, plan->meeting, false) || !all_watched_finite(system)))
        return false;
    for (int64_t i = 0; i < plan->n_bonds; i++) {
        const Bond *bond = &plan->bonds[i];
        plan->energies[i] += work(system, bond->flow, bond->effort_used, length, plan->met + 2 * i + 1);
        plan->energies[i] -= work(system, bond->effort, bond->flow_used, length, plan->met + 2 * i);
    }
    return true;
}

#endif
