/* What the solvers ask of a model: states in, derivatives and crossing functions out. Included where all functions that
 * are only declared here will be defined; nothing is allocated, and nothing called through a pointer.
 *
 * Who includes this has included memory.h, and defined:
 *   dse_problem            type: the model, which knows its struct dse_solver
 *   DSE_STATE_COUNT(p), DSE_CROSSING_COUNT(p)
 *   DSE_LOOK_SIZE(p)       doubles of a look: the crossing functions, and behind them what else dse_is_crossed needs
 *   DSE_NOMINAL(p, k)      size of state number k
 *   DSE_ABSOLUTE           part of the nominal value that the tolerance is relative to where a state is 0
 *   DSE_HAS_STIFF          whether there is a stiff solver
 *   DSE_MAY_CHOOSE(p)      whether the solvers take turns
 *   DSE_STIFF_FROM         |h lambda| that stability alone holds the explicit solver to
 * Counts and DSE_HAS_STIFF may be known to the compiler. */
#ifndef DSE_CSOLVE_PROBLEM_H
#define DSE_CSOLVE_PROBLEM_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "memory.h"

/* Whether a point can be evaluated. REFUSED: not this one, so another may be tried; the reason is noted as trouble.
 * FAILED: none ever again, and why has been told. */
typedef enum { DSE_DONE, DSE_REFUSED, DSE_FAILED } dse_answer;

static inline struct dse_solver *dse_solver_of(dse_problem *p);

/* The derivatives of *states* at *time*, all finite. The model then stands there. */
static inline dse_answer dse_slope_at(dse_problem *p, double time, const double states[], double slope[]);

/* The crossing functions where the model stands. */
static inline dse_answer dse_look(dse_problem *p, double look[]);

/* The same somewhere else within a step: on the dense output; and at a border, where derivatives may have no values. */
static inline dse_answer dse_look_within(dse_problem *p, double time, const double states[], double look[]);
static inline dse_answer dse_look_beyond(dse_problem *p, double time, const double states[], double look[]);

/* Whether crossing function *k* is on another side than at the beginning of the step. */
static inline bool dse_is_crossed(dse_problem *p, const double look[], int64_t k);

/* The derivatives of *slope* by the states at *from*, if the model can tell; *is_told*. */
static inline dse_answer dse_told_jacobian(dse_problem *p, bool *is_told);

/* A step is accepted, and the model stands at its end. */
static inline void dse_settle(dse_problem *p);

/* Note as trouble that the stiff solver's matrix is singular. */
static inline dse_answer dse_refuse_singular(dse_problem *p);

/* Whether the trouble may be that there are no values beyond a border. */
static inline bool dse_wants_values(dse_problem *p);

/* False, and tell why: the trouble if the last answer was REFUSED; after DONE, that no step was accurate enough. */
static inline bool dse_give_up(dse_problem *p, dse_answer last);

/* How large an error of state number *k* may be. */
static inline double dse_allowed(dse_problem *p, int64_t k, double one, double other) {
    return dse_solver_of(p)->tolerance * (DSE_ABSOLUTE * DSE_NOMINAL(p, k) + fmax(fabs(one), fabs(other)));
}

/* Largest of the errors of the last step, in parts of what is allowed; infinite if one is not a number. */
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
