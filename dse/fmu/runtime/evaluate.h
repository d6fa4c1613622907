/* The model as a system of ordinary differential equations: states in, derivatives out. Included after model.h. */
#ifndef DSE_EVALUATE_H
#define DSE_EVALUATE_H

#include "model.h"

/* Note what went wrong, unless something before it did; false, so that a caller can return it. */
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

/* The derivatives that stand in v; false if one is not finite. */
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

/* Make v that of *states* at *time*. */
static inline bool dse_place(dse_component *m, double time, const double states[]) {
    m->time = time;
    dse_put_states(m, states);
    m->solver.past.evaluations++;
    m->solver.is_at_end = 0;
    const int code = model_derivatives(m);
    return code == 0 || dse_trouble(m, code, 0);
}

static inline bool dse_slope(dse_component *m, double time, const double states[], double slope[]) {
    return dse_place(m, time, states) && dse_get_slope(m, slope);
}

#endif
