/* The model as a system of ordinary differential equations: states in, derivatives out. Included after model.h. */
#ifndef DSE_EVALUATE_H
#define DSE_EVALUATE_H

#include "selection.h"

/* Store the error, unless there is an earlier one; false, so that a caller can return it. */
static bool dse_trouble(dse_component *m, int32_t code, uint32_t subject) {
    dse_reason *trouble = &m->solver.trouble;
    if (trouble->code == DSE_NO_TROUBLE) {
        trouble->code = code;
        trouble->subject = subject;
        trouble->time = m->time;
    }
    return false;
}

static inline void dse_forgive(dse_component *m) { m->solver.trouble.code = DSE_NO_TROUBLE; }

static inline void dse_put_states(dse_component *m, const double states[]) {
    for (int k = 0; k < DSE_STATES; k++) {
        m->v[dse_state[k]] = states[k];
    }
}

static inline void dse_get_states(const dse_component *m, double states[]) {
    for (int k = 0; k < DSE_STATES; k++) {
        states[k] = m->v[dse_state[k]];
    }
}

/* Newton's method starts from the roots of the last accepted point, for every trial point of the solver: if a loop has
 * several roots, a trial that went too far must not affect the next one. */
static inline void dse_put_roots(dse_component *m) {
    for (int k = 0; k < DSE_ROOTS; k++) {
        m->v[dse_root[k]] = m->root[k];
    }
}

static inline void dse_take_roots(dse_component *m) {
    for (int k = 0; k < DSE_ROOTS; k++) {
        m->root[k] = m->v[dse_root[k]];
    }
}

/* The values in v are accepted. */
static inline void dse_keep_roots(dse_component *m) {
    dse_take_roots(m);
    dse_keep_sides(m);
    if (fabs(m->time - m->settled) >= m->refused) {
        m->refused = 0.0;
    }
    m->settled = m->time;
}

/* The derivatives in v; false if one is not finite. */
static inline bool dse_get_slope(dse_component *m, double slope[]) {
    bool is_finite = true;
    for (int k = 0; k < DSE_STATES; k++) {
        slope[k] = m->v[dse_derivative[k]];
        is_finite = is_finite && isfinite(slope[k]);
    }
    for (int k = 0; !is_finite && k < DSE_STATES; k++) {
        if (!isfinite(slope[k])) {
            return dse_trouble(m, DSE_NOT_FINITE, k);
        }
    }
    return true;
}

/* Computes the derivatives for the values in v. */
static inline bool dse_derive_at(dse_component *m) {
    dse_put_roots(m);
    int code = model_derivatives(m);
    if (DSE_SELECTIONS > 0 && code == 0) {
        code = dse_selection_failure(m);
    }
    if (code > 0) {
        m->refused = fmax(m->refused, fabs(m->time - m->settled));
    } else if (DSE_MAY_JUMP(m)) {
        dse_take_roots(m); /* the jump is final: a step with parts on both branches would slide along the fold */
    }
    return code == 0 || dse_trouble(m, code, 0);
}

/* Set v for *states* at *time*. */
static inline bool dse_place(dse_component *m, double time, const double states[]) {
    m->time = time;
    dse_put_states(m, states);
    m->solver.past.evaluations++;
    m->solver.is_at_end = 0;
    return dse_derive_at(m);
}

static inline bool dse_slope(dse_component *m, double time, const double states[], double slope[]) {
    return dse_place(m, time, states) && dse_get_slope(m, slope);
}

#endif
