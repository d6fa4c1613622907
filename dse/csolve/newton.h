/* Nonlinear systems: damped Newton iteration with the natural monotonicity test, which is invariant to the scaling of
 * the equations (P. Deuflhard, Newton Methods for Nonlinear Problems, Springer 2004, algorithm NLEQ-ERR, section 3.3).
 *
 * The includer has defined:
 *   dse_problem            type: the owner of the equations
 *   DSE_VALUES_OF(p)       the doubles that include the unknowns
 *   DSE_LARGEST_SYSTEM     unknowns of the largest system
 *   DSE_MAY_JUMP(p)        whether another root is allowed where the branch of the present root ends
 */
#ifndef DSE_CSOLVE_NEWTON_H
#define DSE_CSOLVE_NEWTON_H

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "linear.h"

/* From the unknowns among the values: the equations' residuals, and with *jacobian* also its rows. Writes intermediate
 * results of the equations to the values. Nonzero: the error of the evaluation. */
typedef int dse_system(dse_problem *p, double *residual, double *jacobian);

#define DSE_NEWTON_STEPS 100
#define DSE_NEWTON_TOLERANCE 1e-12
#define DSE_NEWTON_LEAST_DAMPING 1e-8
#define DSE_NEWTON_NEAR 1e-9

/* The longest of the *step*'s parts, each relative to its *weight*; NaN if one is not finite. */
static inline double dse_newton_length(uint32_t n, const double *weight, const double *step) {
    double length = 0.0;
    for (uint32_t k = 0; k < n; k++) {
        const double part = fabs(step[k]) / weight[k];
        if (!(part <= DBL_MAX)) {
            return NAN;
        }
        length = fmax(length, part);
    }
    return length;
}

/* Whether the residuals are within the rounding errors of the Jacobian's terms. */
static inline int dse_newton_is_rounding(
    const dse_problem *p, uint32_t n, const uint32_t *place, const double *residual, const double *jacobian) {
    for (uint32_t i = 0; i < n; i++) {
        double terms = 0.0;
        for (uint32_t k = 0; k < n; k++) {
            terms += fabs(jacobian[i * n + k] * DSE_VALUES_OF(p)[place[k]]);
        }
        if (!(fabs(residual[i]) <= 8.0 * DBL_EPSILON * terms)) {
            return 0;
        }
    }
    return 1;
}

/* Whether all *count* numbers are finite. */
static inline int dse_newton_is_finite(size_t count, const double *numbers) {
    for (size_t k = 0; k < count; k++) {
        if (!(fabs(numbers[k]) <= DBL_MAX)) {
            return 0;
        }
    }
    return 1;
}

struct dse_newton_work {
    double residual[DSE_LARGEST_SYSTEM];
    double step[DSE_LARGEST_SYSTEM];
    double from[DSE_LARGEST_SYSTEM];
    double next[DSE_LARGEST_SYSTEM];
    double weight[DSE_LARGEST_SYSTEM];
    uint32_t pivot[DSE_LARGEST_SYSTEM];
    double jacobian[(size_t)DSE_LARGEST_SYSTEM * DSE_LARGEST_SYSTEM];
    double factors[(size_t)DSE_LARGEST_SYSTEM * DSE_LARGEST_SYSTEM];
};

/* One damped step: moves the unknowns and leaves the next, simplified correction in work->next and its residual in
 * work->residual. Returns its length, negative if no damping reduces the error. */
static inline double dse_newton_advance(dse_problem *p, uint32_t n, const uint32_t *place, dse_system *system,
    struct dse_newton_work *work, double *damping) {
    const double length = dse_newton_length(n, work->weight, work->step);
    for (uint32_t k = 0; k < n; k++) {
        work->from[k] = DSE_VALUES_OF(p)[place[k]];
    }
    for (;;) {
        double next = NAN;
        double best = 0.0;
        for (uint32_t k = 0; k < n; k++) {
            DSE_VALUES_OF(p)[place[k]] = work->from[k] + *damping * work->step[k];
        }
        /* An error at a trial point only shortens the step. */
        if (system(p, work->residual, NULL) == 0 && dse_newton_is_finite(n, work->residual)) {
            for (uint32_t k = 0; k < n; k++) {
                work->next[k] = -work->residual[k];
            }
            dse_substitute(n, work->factors, work->pivot, work->next);
            next = dse_newton_length(n, work->weight, work->next);
        }
        if (next <= (1.0 - 0.25 * *damping) * length || next <= DSE_NEWTON_TOLERANCE) {
            /* The next guess is the damping that the estimated curvature would have allowed. */
            double curvature = 0.0;
            for (uint32_t k = 0; k < n; k++) {
                const double bend = work->next[k] - (1.0 - *damping) * work->step[k];
                curvature = fmax(curvature, fabs(bend) / work->weight[k]);
            }
            best = curvature > 0.0 ? 0.5 * length * *damping * *damping / curvature : 1.0;
            *damping = fmin(1.0, fmax(best, *damping));
            return next;
        }
        if (*damping <= DSE_NEWTON_LEAST_DAMPING) {
            return -1.0;
        }
        *damping = fmax(0.5 * *damping, DSE_NEWTON_LEAST_DAMPING);
    }
}

static inline void dse_newton_move(dse_problem *p, uint32_t n, const uint32_t *place, const double *step) {
    for (uint32_t k = 0; k < n; k++) {
        DSE_VALUES_OF(p)[place[k]] += step[k];
    }
}

