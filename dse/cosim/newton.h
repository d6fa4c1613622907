/* Loops of outputs that depend on each other: first by walking round, then by Newton's method. */
#ifndef DSE_COSIM_NEWTON_H
#define DSE_COSIM_NEWTON_H

#include "plan.h"

#define SOLVED 1e-12      /* residual relative to the size of each value */
#define NEARLY_SOLVED 1e-9 /* good enough if it cannot be made any smaller */
#define DIFFERENCE 0x1p-26 /* the square root of a double's precision: the best step of a one-sided difference */

enum { NEWTON_STEPS = 50, HALVINGS = 10, EXCHANGES = 20 };

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

/* to = what one walk makes of the torn values x. */
static bool walk_round(System *system, const Loop *loop, const double *x, double *to)
{
    for (int64_t i = 0; i < loop->n_torn; i++)
        system->values[loop->torn[i]] = x[i];
    if (!do_walk(system, loop->walk))
        return false;
    for (int64_t i = 0; i < loop->n_torn; i++)
        to[i] = system->values[loop->torn[i]];
    return true;
}

/* Largest change of a walk, relative to the values' size; infinite if there is none to speak of. */
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

/* Gauss with pivots by column, in place; rows of n + 1, the last one the right side and then the solution. */
static bool eliminate(double *rows, int64_t n)
{
    const int64_t width = n + 1;
    for (int64_t c = 0; c < n; c++) {
        int64_t pivot = c;
        for (int64_t r = c + 1; r < n; r++)
            if (fabs(rows[r * width + c]) > fabs(rows[pivot * width + c]))
                pivot = r;
        if (!(fabs(rows[pivot * width + c]) > 0.0) || !(fabs(rows[pivot * width + c]) <= DBL_MAX))
            return false;
        if (pivot != c)
            for (int64_t i = c; i < width; i++) {
                const double other = rows[c * width + i];
                rows[c * width + i] = rows[pivot * width + i];
                rows[pivot * width + i] = other;
            }
        for (int64_t r = c + 1; r < n; r++) {
            const double times = rows[r * width + c] / rows[c * width + c];
            for (int64_t i = c + 1; i < width; i++)
                rows[r * width + i] -= times * rows[c * width + i];
        }
    }
    for (int64_t r = n - 1; r >= 0; r--) {
        double rest = rows[r * width + n];
        for (int64_t i = r + 1; i < n; i++)
            rest -= rows[r * width + i] * rows[i * width + n];
        rows[r * width + n] = rest / rows[r * width + r];
    }
    return true;
}

/* The way to the solution of the loop's linearization at x, in the last column of *rows*. */
static bool linearize(System *system, const Loop *loop, double *x, const double *found, double *moved, double *rows,
                      bool *is_regular)
{
    const int64_t n = loop->n_reals, width = n + 1;
    for (int64_t c = 0; c < n; c++) {
        const double at = x[c];
        x[c] = at + DIFFERENCE * larger(loop->nominals[c], fabs(at));
        const double difference = x[c] - at;
        const bool went = walk_round(system, loop, x, moved);
        x[c] = at;
        if (!went)
            return false;
        for (int64_t r = 0; r < n; r++)
            rows[r * width + c] = (r == c ? 1.0 : 0.0) - (moved[r] - found[r]) / difference;
    }
    for (int64_t r = 0; r < n; r++)
        rows[r * width + n] = found[r] - x[r];
    *is_regular = eliminate(rows, n);
    return true;
}

/* Solve for the real ones among x, the others held; *found* is what the last walk made of x. */
static bool newton(System *system, const Loop *loop, double *x, double *found, double *trial, double *moved,
                   double *rows)
{
    const int64_t n = loop->n_reals, width = n + 1;
    if (!walk_round(system, loop, x, found))
        return false;
    double rest = residual(loop, x, found);
    for (int64_t k = 0; k < NEWTON_STEPS && !(rest <= SOLVED); k++) {
        bool is_regular = false;
        if (!linearize(system, loop, x, found, moved, rows, &is_regular))
            return false;
        double part = 1.0, now = INFINITY;
        memcpy(trial, x, (size_t)loop->n_torn * sizeof *trial);
        for (int64_t halved = 0; is_regular && halved <= HALVINGS && !(now < rest); halved++, part *= 0.5) {
            for (int64_t i = 0; i < n; i++)
                trial[i] = x[i] + part * rows[i * width + n];
            if (!walk_round(system, loop, trial, moved))
                return false;
            now = residual(loop, trial, moved);
        }
        if (!(now < rest)) {
            /* Nothing better in that direction: back to where it was best. */
            if (!walk_round(system, loop, x, found))
                return false;
            break;
        }
        memcpy(x, trial, (size_t)loop->n_torn * sizeof *x);
        memcpy(found, moved, (size_t)loop->n_torn * sizeof *found);
        rest = now;
    }
    return rest <= NEARLY_SOLVED ? true : fail(system, NOT_SOLVED, 0, loop->number, rest);
}

static bool solve(System *system, Loop *loop)
{
    const int64_t n = loop->n_torn;
    const size_t size = (size_t)n * sizeof(double), reals = (size_t)loop->n_reals * sizeof(double);
    double *x = loop->room, *begin = x + n, *found = begin + n, *trial = found + n, *moved = trial + n;
    double *rows = moved + n;
    for (int64_t i = 0; i < n; i++)
        x[i] = begin[i] = system->values[loop->torn[i]];
    /* Many loops are none: their FMUs do not tell what depends on what. These settle, and exactly. */
    bool is_settled = false;
    for (int64_t k = 0; k < loop->walks; k++) {
        if (!walk_round(system, loop, x, found))
            return false;
        is_settled = memcmp(x, found, size) == 0;
        if (is_settled && !loop->has_texts)
            return true;
        memcpy(x, found, size);
    }
    if (is_settled)
        return true; /* and the texts have gone all the way round */
    memcpy(x, begin, size);
    for (int64_t k = 0; loop->n_reals && k < EXCHANGES; k++) {
        if (!newton(system, loop, x, found, trial, moved, rows))
            return false;
        if (memcmp((char *)x + reals, (char *)found + reals, size - reals) == 0)
            return true;
        memcpy((char *)x + reals, (char *)found + reals, size - reals);
    }
    return fail(system, NOT_SETTLED, 0, loop->number, 0);
}

#endif
