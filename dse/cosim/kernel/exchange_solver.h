/* The functions of a model exchange element for the solvers of csolve, and one solver step. */
#ifndef DSE_COSIM_EXCHANGE_SOLVER_H
#define DSE_COSIM_EXCHANGE_SOLVER_H

#include "exchange_calls.h" /* before csolve: defines the type that the solvers work on */

#include "csolve/step.h"

static inline struct dse_solver *dse_solver_of(const Element *p)
{
    return &exchange_of(p)->solver;
}

static inline dse_answer dse_slope_at(const Element *p, double time, const double states[], double slope[])
{
    return find_slope(p->system, p, time, states, slope);
}

static inline dse_answer dse_look(const Element *p, double look[])
{
    return get_indicators(p->system, p, look);
}

/* The slope is not needed; some FMUs compute their indicators with it. */
static inline dse_answer dse_look_within(const Element *p, double time, const double states[], double look[])
{
    const dse_answer answer = find_slope(p->system, p, time, states, dse_solver_of(p)->found);
    return answer == DSE_DONE ? dse_look(p, look) : answer;
}

static inline dse_answer dse_look_beyond(const Element *p, double time, const double states[], double look[])
{
    const dse_answer answer = put_point(p->system, p, time, states);
    return answer == DSE_DONE ? dse_look(p, look) : answer;
}

/* An event occurs where an indicator changes from above zero to zero or below, or back (FMI 2.0.4, 3.1). */
static inline bool dse_is_crossed(const Element *p, const double look[], int64_t k)
{
    return (dse_solver_of(p)->at_end[k] > 0.0) != (look[k] > 0.0);
}

static dse_answer told_column(System *system, const Element *element, size_t column)
{
    Exchange *x = element->exchange;
    const size_t n = (size_t)x->n_states, count = (size_t)x->n_references;
    double *const seed = x->solver.time_slope, *const found = x->solver.found;
    memset(seed, 0, n * sizeof(double));
    seed[column] = 1.0;
    if (!directional_derivative(system, element, x->derivative_references, count, x->state_references, count, seed, n,
                                found, n)) {
        const bool is_refused = system->failure.kind == BAD_STATUS && system->failure.status == FMI_DISCARD;
        return is_refused ? refuse(system, x, BAD_STATUS, FMI_DISCARD, 0) : DSE_FAILED;
    }
    for (size_t row = 0; row < n; row++) {
        if (!isfinite(found[row]))
            return refuse(system, x, SLOPE_NOT_FINITE, 0, (int64_t)row);
        x->solver.jacobian[row * n + column] = found[row];
    }
    return DSE_DONE;
}

static inline dse_answer dse_told_jacobian(const Element *p, bool *is_told)
{
    *is_told = p->abilities & CAN_DIRECTIONAL;
    if (!*is_told)
        return DSE_DONE;
    dse_answer answer = put_point(p->system, p, dse_solver_of(p)->start, dse_solver_of(p)->from);
    for (size_t column = 0; answer == DSE_DONE && column < (size_t)DSE_STATE_COUNT(p); column++)
        answer = told_column(p->system, p, column);
    return answer;
}

static inline dse_answer dse_refuse_singular(const Element *p)
{
    return refuse(p->system, p->exchange, SINGULAR, 0, 0);
}

/* No action: complete_step reports an accepted step to the FMU at the end of the step. */
static inline void dse_settle(const Element *p)
{
    (void)p;
}

static inline bool dse_wants_values(const Element *p)
{
    (void)p;
    return true;
}

static inline bool dse_give_up(const Element *p, dse_answer last)
{
    if (last == DSE_DONE)
        return fail_at(p->system, p->exchange, TOO_INACCURATE, 0);
    return must(p->system, p, last);
}

/* One step from now.time, at most to *limit*. */
static bool take_step(System *system, const Element *element, double limit)
{
    Exchange *x = element->exchange;
    struct dse_solver *s = &x->solver;
    s->end = x->now.time;
    if (x->n_states > 0 || x->n_indicators > 0)
        return dse_take_step(element, limit);
    s->has_event = 0;
    s->end = limit;
    s->past.steps++;
    return must(system, element, put_point(system, element, limit, s->to)) && (s->is_at_end = 1);
}

#endif
