/* Inputs that follow a straight line while an element steps. */
#ifndef DSE_COSIM_SLOPES_H
#define DSE_COSIM_SLOPES_H

#include "access.h"
#include "log.h"

/* The slope of a value at the end of its wire. */
static double slope_arriving(const Group *group, int64_t i)
{
    return group->transforms ? group->transforms[i].factor * group->slopes[i] : group->slopes[i];
}

/* Inside of the FMU: offsets have no effect. */
static double slope_inside(const Group *group, int64_t i)
{
    return group->conversions ? slope_arriving(group, i) / group->conversions[i].factor : slope_arriving(group, i);
}

/* FMI 1 and 2 take slopes in addition to values; a *factor* of 0 cancels them. */
static bool set_derivatives(System *system, const Element *element, double factor)
{
    for (const Group *group = element->moving->fmi2; group < element->moving->fmi3; group++) {
        if (!group->slopes)
            continue;
        for (int64_t i = 0; i < group->n_values; i++)
            group->scratch[i] = factor * slope_inside(group, i);
        enter_call(system, group->place.element, SET_INPUT_DERIVATIVES);
        if (!accept(system, ((Fmi2SetDerivatives)element->set_input_derivatives)(element->instance, group->references,
                                                                                 (size_t)group->count, group->orders,
                                                                                 group->scratch)))
            return false;
    }
    return true;
}

static bool takes_derivatives(const Element *element)
{
    return element->version < 3 && !element->exchange;
}

/* From *time* on, when they were written, *inputs* follow their slopes, until they are held or get new ones. */
OFFERED static bool give_slopes(System *system, Element *element, const Groups *inputs, double time)
{
    element->moving = inputs;
    element->moving_from = time;
    return !takes_derivatives(element) || set_derivatives(system, element, 1.0);
}

OFFERED static bool hold_inputs(System *system, Element *element)
{
    const bool taken_back =
        !element->moving || !takes_derivatives(element) || set_derivatives(system, element, 0.0);
    element->moving = NULL;
    return taken_back;
}

static bool move_group(System *system, const Group *group, double elapsed)
{
    memcpy(group->scratch, group->values, (size_t)group->n_values * sizeof(double));
    carry(group, group->scratch);
    for (int64_t i = 0; i < group->n_values; i++)
        group->scratch[i] += slope_arriving(group, i) * elapsed;
    /* Only numbers without items have slopes: the only possible failure is a number that is too large. */
    turn_inside(group, group->scratch);
    if (!keeps_finite(system, group, UNFIT_INPUT))
        return false;
    const int64_t good = narrow(group, group->scratch);
    if (good < group->n_values)
        return fail_value(system, UNFIT_INPUT, group, good, group->scratch[good]);
    return group->version < 3 ? call_fmi2(system, system->progress, group) : call_fmi3(system, system->progress, group);
}

/* Set the inputs to their values at *time*; no operation without slopes. */
static bool move_inputs(System *system, const Element *element, double time)
{
    if (!element->moving)
        return true;
    for (const Group *group = element->moving->fmi2; group < element->moving->end; group++)
        if (group->slopes && !move_group(system, group, time - element->moving_from))
            return false;
    return true;
}

/* FMI 3: called by an FMU from within its step. */
static void update_between(void *environment, double time, bool set_requested, bool get_allowed, bool step_finished,
                           bool can_return_early, bool *return_early, double *return_time)
{
    (void)get_allowed, (void)step_finished, (void)can_return_early, (void)return_time;
    Element *element = element_of(environment);
    if (return_early)
        *return_early = false;
    if (!set_requested || !element || element->broken)
        return;
    element->asked++;
    element->broken = !move_inputs(element->system, element, time);
    if (!element->broken)
        element->system->progress->place = element->stepping;
}

#endif
