/* One explicit step: Dormand and Prince's pair of order 5(4), first same as last, with dense output of order 4
 * (Hairer, Norsett, Wanner: Solving Ordinary Differential Equations I, II.5 and II.6). */
#ifndef DSE_DORMAND_PRINCE_H
#define DSE_DORMAND_PRINCE_H

#include "crossings.h"
#include "dormand_prince_tableau.h"

/* From s->from, whose derivatives are s->slope, over s->width to s->to. *error* in parts of what is allowed, infinite
 * if the model cannot be evaluated on the way; v is then that of the last stage, else that of s->to. */
static void dse_dp_try(dse_component *m, double *error) {
    struct dse_solver *s = &m->solver;
    const double width = s->width;
    double difference[DSE_N];
    *error = INFINITY;
    memcpy(s->stage[0], s->slope, sizeof s->slope);
    for (uint32_t j = 1; j < 7; j++) {
        double *states = j == 6 ? s->to : s->trial;
        for (int k = 0; k < DSE_STATES; k++) {
            double sum = 0.0;
            for (uint32_t i = 0; i < j; i++) {
                sum += dse_dp_weight[j][i] * s->stage[i][k];
            }
            states[k] = s->from[k] + width * sum;
        }
        const double time = j < 5 ? s->start + dse_dp_node[j] * width : s->end;
        if (!dse_slope(m, time, states, s->stage[j]) || !dse_sample(m, dse_dp_node[j])) {
            return;
        }
    }
    for (int k = 0; k < DSE_STATES; k++) {
        double sum = 0.0;
        for (uint32_t i = 0; i < 7; i++) {
            sum += dse_dp_error[i] * s->stage[i][k];
        }
        difference[k] = width * sum;
    }
    *error = dse_error_norm(m, difference);
}

#if DSE_SOLVER == DSE_AUTO_SOLVER
/* |h lambda| of the fastest mode, from the last two stages (Hairer, Wanner II, IV.2, 2.26); s->trial is the sixth. */
static double dse_dp_stiffness(const dse_component *m) {
    const struct dse_solver *s = &m->solver;
    double above = 0.0, below = 0.0;
    for (int k = 0; k < DSE_STATES; k++) {
        const double allowed = dse_allowed(m, k, s->from[k], s->to[k]);
        const double slopes = (s->stage[6][k] - s->stage[5][k]) / allowed;
        const double states = (s->to[k] - s->trial[k]) / allowed;
        above += slopes * slopes;
        below += states * states;
    }
    return below > 0.0 ? s->width * sqrt(above / below) : 0.0;
}
#endif

static void dse_dp_prepare(dse_component *m) {
    struct dse_solver *s = &m->solver;
    const double width = s->width;
    for (int k = 0; k < DSE_STATES; k++) {
        const double gain = s->to[k] - s->from[k];
        const double bend = width * s->stage[0][k] - gain;
        double sum = 0.0;
        for (uint32_t i = 0; i < 7; i++) {
            sum += dse_dp_dense[i] * s->stage[i][k];
        }
        s->dense[0][k] = gain;
        s->dense[1][k] = bend;
        s->dense[2][k] = gain - width * s->stage[6][k] - bend;
        s->dense[3][k] = width * sum;
    }
}

static inline void dse_dp_states(const dse_component *m, double part, double states[]) {
    const struct dse_solver *s = &m->solver;
    const double rest = 1.0 - part;
    for (int k = 0; k < DSE_STATES; k++) {
        states[k] = s->from[k]
                    + part * (s->dense[0][k]
                              + rest * (s->dense[1][k] + part * (s->dense[2][k] + rest * s->dense[3][k])));
    }
}

#endif
