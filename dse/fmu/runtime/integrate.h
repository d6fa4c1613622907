/* The interface of a model for the solvers of csolve, and the start of an integration. */
#ifndef DSE_INTEGRATE_H
#define DSE_INTEGRATE_H

#include "relations.h"

#define DSE_STATE_COUNT(m) DSE_STATES
#define DSE_CROSSING_COUNT(m) DSE_RELATIONS
#define DSE_LOOK_SIZE(m) DSE_LOOK
#define DSE_NOMINAL(m, k) dse_nominals[k]
#define DSE_ABSOLUTE 1.0
#define DSE_MAY_CHOOSE(m) (DSE_SOLVER == DSE_AUTO_SOLVER)
#define DSE_STIFF_FROM 3.25 /* close to the limit of the region of stability */
#include "csolve/step.h"

static inline struct dse_solver *dse_solver_of(dse_component *m) { return &m->solver; }

static inline dse_answer dse_answer_of(bool is_done) { return is_done ? DSE_DONE : DSE_REFUSED; }

static inline dse_answer dse_slope_at(dse_component *m, double time, const double states[], double slope[]) {
    dse_forgive(m);
    return dse_answer_of(dse_place(m, time, states) && dse_get_slope(m, slope));
}

static inline dse_answer dse_look(dse_component *m, double look[]) { return dse_answer_of(dse_see(m, look)); }

static inline dse_answer dse_look_within(dse_component *m, double time, const double states[], double look[]) {
    return dse_answer_of(dse_place(m, time, states) && dse_see(m, look));
}

static inline dse_answer dse_look_beyond(dse_component *m, double time, const double states[], double look[]) {
    (void)dse_place(m, time, states);
    dse_forgive(m);
    return dse_answer_of(dse_see(m, look));
}

static inline bool dse_is_crossed(dse_component *m, const double look[], int64_t k) { return dse_is_other(m, look, k); }

static inline dse_answer dse_told_jacobian(dse_component *m, bool *is_told) {
    (void)m;
    *is_told = false;
    return DSE_DONE;
}

static inline void dse_settle(dse_component *m) { dse_keep_roots(m); }

static inline dse_answer dse_refuse_singular(dse_component *m) {
    dse_forgive(m);
    return dse_answer_of(dse_trouble(m, DSE_SINGULAR, 0));
}

static inline bool dse_wants_values(dse_component *m) {
    return m->solver.trouble.code > 0 || m->solver.trouble.code == DSE_NOT_FINITE;
}

static inline bool dse_give_up(dse_component *m, dse_answer last) {
    if (last == DSE_DONE) {
        m->time = m->solver.start;
        return dse_trouble(m, DSE_TOO_INACCURATE, 0);
    }
    return false;
}

/* Restart from the values in v, whose derivatives are up to date. */
static bool dse_restart(dse_component *m) {
    struct dse_solver *s = &m->solver;
    s->end = m->time;
    s->has_step = s->has_event = 0;
    dse_get_states(m, s->to);
    dse_keep_roots(m);
    return dse_see(m, s->at_end) && dse_get_slope(m, s->slope);
}

#endif
