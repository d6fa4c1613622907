/* The interface of a model for the solvers: states in, derivatives and crossing functions out. The includer defines all
 * functions that are only declared here. Nothing is allocated, and no function is called through a pointer.
 *
 * The includer has included memory.h, and defined:
 *   dse_problem            type: the model, which contains its struct dse_solver
 *   DSE_STATE_COUNT(p), DSE_CROSSING_COUNT(p)
 *   DSE_LOOK_SIZE(p)       doubles of a look: the crossing functions, then other data for dse_is_crossed
 *   DSE_NOMINAL(p, k)      size of state number k
 *   DSE_ABSOLUTE           part of the nominal value that the tolerance is relative to where a state is 0
 *   DSE_HAS_STIFF          whether there is a stiff solver
 *   DSE_MAY_CHOOSE(p)      whether the solver may change between steps
 *   DSE_STIFF_FROM         limit of |h lambda| for the stability of the explicit solver
 * Counts and DSE_HAS_STIFF may be compile-time constants. */
#ifndef DSE_CSOLVE_PROBLEM_H
#define DSE_CSOLVE_PROBLEM_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "memory.h"

/* Whether a point can be evaluated. REFUSED: not this point, another may be tried; the reason is stored as trouble.
 * FAILED: no point can be evaluated any more, and the reason has been reported. */
typedef enum { DSE_DONE, DSE_REFUSED, DSE_FAILED } dse_answer;

static inline struct dse_solver *dse_solver_of(dse_problem *p);

/* The derivatives of *states* at *time*, all finite. This becomes the model's present point. */
static inline dse_answer dse_slope_at(dse_problem *p, double time, const double states[], double slope[]);

/* The crossing functions at the model's present point. */
static inline dse_answer dse_look(dse_problem *p, double look[]);

/* The same at another point of a step: on the dense output; and at a border, where derivatives may have no values. */
static inline dse_answer dse_look_within(dse_problem *p, double time, const double states[], double look[]);
static inline dse_answer dse_look_beyond(dse_problem *p, double time, const double states[], double look[]);

/* Whether crossing function *k* is on the other side of zero, compared with the beginning of the step. */
static inline bool dse_is_crossed(dse_problem *p, const double look[], int64_t k);

/* The derivatives of *slope* by the states at *from*, if the model provides them; *is_told*. */
static inline dse_answer dse_told_jacobian(dse_problem *p, bool *is_told);

/* A step is accepted, and its end is the model's present point. */
static inline void dse_settle(dse_problem *p);

/* Store as trouble that the stiff solver's matrix is singular. */
static inline dse_answer dse_refuse_singular(dse_problem *p);

/* Whether the trouble may be that there are no values beyond a border. */
static inline bool dse_wants_values(dse_problem *p);

/* False, and reports the cause: the trouble if the last answer was REFUSED; after DONE, that no step was accurate. */
static inline bool dse_give_up(dse_problem *p, dse_answer last);

/* The allowed error of state number *k*. */
static inline double dse_allowed(dse_problem *p, int64_t k, double one, double other) {
    return dse_solver_of(p)->tolerance * (DSE_ABSOLUTE * DSE_NOMINAL(p, k) + fmax(fabs(one), fabs(other)));
}

/* Largest error of the last step, relative to the allowed one; infinite if one is not a number. */
static inline double dse_error_norm(dse_problem *p, const double error[]) {
    const struct dse_solver *s = dse_solver_of(p);
    double largest = 0.0;
    for (int64_t k = 0; k < DSE_STATE_COUNT(p); k++) {
        const double part = fabs(error[k]) / dse_allowed(p, k, s->from[k], s->to[k]);
        largest = part > largest || part != part ? part : largest;
    }
    return largest == largest ? largest : INFINITY;
}

static inline void dse_copy(double to[], const double from[], int64_t count) {
    memcpy(to, from, (size_t)count * sizeof *to);
}

#endif
