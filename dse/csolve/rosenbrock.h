/* One stiff step: Rodas5P, a Rosenbrock method of order 5(4), L-stable and stiffly accurate, with dense output of order
 * 4 (Steinebach: Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia
 * Differential Equations package, BIT Numer. Math. 63:27, 2023). The Jacobian is computed by differences if the model
 * does not provide it. */
#ifndef DSE_CSOLVE_ROSENBROCK_H
#define DSE_CSOLVE_ROSENBROCK_H

#include "crossings.h"
#include "linear.h"
#include "rosenbrock_tableau.h"

/* The difference is in the direction of the state's slope, or opposite if the model has no values there. */
static inline dse_answer dse_ro_column(dse_problem *p, int64_t column) {
    struct dse_solver *s = dse_solver_of(p);
    const int64_t n = DSE_STATE_COUNT(p);
    double size = sqrt(DBL_EPSILON) * fmax(fabs(s->from[column]), 1e-3 * DSE_NOMINAL(p, column));
    size = s->slope[column] < 0.0 ? -size : size;
    s->trial[column] = s->from[column] + size;
    dse_answer answer = dse_slope_at(p, s->start, s->trial, s->found);
    if (answer == DSE_REFUSED) {
        s->trial[column] = s->from[column] - size;
        answer = dse_slope_at(p, s->start, s->trial, s->found);
    }
    const double moved = s->trial[column] - s->from[column];
    for (int64_t row = 0; row < n; row++) {
        s->jacobian[row * n + column] = (s->found[row] - s->slope[row]) / moved;
    }
    s->trial[column] = s->from[column];
    return answer;
}

/* Derivatives of the slope by the states and by time, at *start*. */
static inline dse_answer dse_ro_differentiate(dse_problem *p) {
    struct dse_solver *s = dse_solver_of(p);
    const int64_t n = DSE_STATE_COUNT(p);
    bool is_told = false;
    dse_answer answer = dse_told_jacobian(p, &is_told);
    dse_copy(s->trial, s->from, n);
    for (int64_t column = 0; !is_told && answer == DSE_DONE && column < n; column++) {
        answer = dse_ro_column(p, column);
    }
    const double later = s->start + sqrt(DBL_EPSILON * fmax(1e-5, fabs(s->start)));
    if (answer == DSE_DONE) {
        answer = dse_slope_at(p, later, s->from, s->found);
    }
    if (answer != DSE_DONE) {
        return answer;
    }
    for (int64_t row = 0; row < n; row++) {
        s->time_slope[row] = (s->found[row] - s->slope[row]) / (later - s->start);
    }
    s->has_jacobian = 1;
    s->past.jacobians++;
    return DSE_DONE;
}

/* As dse_dp_try; at the end the model's point is close to *to*, but not equal. */
static inline dse_answer dse_ro_try(dse_problem *p, double *error) {
    struct dse_solver *s = dse_solver_of(p);
    const int64_t n = DSE_STATE_COUNT(p);
    const double width = s->width;
    dse_answer answer = s->has_jacobian ? DSE_DONE : dse_ro_differentiate(p);
    if (answer != DSE_DONE) {
        return answer;
    }
    for (int64_t k = 0; k < n * n; k++) {
        s->factors[k] = -s->jacobian[k];
    }
    for (int64_t k = 0; k < n; k++) {
        s->factors[k * n + k] += 1.0 / (dse_ro_gamma * width);
    }
    if (dse_factorize((uint32_t)n, s->factors, s->pivot)) {
        return dse_refuse_singular(p);
    }
    for (int64_t j = 0; j < 8; j++) {
        const double *at = s->slope;
        if (j > 0) {
            for (int64_t k = 0; k < n; k++) {
                double sum = s->from[k];
                for (int64_t i = 0; i < j; i++) {
                    sum += dse_ro_weight[j][i] * s->stage[i][k];
                }
                s->trial[k] = sum;
            }
            answer = dse_slope_at(p, j < 5 ? s->start + dse_ro_node[j] * width : s->end, s->trial, s->found);
            if (answer == DSE_DONE && j < 6) {
                answer = dse_sample(p, dse_ro_node[j]);
            }
            if (answer != DSE_DONE) {
                return answer;
            }
            at = s->found;
        }
        for (int64_t k = 0; k < n; k++) {
            double sum = 0.0;
            for (int64_t i = 0; i < j; i++) {
                sum += dse_ro_shift[j][i] * s->stage[i][k];
            }
            s->stage[j][k] = at[k] + sum / width + width * dse_ro_time[j] * s->time_slope[k];
        }
        dse_substitute((uint32_t)n, s->factors, s->pivot, s->stage[j]);
    }
    for (int64_t k = 0; k < n; k++) {
        s->to[k] = s->trial[k] + s->stage[7][k];
    }
    *error = dse_error_norm(p, s->stage[7]);
    return DSE_DONE;
}

static inline void dse_ro_prepare(dse_problem *p) {
    struct dse_solver *s = dse_solver_of(p);
    for (int64_t k = 0; k < DSE_STATE_COUNT(p); k++) {
        for (int64_t row = 0; row < 3; row++) {
            double sum = 0.0;
            for (int64_t i = 0; i < 8; i++) {
                sum += dse_ro_dense[row][i] * s->stage[i][k];
            }
            s->dense[row][k] = sum;
        }
        s->dense[3][k] = s->to[k] - s->from[k]; /* an event moves *to* */
    }
}

static inline void dse_ro_states(dse_problem *p, double part, double states[]) {
    const struct dse_solver *s = dse_solver_of(p);
    const double rest = 1.0 - part;
    for (int64_t k = 0; k < DSE_STATE_COUNT(p); k++) {
        const double bend = s->dense[0][k] + part * (s->dense[1][k] + part * s->dense[2][k]);
        states[k] = s->from[k] + part * (s->dense[3][k] + rest * bend);
    }
}

/* h times a bound of the fastest mode's rate: the smaller one of the largest row sum and the largest column sum. */
static inline double dse_ro_stiffness(dse_problem *p) {
    const struct dse_solver *s = dse_solver_of(p);
    const int64_t n = DSE_STATE_COUNT(p);
    double by_row = 0.0, by_column = 0.0;
    for (int64_t k = 0; k < n; k++) {
        double row = 0.0, column = 0.0;
        for (int64_t j = 0; j < n; j++) {
            const double scale = DSE_NOMINAL(p, j) / DSE_NOMINAL(p, k);
            row += fabs(s->jacobian[k * n + j]) * scale;
            column += fabs(s->jacobian[j * n + k]) / scale;
        }
        by_row = fmax(by_row, row);
        by_column = fmax(by_column, column);
    }
    return s->width * fmin(by_row, by_column);
}

#endif
