/* The loop that was compiled for one system (dse/fmu/fusion), instead of the loop over FMI calls. */
#ifndef DSE_COSIM_FUSED_H
#define DSE_COSIM_FUSED_H

#include "step_loop.h"
#include "element.h"

#include "csolve/fused_abi.h"

/* A component could not make its step: evaluates the status that an FMI call would have returned. */
RARE static void take_answer(System *system, const Element *element, const dse_fused_run *run, double time)
{
    const int status = (int)run->status;
    if (element->version == 3 && is_good(status)) {
        fail(system, STEP_CUT_SHORT, run->has_ended, 0, run->time);
        ends_at(system, time + run->step, run->step);
    } else if (element->version == 3 || (make_up(system, element, time, run->step, status) && !system->has_ended)) {
        fail_status(system, status);
    }
}

static dse_fused_run go_fused(System *system, const Request *request, int *ending)
{
    dse_fused_run run = {.instances = &system->elements->instance,
                         .stride = sizeof(Element),
                         .progress = &system->progress->place.element,
                         .call_step = DO_STEP,
                         .call_get = GET,
                         .step = request->step,
                         .steps = request->steps,
                         .out = request->out};
    *ending = ((dse_fused_loop *)system->fused)(&run);
    return run;
}

/* Makes steps up to the communication point that is then stored in progress: the last one, or one with an exception.
 * From there the loop over FMI calls continues, and determines the cause. */
static bool simulate_fused(System *system, const Request *request)
{
    Progress *const progress = system->progress;
    int ending;
    const dse_fused_run run = go_fused(system, request, &ending);
    system->fused_steps = progress->step;
    system->rows = progress->step + 1;
    if (ending == DSE_FUSED_STOPPED)
        return true;
    if (progress->place.call != DO_STEP)
        return fail_status(system, (int)run.status);
    const double time = (double)progress->step * run.step;
    int64_t e = progress->place.element;
    take_answer(system, &system->elements[e], &run, time);
    if (!system->has_ended)
        return false;
    while (++e < system->n_elements)
        if (!step_element(system, &system->elements[e], time, run.step))
            return false;
    progress->step++;
    return true;
}

/* The same with a loop of Gauss and Seidel. It may stop between two elements: those before the stored one have made the
 * step. FMI calls complete the step, and continue from the communication point *k*. */
static bool simulate_fused_in_turn(System *system, const Request *request, int64_t *k)
{
    Progress *const progress = system->progress;
    int ending;
    const dse_fused_run run = go_fused(system, request, &ending);
    const bool has_begun = progress->step >= 0;
    *k = system->fused_steps = has_begun ? progress->step : 0;
    int64_t first = has_begun ? progress->place.element : 0;
    const double time = (double)*k * run.step, end = (double)(*k + 1) * run.step;
    system->now = time;
    if (ending == DSE_FUSED_FAILED && progress->place.call != DO_STEP) {
        system->now = has_begun ? end : 0.0;
        return fail_status(system, (int)run.status);
    }
    if (first || ending == DSE_FUSED_FAILED)
        system->rows = *k + 1;
    if (ending == DSE_FUSED_FAILED) {
        system->takes_end = true;
        take_answer(system, &system->elements[first], &run, time);
        if (!system->has_ended)
            return false;
        first++;
    }
    for (int64_t e = 0; e < system->n_elements; e++)
        if (!show(system, e, e < first ? end : time))
            return false;
    if (!first)
        return true;
    ((Plan *)system->plan)->k = *k;
    *k += 1;
    return advance_from(system, first, time, run.step, end);
}

#endif
