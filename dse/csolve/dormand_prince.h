/* One explicit step: Dormand and Prince's pair of order 5(4), first same as last, with dense output of order 4
 * (Hairer, Norsett, Wanner: Solving Ordinary Differential Equations I, II.5 and II.6). */
#ifndef DSE_CSOLVE_DORMAND_PRINCE_H
#define DSE_CSOLVE_DORMAND_PRINCE_H

#include "crossings.h"
#include "dormand_prince_tableau.h"

/* From *from*, whose derivatives are *slope*, over *width* to *to*, which is then the model's point. *error* is
 * relative to the allowed error. */
static inline dse_answer dse_dp_try(dse_problem *p, double *error) {
    struct dse_solver *s = dse_solver_of(p);
    const int64_t n = DSE_STATE_COUNT(p);
    const double width = s->width;
    dse_copy(s->stage[0], s->slope, n);
    for (int64_t j = 1; j < 7; j++) {
        double *states = j == 6 ? s->to : s->trial;
        for (int64_t k = 0; k < n; k++) {
            double sum = 0.0;
            for (int64_t i = 0; i < j; i++) {
                sum += dse_dp_weight[j][i] * s->stage[i][k];
            }
            states[k] = s->from[k] + width * sum;
        }
        const double time = j < 5 ? s->start + dse_dp_node[j] * width : s->end;
        dse_answer answer = dse_slope_at(p, time, states, s->stage[j]);
        if (answer == DSE_DONE) {
            answer = dse_sample(p, dse_dp_node[j]);
        }
        if (answer != DSE_DONE) {
            return answer;
        }
    }
    for (int64_t k = 0; k < n; k++) {
        double sum = 0.0;
        for (int64_t i = 0; i < 7; i++) {
            sum += dse_dp_error[i] * s->stage[i][k];
        }
        s->found[k] = width * sum;
    }
    *error = dse_error_norm(p, s->found);
    return DSE_DONE;
}

/* |h lambda| of the fastest mode, from the last two stages (Hairer, Wanner II, IV.2, 2.26); *trial* is the sixth. */
static inline double dse_dp_stiffness(dse_problem *p) {
    const struct dse_solver *s = dse_solver_of(p);
    double above = 0.0, below = 0.0;
    for (int64_t k = 0; k < DSE_STATE_COUNT(p); k++) {
        const double allowed = dse_allowed(p, k, s->from[k], s->to[k]);
        const double slopes = (s->stage[6][k] - s->stage[5][k]) / allowed;
        const double states = (s->to[k] - s->trial[k]) / allowed;
        above += slopes * slopes;
        below += states * states;
    }
    return below > 0.0 ? s->width * sqrt(above / below) : 0.0;
}

static inline void dse_dp_prepare(dse_problem *p) {
    struct dse_solver *s = dse_solver_of(p);
    const double width = s->width;
    for (int64_t k = 0; k < DSE_STATE_COUNT(p); k++) {
        const double gain = s->to[k] - s->from[k];
        const double bend = width * s->stage[0][k] - gain;
        double sum = 0.0;
        for (int64_t i = 0; i < 7; i++) {
            sum += dse_dp_dense[i] * s->stage[i][k];
        }
        s->dense[0][k] = gain;
        s->dense[1][k] = bend;
        s->dense[2][k] = gain - width * s->stage[6][k] - bend;
        s->dense[3][k] = width * sum;
    }
}

static inline void dse_dp_states(dse_problem *p, double part, double states[]) {
    const struct dse_solver *s = dse_solver_of(p);
    const double rest = 1.0 - part;
    for (int64_t k = 0; k < DSE_STATE_COUNT(p); k++) {
        states[k] = s->from[k]
                    + part * (s->dense[0][k]
                              + rest * (s->dense[1][k] + part * (s->dense[2][k] + rest * s->dense[3][k])));
    }
}

#endif
