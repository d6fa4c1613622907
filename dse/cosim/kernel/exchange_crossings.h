/* Watching the event indicators during a step. A stage of the solver is a look at them that costs next to nothing;
 * what looks like an event is then sought on the dense output. There is an event where an indicator comes from above
 * zero to zero or below, or the other way (FMI 2.0.4, 3.1). */
#ifndef DSE_COSIM_EXCHANGE_CROSSINGS_H
#define DSE_COSIM_EXCHANGE_CROSSINGS_H

#include "exchange_calls.h"

static inline bool has_crossed(double before, double now)
{
    return (before > 0.0) != (now > 0.0);
}

/* The first indicator that differs from those at the beginning of the step, or -1. */
static int64_t first_crossed(const Exchange *x, const double *indicators)
{
    for (int64_t k = 0; k < x->n_indicators; k++)
        if (has_crossed(x->indicators[k], indicators[k]))
            return k;
    return -1;
}

static void begin_samples(Exchange *x)
{
    x->samples = x->has_suspicion = 0;
    if (x->n_indicators == 0)
        return;
    x->sample_at[0] = 0.0;
    copy_values(x->sample[0], x->indicators, x->n_indicators);
    x->samples = 1;
}

/* Look at the indicators at the part *at* of the step, where the FMU stands. Samples are kept in order. */
static Answer sample(System *system, const Element *element, double at)
{
    Exchange *x = element->exchange;
    if (x->n_indicators == 0 || x->samples == SAMPLES)
        return DONE;
    double *const room = x->sample[x->samples];
    const Answer answer = look(system, element, room);
    if (answer != DONE)
        return answer;
    int64_t place = x->samples++;
    for (; place > 0 && x->sample_at[place - 1] > at; place--) {
        x->sample_at[place] = x->sample_at[place - 1];
        x->sample[place] = x->sample[place - 1];
    }
    x->sample_at[place] = at;
    x->sample[place] = room;
    x->has_suspicion |= first_crossed(x, room) >= 0;
    return DONE;
}

/* Whether the parabola through three values of one sign reaches zero between the outer two. */
static bool dips(const double at[3], const double value[3])
{
    const double left = at[1] - at[0], right = at[2] - at[1];
    if (!(value[0] * value[1] > 0.0 && value[1] * value[2] > 0.0 && left > 0.0 && right > 0.0))
        return false;
    const double left_slope = (value[1] - value[0]) / left, right_slope = (value[2] - value[1]) / right;
    const double bend = (right_slope - left_slope) / (left + right);
    const double slope = left_slope + bend * left; /* at the middle */
    if (bend * value[1] <= 0.0)
        return false;
    const double lowest = -slope / (2.0 * bend);
    if (lowest <= -left || lowest >= right)
        return false;
    /* Twice the depth: a parabola through stages is a hint, not a measurement. */
    return (value[1] - slope * slope / (2.0 * bend)) * value[1] <= 0.0;
}

/* Whether an indicator may have crossed zero and come back between the samples. */
static bool is_suspicious(const Exchange *x)
{
    if (x->has_suspicion)
        return true;
    for (int64_t j = 0; j + 2 < x->samples; j++)
        for (int64_t k = 0; k < x->n_indicators; k++) {
            const double value[3] = {x->sample[j][k], x->sample[j + 1][k], x->sample[j + 2][k]};
            if (dips(&x->sample_at[j], value))
                return true;
        }
    return false;
}

#endif
