/* Error control by step doubling: every interval is made in one step and again in two halves, which are kept if both
 * agree (Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, II.4; for co-simulation Schierz, Arnold
 * and Clauß, 2012). Intervals are the run's step in 2^level equal parts: k*step + i*step/2^level, no sums. */
#ifndef DSE_COSIM_ADAPTIVE_H
#define DSE_COSIM_ADAPTIVE_H

#include "step_loop.h"

#define EASY 0.1 /* an error this small still fits after doubling the interval, even at third order */

enum { FINEST = 52, MOST_TRIED = 1 << 20 /* between two communication points */ };

static bool save_all(System *system)
{
    const Plan *plan = system->plan;
    for (int64_t e = 0; e < system->n_elements; e++)
        if (!save_element(system, e))
            return false;
    memcpy(plan->kept, system->values, (size_t)system->n_values * sizeof(double));
    memcpy(plan->kept + system->n_values, plan->past, (size_t)plan->n_past * sizeof(double));
    return true;
}

static bool restore_all(System *system)
{
    const Plan *plan = system->plan;
    for (int64_t e = 0; e < system->n_elements; e++) {
        if (!restore_element(system, e))
            return false;
        if (plan->reads_again && !read_element(system, &system->elements[e], &system->elements[e].outputs))
            return false;
    }
    memcpy(system->values, plan->kept, (size_t)system->n_values * sizeof(double));
    memcpy(plan->past, plan->kept + system->n_values, (size_t)plan->n_past * sizeof(double));
    return true;
}

/* Errors of an output are relative to the largest value it has had. */
static void note_magnitudes(const System *system)
{
    const Plan *plan = system->plan;
    for (int64_t i = 0; i < plan->n_compared; i++) {
        const double size = fabs(system->values[plan->compared[i]]);
        if (size > plan->magnitudes[i])
            plan->magnitudes[i] = size;
    }
}

/* Largest difference between the coarse values and the present ones, 1 being the tolerance; and its variable. */
static double difference(const System *system, int64_t *worst)
{
    const Plan *plan = system->plan;
    double largest = 0.0;
    *worst = 0;
    for (int64_t i = 0; i < plan->n_compared; i++) {
        const int32_t position = plan->compared[i];
        const double part = fabs(system->values[position] - plan->coarse[i]) /
                            (plan->absolute + plan->tolerance * plan->magnitudes[i]);
        if (!(part <= largest)) {
            largest = part <= DBL_MAX ? part : INFINITY;
            *worst = position;
        }
    }
    return largest;
}

/* From *begin* to *end* in one step, whose values are left in *coarse*, and again in two halves. */
static bool step_twice(System *system, double begin, double length, double middle, double end)
{
    const Plan *plan = system->plan;
    const double half = 0.5 * length;
    if (!advance(system, begin, length, end))
        return false;
    for (int64_t c = 0; c < plan->n_compared; c++)
        plan->coarse[c] = system->values[plan->compared[c]];
    return restore_all(system) && advance(system, begin, half, middle) && meet(system, middle, half) &&
           advance(system, middle, half, end);
}

/* From k*step to the next communication point. *level* is kept between calls, *last* is the length of the last step. */
static bool advance_adaptively(System *system, double time, double step, int64_t *level, double *last)
{
    const Plan *plan = system->plan;
    int64_t i = 0, tried = 0;
    while (i < (int64_t)1 << *level) {
        const double length = ldexp(step, -(int)*level), half = 0.5 * length;
        const double end = time + (double)(i + 1) * length;
        if (!save_all(system))
            return false;
        int64_t worst = 0;
        double error = INFINITY;
        const bool went = step_twice(system, time + (double)i * length, length, time + (double)(2 * i + 1) * half, end);
        if (went)
            error = difference(system, &worst);
        else if (!is_discarded(system))
            return false;
        if (++tried > MOST_TRIED)
            return fail(system, ENDLESS_STEPS, 0, worst, MOST_TRIED);
        if (!(error <= 1.0)) {
            if (half < plan->smallest || *level >= FINEST)
                return went ? fail(system, STEP_TOO_SHORT, 0, worst, half) : false;
            system->failure = (Failure){0};
            if (!restore_all(system))
                return false;
            ++*level;
            i *= 2;
            continue;
        }
        *last = half;
        note_magnitudes(system);
        if (++i < (int64_t)1 << *level && !meet(system, end, half))
            return false;
        if (*level && i % 2 == 0 && error <= EASY) {
            --*level;
            i /= 2;
        }
    }
    return true;
}

#endif
