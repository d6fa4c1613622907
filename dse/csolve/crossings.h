/* Monitoring of the crossing functions during a step. Sampling them in a stage of the solver costs almost nothing. A
 * suspected crossing is then located on the dense output. */
#ifndef DSE_CSOLVE_CROSSINGS_H
#define DSE_CSOLVE_CROSSINGS_H

#include "problem.h"

/* The first crossing function that has crossed, or -1. */
static inline int64_t dse_first_crossed(dse_problem *p, const double look[]) {
    for (int64_t k = 0; k < DSE_CROSSING_COUNT(p); k++) {
        if (dse_is_crossed(p, look, k)) {
            return k;
        }
    }
    return -1;
}

/* The first sample is at the beginning of the step. */
static inline void dse_begin_samples(dse_problem *p) {
    struct dse_solver *s = dse_solver_of(p);
    s->samples = s->has_suspicion = 0;
    if (DSE_CROSSING_COUNT(p) > 0) {
        s->sample_at[0] = 0.0;
        s->sample_row[0] = 0;
        dse_copy(s->sample[0], s->at_end, DSE_LOOK_SIZE(p));
        s->samples = 1;
    }
}

/* Sample the crossing functions at the part *at* of the step, the model's present point. Samples are kept in order. */
static inline dse_answer dse_sample(dse_problem *p, double at) {
    struct dse_solver *s = dse_solver_of(p);
    if (DSE_CROSSING_COUNT(p) == 0 || s->samples == DSE_SAMPLES) {
        return DSE_DONE;
    }
    const int64_t row = s->samples;
    const dse_answer answer = dse_look(p, s->sample[row]);
    if (answer != DSE_DONE) {
        return answer;
    }
    int64_t place = s->samples++;
    for (; place > 0 && s->sample_at[place - 1] > at; place--) {
        s->sample_at[place] = s->sample_at[place - 1];
        s->sample_row[place] = s->sample_row[place - 1];
    }
    s->sample_at[place] = at;
    s->sample_row[place] = row;
    s->has_suspicion |= dse_first_crossed(p, s->sample[row]) >= 0;
    return DSE_DONE;
}

/* Whether the parabola through three values of one sign reaches zero between the outer two. */
static inline bool dse_dips(const double at[3], const double value[3]) {
    if (!(value[0] * value[1] > 0.0 && value[1] * value[2] > 0.0)) {
        return false;
    }
    const double left = at[1] - at[0], right = at[2] - at[1];
    if (!(left > 0.0 && right > 0.0)) {
        return false;
    }
    const double left_slope = (value[1] - value[0]) / left, right_slope = (value[2] - value[1]) / right;
    const double bend = (right_slope - left_slope) / (left + right);
    const double slope = left_slope + bend * left; /* at the middle */
    if (bend * value[1] <= 0.0) {
        return false;
    }
    const double lowest = -slope / (2.0 * bend);
    if (lowest <= -left || lowest >= right) {
        return false;
    }
    /* Twice the depth: a parabola through stages is a hint, not a measurement. */
    return (value[1] - slope * slope / (2.0 * bend)) * value[1] <= 0.0;
}

/* Whether a function may have crossed and returned between the samples. */
static inline bool dse_is_suspicious(dse_problem *p) {
    const struct dse_solver *s = dse_solver_of(p);
    if (s->has_suspicion) {
        return true;
    }
    for (int64_t j = 0; j + 2 < s->samples; j++) {
        const double *const one = s->sample[s->sample_row[j]];
        const double *const two = s->sample[s->sample_row[j + 1]];
        const double *const three = s->sample[s->sample_row[j + 2]];
        for (int64_t k = 0; k < DSE_CROSSING_COUNT(p); k++) {
            const double value[3] = {one[k], two[k], three[k]};
            if (dse_dips(&s->sample_at[j], value)) {
                return true;
            }
        }
    }
    return false;
}

#endif