static inline int dse_newton_iterate(dse_problem *p, uint32_t n, const uint32_t *place, const double *scale,
    dse_system *system, struct dse_newton_work *work, int failure) {
    double damping = 1.0;
    double before = INFINITY;
    for (int count = 0; count < DSE_NEWTON_STEPS; count++) {
        double length, next;
        int code = system(p, work->residual, work->jacobian);
        if (code) {
            return code;
        }
        if (!dse_newton_is_finite(n, work->residual) || !dse_newton_is_finite((size_t)n * n, work->jacobian)) {
            return failure;
        }
        memcpy(work->factors, work->jacobian, (size_t)n * n * sizeof(double));
        if (dse_factorize(n, work->factors, work->pivot)) {
            return failure;
        }
        for (uint32_t k = 0; k < n; k++) {
            work->step[k] = -work->residual[k];
            work->weight[k] = fmax(fabs(DSE_VALUES_OF(p)[place[k]]), scale[k]);
        }
        dse_substitute(n, work->factors, work->pivot, work->step);
        length = dse_newton_length(n, work->weight, work->step);
        if (!(length <= DBL_MAX)) {
            return failure;
        }
        if (dse_newton_is_rounding(p, n, place, work->residual, work->jacobian)) {
            return 0;
        }
        /* At the limit of rounding a step no longer gets shorter. Even a short step is made: an unknown may be far
         * smaller than its scale. */
        if (length <= DSE_NEWTON_TOLERANCE || (length <= DSE_NEWTON_NEAR && length >= 0.5 * before)) {
            dse_newton_move(p, n, place, work->step);
            return 0;
        }
        before = length;
        next = dse_newton_advance(p, n, place, system, work, &damping);
        if (next < 0.0) {
            return length <= DSE_NEWTON_NEAR ? 0 : failure;
        }
        if (next <= DSE_NEWTON_TOLERANCE) {
            dse_newton_move(p, n, place, work->next);
            return 0;
        }
    }
    return failure;
}

#define DSE_JUMP_LEAST 1e-3
#define DSE_JUMP_DOUBLINGS 20

/* Where a branch of roots ends, as at a fold, the equations no longer determine one direction, that of the last Newton
 * step. The next roots are in this direction: search there on both sides of *before*, at growing distances. */
static inline int dse_newton_jump(dse_problem *p, uint32_t n, const uint32_t *place, const double *scale,
    dse_system *system, struct dse_newton_work *work, const double *before, int failure) {
    double way[DSE_LARGEST_SYSTEM];
    const double length = dse_newton_length(n, work->weight, work->step);
    const int is_known = length > 0.0 && length <= DBL_MAX;
    double reach = DSE_JUMP_LEAST;
    for (uint32_t k = 0; k < n; k++) {
        way[k] = is_known ? work->step[k] / length : fmax(fabs(before[k]), scale[k]);
    }
    for (int count = 0; count <= DSE_JUMP_DOUBLINGS; count++, reach *= 2.0) {
        for (int sign = 1; sign >= -1; sign -= 2) {
            for (uint32_t k = 0; k < n; k++) {
                DSE_VALUES_OF(p)[place[k]] = before[k] + sign * reach * way[k];
            }
            if (!dse_newton_iterate(p, n, place, scale, system, work, failure)) {
                return 0;
            }
        }
    }
    return failure;
}

/* Solve the *n* equations of *system* for the unknowns at *place* among the values, from their present values. *scale*
 * is the size below which an unknown is not compared relatively. Returns 0 if it is solved to 1e-12 or to the limit of
 * rounding; all values that *system* writes then belong to the solution. Else returns *failure* or the error of
 * *system*, and the unknowns are unchanged. */
static inline int dse_newton(dse_problem *p, uint32_t n, const uint32_t *place, const double *scale,
    dse_system *system, int failure) {
    struct dse_newton_work work;
    double before[DSE_LARGEST_SYSTEM];
    int code;
    for (uint32_t k = 0; k < n; k++) {
        before[k] = DSE_VALUES_OF(p)[place[k]];
        work.step[k] = 0.0;
        work.weight[k] = 1.0;
    }
    code = dse_newton_iterate(p, n, place, scale, system, &work, failure);
    if (code && DSE_MAY_JUMP(p)) {
        code = dse_newton_jump(p, n, place, scale, system, &work, before, failure);
    }
    if (!code) {
        code = system(p, work.residual, NULL);
    }
    if (code) {
        for (uint32_t k = 0; k < n; k++) {
            DSE_VALUES_OF(p)[place[k]] = before[k];
        }
    }
    return code;
}

#define DSE_CONTINUE_LONGEST 0.125
#define DSE_CONTINUE_SHORTEST 1e-6

/* The same for equations with homotopy: from their simplified expressions, *share 0, to the actual ones, 1, in steps
 * that are halved if Newton's method fails. */
static inline int dse_continue(dse_problem *p, uint32_t n, const uint32_t *place, const double *scale,
    dse_system *system, double *share, int failure) {
    double reached = 0.0;
    double step = DSE_CONTINUE_LONGEST;
    int code;
    *share = 0.0;
    code = dse_newton(p, n, place, scale, system, failure);
    while (!code && reached < 1.0) {
        *share = fmin(1.0, reached + step);
        code = dse_newton(p, n, place, scale, system, failure);
        if (!code) {
            reached = *share;
            step = fmin(2.0 * step, DSE_CONTINUE_LONGEST);
        } else if (step > DSE_CONTINUE_SHORTEST) {
            step *= 0.5;
            code = 0;
        }
    }
    *share = 1.0;
    return code;
}

#endif
