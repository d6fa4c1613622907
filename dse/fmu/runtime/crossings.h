/* Watching the relations during a step. A stage of the solver is a look at the crossing functions that costs next to
 * nothing; what looks like a crossing is then sought on the dense output. */
#ifndef DSE_CROSSINGS_H
#define DSE_CROSSINGS_H

#include "evaluate.h"

/* The crossing functions and the truth of the relations, from what stands in v. */
static inline bool dse_look(dse_component *m, double crossing[], uint8_t truth[]) {
    const int code = model_relations(m, crossing, truth);
    return code == 0 || dse_trouble(m, code, 0);
}

static inline bool dse_differs(const dse_component *m, const uint8_t truth[]) {
    for (int k = 0; k < DSE_RELATIONS; k++) {
        if (truth[k] != m->held[k]) {
            return true;
        }
    }
    return false;
}

/* As large as the crossing function, positive as long as the relation is what the equations hold it for, and never
 * zero: it changes its sign when, and only when, there is an event. */
static inline double dse_indicator(
    const dse_component *m, uint32_t relation, const double crossing[], const uint8_t truth[]) {
    const double size = fmax(fabs(crossing[relation]), DBL_MIN);
    return truth[relation] == m->held[relation] ? size : -size;
}

static inline void dse_forget_samples(dse_component *m) {
    m->solver.samples = 0;
    m->solver.has_suspicion = 0;
}

/* Look at the crossing functions at the part *at* of the step, from what stands in v. Samples are kept in order. */
static inline bool dse_sample(dse_component *m, double at) {
    struct dse_solver *s = &m->solver;
    uint8_t truth[DSE_ROOM(DSE_RELATIONS)];
    if (DSE_RELATIONS == 0 || s->samples == DSE_SAMPLES) {
        return true;
    }
    uint32_t place = s->samples++;
    for (; place > 0 && s->sample_at[place - 1] > at; place--) {
        s->sample_at[place] = s->sample_at[place - 1];
        memcpy(s->sample[place], s->sample[place - 1], sizeof s->sample[place]);
    }
    s->sample_at[place] = at;
    if (!dse_look(m, s->sample[place], truth)) {
        return false;
    }
    s->has_suspicion |= dse_differs(m, truth);
    return true;
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

/* Whether a relation may have changed and changed back between the samples. */
static inline bool dse_is_suspicious(const dse_component *m) {
    const struct dse_solver *s = &m->solver;
    if (s->has_suspicion) {
        return true;
    }
    for (uint32_t j = 0; j + 2 < s->samples; j++) {
        for (int k = 0; k < DSE_RELATIONS; k++) {
            const double value[3] = {s->sample[j][k], s->sample[j + 1][k], s->sample[j + 2][k]};
            if (dse_dips(&s->sample_at[j], value)) {
                return true;
            }
        }
    }
    return false;
}

#endif
