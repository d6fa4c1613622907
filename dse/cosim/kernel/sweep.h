/* Sweeps: reads and writes one after another. They include loops of outputs that depend on each other, which are solved
 * by repeated sweeps, first until nothing changes, then by Newton's method. */
#ifndef DSE_COSIM_SWEEP_H
#define DSE_COSIM_SWEEP_H

#include "element.h" /* before all system headers */
#include "plan.h"

#include "csolve/linear.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define SOLVED 1e-12      /* residual relative to the size of each value */
#define NEARLY_SOLVED 1e-9 /* sufficient if it cannot be reduced further */
#define SHORT 1e-6 /* limit of the remaining correction, relative to the size of each value */
#define DIFFERENCE 0x1p-26 /* the square root of a double's precision: the best step of a one-sided difference */

enum { NEWTON_STEPS = 50, HALVINGS = 10, EXCHANGES = 20 };

/* ---- operations ---- */

/* An FMU discards a step that is too long, and values outside of its domain. */
static bool is_discarded(const System *system)
{
    return system->failure.kind == BAD_STATUS && system->failure.status == FMI_DISCARD;
}

/* In the middle of its own step an element is ahead of the others: it is neither written nor read. */
static bool is_ahead(const Plan *plan, int64_t element)
{
    return plan->k % plan->paces[element].every != 0;
}

/* Fails for the first of *count* values that is not finite; positions[i] is its position. */
RARE static bool fail_not_finite(System *system, const int32_t *positions, int64_t count)
{
    int64_t i = 0;
    while (i < count - 1 && fabs(system->values[positions[i]]) <= DBL_MAX)
        i++;
    return fail(system, NOT_FINITE, 0, positions[i], system->values[positions[i]]);
}

static bool are_finite(const System *system, const int32_t *positions, int64_t count)
{
    bool are = true;
    for (int64_t i = 0; i < count; i++)
        are &= fabs(system->values[positions[i]]) <= DBL_MAX;
    return are;
}

static bool solve(System *system, Loop *loop);

/* Passed values must be finite, except within a *loop* that is not solved yet. */
static bool do_sweep(System *system, Sweep sweep, bool in_loop)
{
    const Plan *plan = system->plan;
    for (const Operation *operation = sweep.begin; operation < sweep.end; operation++) {
        if (operation->kind == SOLVE) {
            const Loop *loop = operation->loop;
            if (!solve(system, operation->loop))
                return false;
            if (!are_finite(system, loop->torn, loop->n_torn))
                return fail_not_finite(system, loop->torn, loop->n_torn);
            continue;
        }
        if (is_ahead(plan, operation->element))
            continue;
        Element *element = &system->elements[operation->element];
        if (operation->kind == READ) {
            if (!read_element(system, element, &operation->groups))
                return false;
            continue;
        }
        const int32_t *sources = plan->sources + operation->first;
        gather(plan->staged + operation->first, system->values, sources, operation->count);
        if (!in_loop && !are_finite(system, sources, operation->count))
            return fail_not_finite(system, sources, operation->count);
        if (!write_element(system, element, &operation->groups))
            return false;
    }
    return true;
}

/* ---- loops ---- */

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

/* to = result of one sweep from the torn values x. */
static bool sweep_round(System *system, const Loop *loop, const double *x, double *to)
{
    for (int64_t i = 0; i < loop->n_torn; i++)
        system->values[loop->torn[i]] = x[i];
    const bool went = do_sweep(system, loop->sweep, true);
    /* An FMU may discard values outside of its domain: these values are then not a solution, but no error. */
    if (!went && !is_discarded(system))
        return false;
    system->failure = (Failure){0};
    for (int64_t i = 0; i < loop->n_torn; i++)
        to[i] = went ? system->values[loop->torn[i]] : NAN;
    return true;
}

/* Largest change in a sweep, relative to the values' size; infinite if it is not a finite number. */
static double residual(const Loop *loop, const double *x, const double *found)
{
    double largest = 0.0;
    for (int64_t i = 0; i < loop->n_reals; i++) {
        const double size = larger(larger(loop->nominals[i], fabs(x[i])), fabs(found[i]));
        const double part = fabs(found[i] - x[i]) / size;
        if (!(part <= DBL_MAX))
            return INFINITY;
        largest = larger(largest, part);
    }
    return largest;
}

/* *way* = correction from x to the solution of the factorized linearization; *found* is the sweep's result at x. */
static void find_way(const Loop *loop, const double *x, const double *found, double *way)
{
    for (int64_t r = 0; r < loop->n_reals; r++)
        way[r] = found[r] - x[r];
    dse_substitute((uint32_t)loop->n_reals, loop->rows, loop->pivots, way);
}

/* The largest component of a correction from x, relative to the values' size. */
static double length_of(const Loop *loop, const double *x, const double *way)
{
    double longest = 0.0;
    for (int64_t i = 0; i < loop->n_reals; i++) {
        const double part = fabs(way[i]) / larger(loop->nominals[i], fabs(x[i]));
        if (!(part <= DBL_MAX))
            return INFINITY;
        longest = larger(longest, part);
    }
    return longest;
}

