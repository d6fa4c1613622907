/* The loop that was compiled for one system (dse/fmu/fusion), in the place of the one over FMI calls. */
#ifndef DSE_COSIM_FUSED_H
#define DSE_COSIM_FUSED_H

#include "element.h"

#include "csolve/fused_abi.h"

/* A component could not make its step: the answer it would have given an FMI call decides what that means. */
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

/* Makes steps up to the communication point that is noted in progress then: the last one, or one that something is
 * unusual about. There the loop over FMI calls goes on, and finds out. */
static bool simulate_fused(System *system, const Request *request)
{
    Progress *const progress = system->progress;
    dse_fused_run run = {.instances = &system->elements->instance,
                         .stride = sizeof(Element),
                         .progress = &progress->place.element,
                         .call_step = DO_STEP,
                         .call_get = GET,
                         .step = request->step,
                         .steps = request->steps,
                         .out = request->out};
    const int ending = ((dse_fused_loop *)system->fused)(&run);
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

#endif
