/* One stiff step: Rodas5P, a Rosenbrock method of order 5(4), L-stable and stiffly accurate, with dense output of order
 * 4 (Steinebach: Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia
 * Differential Equations package, BIT Numer. Math. 63:27, 2023). The Jacobian is made of differences. */
#ifndef DSE_ROSENBROCK_H
#define DSE_ROSENBROCK_H

#include "crossings.h"
#include "linear.h"
#include "rosenbrock_tableau.h"

#define DSE_RO_ORDER 5.0

#if DSE_HAS_STIFF
/* Derivatives of the slope by the states and by time, at s->start; each difference leads the way the state goes,
 * or the other where the model has no values there. */
static bool dse_ro_differentiate(dse_component *m) {
    struct dse_solver *s = &m->solver;
    double slope[DSE_N];
    memcpy(s->trial, s->from, sizeof s->from);
    for (int column = 0; column < DSE_STATES; column++) {
        double size = sqrt(DBL_EPSILON) * fmax(fabs(s->from[column]), 1e-3 * dse_nominals[column]);
        size = s->slope[column] < 0.0 ? -size : size;
        s->trial[column] = s->from[column] + size;
        if (!dse_slope(m, s->start, s->trial, slope)) {
            dse_forgive(m);
            s->trial[column] = s->from[column] - size;
            if (!dse_slope(m, s->start, s->trial, slope)) {
                return false;
            }
        }
        const double moved = s->trial[column] - s->from[column];
        for (int row = 0; row < DSE_STATES; row++) {
            s->jacobian[row * DSE_STATES + column] = (slope[row] - s->slope[row]) / moved;
        }
        s->trial[column] = s->from[column];
    }
    const double later = s->start + sqrt(DBL_EPSILON * fmax(1e-5, fabs(s->start)));
    if (!dse_slope(m, later, s->from, slope)) {
        return false;
    }
    for (int row = 0; row < DSE_STATES; row++) {
        s->time_slope[row] = (slope[row] - s->slope[row]) / (later - s->start);
    }
    s->has_jacobian = 1;
    s->jacobians++;
    return true;
}

/* As dse_dp_try; in the end v is that of s->to, and its derivatives are s->stage[0]. */
static void dse_ro_try(dse_component *m, double *error) {
    struct dse_solver *s = &m->solver;
    const double width = s->width;
    double slope[DSE_N];
    *error = INFINITY;
    if (!s->has_jacobian && !dse_ro_differentiate(m)) {
        return;
    }
    for (int k = 0; k < DSE_STATES * DSE_STATES; k++) {
        s->factors[k] = -s->jacobian[k];
    }
    for (int k = 0; k < DSE_STATES; k++) {
        s->factors[k * DSE_STATES + k] += 1.0 / (dse_ro_gamma * width);
    }
    if (dse_factorize(DSE_STATES, s->factors, s->pivot)) {
        (void)dse_trouble(m, DSE_SINGULAR, 0);
        return;
    }
    for (uint32_t j = 0; j < 8; j++) {
        const double *at = s->slope;
        if (j > 0) {
            for (int k = 0; k < DSE_STATES; k++) {
                double sum = s->from[k];
                for (uint32_t i = 0; i < j; i++) {
                    sum += dse_ro_weight[j][i] * s->stage[i][k];
                }
                s->trial[k] = sum;
            }
            if (!dse_slope(m, j < 5 ? s->start + dse_ro_node[j] * width : s->end, s->trial, slope)) {
                return;
            }
            if (j < 6 && !dse_sample(m, dse_ro_node[j])) {
                return;
            }
            at = slope;
        }
        for (int k = 0; k < DSE_STATES; k++) {
            double sum = 0.0;
            for (uint32_t i = 0; i < j; i++) {
                sum += dse_ro_shift[j][i] * s->stage[i][k];
            }
            s->stage[j][k] = at[k] + sum / width + width * dse_ro_time[j] * s->time_slope[k];
        }
        dse_substitute(DSE_STATES, s->factors, s->pivot, s->stage[j]);
    }
    for (int k = 0; k < DSE_STATES; k++) {
        s->to[k] = s->trial[k] + s->stage[7][k];
    }
    *error = dse_error_norm(m, s->stage[7]);
}

static void dse_ro_prepare(dse_component *m) {
    struct dse_solver *s = &m->solver;
    for (int k = 0; k < DSE_STATES; k++) {
        for (uint32_t row = 0; row < 3; row++) {
            double sum = 0.0;
            for (uint32_t i = 0; i < 8; i++) {
                sum += dse_ro_dense[row][i] * s->stage[i][k];
            }
            s->dense[row][k] = sum;
        }
        s->dense[3][k] = s->to[k] - s->from[k]; /* an event moves s->to */
    }
}

static inline void dse_ro_states(const dse_component *m, double part, double states[]) {
    const struct dse_solver *s = &m->solver;
    const double rest = 1.0 - part;
    for (int k = 0; k < DSE_STATES; k++) {
        const double bend = s->dense[0][k] + part * (s->dense[1][k] + part * s->dense[2][k]);
        states[k] = s->from[k] + part * (s->dense[3][k] + rest * bend);
    }
}

#if DSE_SOLVER == DSE_AUTO_SOLVER
/* h times a bound of the fastest mode's rate: the lesser of the greatest sums of a row and of a column. */
static double dse_ro_stiffness(const dse_component *m) {
    const struct dse_solver *s = &m->solver;
    double by_row = 0.0, by_column = 0.0;
    for (int k = 0; k < DSE_STATES; k++) {
        double row = 0.0, column = 0.0;
        for (int j = 0; j < DSE_STATES; j++) {
            const double scale = dse_nominals[j] / dse_nominals[k];
            row += fabs(s->jacobian[k * DSE_STATES + j]) * scale;
            column += fabs(s->jacobian[j * DSE_STATES + k]) / scale;
        }
        by_row = fmax(by_row, row);
        by_column = fmax(by_column, column);
    }
    return s->width * fmin(by_row, by_column);
}
#endif
#endif

#endif