/* Factorize the loop's linearization at x; afterwards the elements are at a nearby point. */
static bool linearize(System *system, const Loop *loop, double *x, const double *found, double *moved,
                      bool *is_regular)
{
    const int64_t n = loop->n_reals;
    const Plan *plan = system->plan;
    for (int64_t c = 0; c < n; c++) {
        /* An output that is not shown at this point is not an unknown: its equation keeps it constant. */
        if (is_ahead(plan, plan->owners[loop->torn[c]])) {
            for (int64_t r = 0; r < n; r++)
                loop->rows[r * n + c] = r == c ? 1.0 : 0.0;
            continue;
        }
        const double at = x[c];
        x[c] = at + DIFFERENCE * larger(loop->nominals[c], fabs(at));
        const double difference = x[c] - at;
        const bool went = sweep_round(system, loop, x, moved);
        x[c] = at;
        if (!went)
            return false;
        for (int64_t r = 0; r < n; r++)
            loop->rows[r * n + c] = (r == c ? 1.0 : 0.0) - (moved[r] - found[r]) / difference;
    }
    *is_regular = !dse_eliminate((uint32_t)n, loop->rows, loop->pivots, NULL, NULL);
    return true;
}

/* Solve for the real ones among x, with the others held; *found* is the result of the last sweep from x. A small
 * residual does not suffice: it is small everywhere if the loop hardly depends on its values. The remaining correction
 * must be small as well. */
static bool newton(System *system, const Loop *loop, double *x, double *found, double *trial, double *moved)
{
    const int64_t n = loop->n_reals;
    const size_t size = (size_t)loop->n_torn * sizeof *x;
    double *const way = loop->way, left = INFINITY;
    if (!sweep_round(system, loop, x, found))
        return false;
    double rest = residual(loop, x, found);
    for (int64_t k = 0; k < NEWTON_STEPS; k++) {
        if (rest == 0.0 || (rest <= SOLVED && left <= SHORT))
            return true;
        bool is_regular = false;
        if (!linearize(system, loop, x, found, moved, &is_regular))
            return false;
        left = INFINITY;
        double part = 1.0, now = INFINITY;
        if (is_regular) {
            find_way(loop, x, found, way);
            left = length_of(loop, x, way);
        }
        memcpy(trial, x, size);
        const bool is_there = rest <= SOLVED && left <= SHORT;
        for (int64_t halved = 0; is_regular && !is_there && halved <= HALVINGS && !(now < rest); halved++, part *= 0.5) {
            for (int64_t i = 0; i < n; i++)
                trial[i] = x[i] + part * way[i];
            if (!sweep_round(system, loop, trial, moved))
                return false;
            now = residual(loop, trial, moved);
        }
        if (!(now < rest)) {
            /* Solved, or no improvement in that direction: back to the best point. */
            if (!sweep_round(system, loop, x, found))
                return false;
            break;
        }
        memcpy(x, trial, size);
        memcpy(found, moved, size);
        rest = now;
        find_way(loop, x, found, way);
        left = length_of(loop, x, way);
    }
    if (!(rest <= NEARLY_SOLVED))
        return fail(system, NOT_SOLVED, 0, loop->number, rest);
    return left <= SHORT ? true : fail(system, NEARLY_SINGULAR, 0, loop->number, left);
}

static bool all_known(const double *values, int64_t count)
{
    for (int64_t i = 0; i < count; i++)
        if (values[i] != values[i])
            return false;
    return true;
}

static bool solve(System *system, Loop *loop)
{
    const int64_t n = loop->n_torn;
    const size_t size = (size_t)n * sizeof(double), reals = (size_t)loop->n_reals * sizeof(double);
    double *x = loop->room, *begin = x + n, *found = begin + n, *trial = found + n, *moved = trial + n;
    for (int64_t i = 0; i < n; i++)
        x[i] = begin[i] = system->values[loop->torn[i]];
    /* Many loops are not real: their FMUs do not declare dependencies. These settle exactly. */
    bool is_settled = false;
    for (int64_t k = 0; k < loop->sweeps; k++) {
        if (!sweep_round(system, loop, x, found))
            return false;
        is_settled = memcmp(x, found, size) == 0;
        if (is_settled && !loop->has_texts)
            return true;
        if (!all_known(found, n))
            break;
        memcpy(x, found, size);
    }
    if (is_settled)
        return true; /* and the texts have passed the whole loop */
    memcpy(x, begin, size);
    for (int64_t k = 0; loop->n_reals && k < EXCHANGES; k++) {
        if (!newton(system, loop, x, found, trial, moved))
            return false;
        if (memcmp((char *)x + reals, (char *)found + reals, size - reals) == 0)
            return true;
        memcpy((char *)x + reals, (char *)found + reals, size - reals);
    }
    return fail(system, NOT_SETTLED, 0, loop->number, 0);
}

#endif
