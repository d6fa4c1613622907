/* Locates the first crossing in the last step: on the dense output, by a safeguarded secant method. */
#ifndef DSE_CSOLVE_LOCATE_H
#define DSE_CSOLVE_LOCATE_H

#include "dormand_prince.h"
#include "rosenbrock.h"

#define DSE_LOOKS_WITHIN 16

/* The states at the part *part* of the last step. */
static inline void dse_dense_states(dse_problem *p, double part, double states[]) {
    if (DSE_HAS_STIFF && dse_solver_of(p)->is_stiff) {
        dse_ro_states(p, part, states);
    } else {
        dse_dp_states(p, part, states);
    }
}

/* Evaluate the crossing functions at the part *at* of the last step. */
static inline dse_answer dse_look_at(dse_problem *p, double at, double look[]) {
    struct dse_solver *s = dse_solver_of(p);
    dse_dense_states(p, at, s->trial);
    return dse_look_within(p, s->start + at * s->width, s->trial, look);
}

/* A part of the last step without a crossing before it, one with a crossing, and the function values at both. */
struct dse_bracket {
    double low, high;
    double *at_low, *at_high, *other;
};

/* Use the values in *other*, which are those at the part *at*, as new end; returns whether there is a crossing. */
static inline bool dse_close_in(dse_problem *p, struct dse_bracket *b, double at) {
    const bool is_high = dse_first_crossed(p, b->other) >= 0;
    double **const end = is_high ? &b->at_high : &b->at_low, *const kept = *end;
    *(is_high ? &b->high : &b->low) = at;
    *end = b->other;
    b->other = kept;
    return is_high;
}

/* The first crossing by the secants of the functions that have crossed at *high*; ends are weighted by their shares. */
static inline double dse_secant(dse_problem *p, const struct dse_bracket *b, double low_share, double high_share) {
    double at = b->high;
    for (int64_t k = 0; k < DSE_CROSSING_COUNT(p); k++) {
        const double left = low_share * b->at_low[k], right = high_share * b->at_high[k];
        if (dse_is_crossed(p, b->at_high, k) && left * right <= 0.0 && left != right) {
            at = fmin(at, b->low + (b->high - b->low) * (left / (left - right)));
        }
    }
    return at;
}

/* *high* becomes the first point after the crossing, within the tolerance. */
static inline dse_answer dse_narrow(dse_problem *p, struct dse_bracket *b) {
    struct dse_solver *s = dse_solver_of(p);
    const double ulps = 4.0 * DBL_EPSILON * fmax(fabs(s->start), fabs(s->end)) / s->width;
    const double nearest = fmin(0.25, fmax(1e-13, ulps));
    double low_share = 1.0, high_share = 1.0; /* Illinois: the end that is kept counts half */
    double before = b->high - b->low;
    for (int64_t pass = 1; b->high - b->low > nearest && pass < 200; pass++) {
        double at = dse_secant(p, b, low_share, high_share);
        if (pass % 4 == 0) {
            /* Bisect if the secant makes no progress. */
            if (b->high - b->low > 0.25 * before) {
                at = 0.5 * (b->low + b->high);
            }
            before = b->high - b->low;
        }
        at = fmin(fmax(at, b->low + 0.5 * nearest), b->high - 0.5 * nearest);
        const dse_answer answer = dse_look_at(p, at, b->other);
        if (answer != DSE_DONE) {
            return answer;
        }
        if (dse_close_in(p, b, at)) {
            high_share = 1.0;
            low_share *= 0.5;
        } else {
            low_share = 1.0;
            high_share *= 0.5;
        }
    }
    return DSE_DONE;
}

/* End the last step at the first crossing in it, if there is one; *high* then has the values there. The last sample is
 * at the end of the step. */
static inline dse_answer dse_locate(dse_problem *p) {
    struct dse_solver *s = dse_solver_of(p);
    const int64_t size = DSE_LOOK_SIZE(p);
    struct dse_bracket b = {0.0, 1.0, s->low, s->high, s->seen};
    s->has_event = 0;
    if (DSE_CROSSING_COUNT(p) == 0) {
        return DSE_DONE;
    }
    dse_copy(s->low, s->at_end, size);
    dse_copy(s->high, s->sample[s->sample_row[s->samples - 1]], size);
    bool is_found = dse_first_crossed(p, s->high) >= 0;
    if (dse_is_suspicious(p)) {
        bool is_within = false;
        for (int64_t k = 1; !is_within && k < DSE_LOOKS_WITHIN; k++) {
            const double at = (double)k / DSE_LOOKS_WITHIN;
            const dse_answer answer = dse_look_at(p, at, b.other);
            if (answer != DSE_DONE) {
                return answer;
            }
            is_within = dse_close_in(p, &b, at);
        }
        is_found |= is_within;
    }
    if (!is_found) {
        dse_copy(s->at_end, s->high, size);
        return DSE_DONE;
    }
    const dse_answer answer = dse_narrow(p, &b);
    if (answer != DSE_DONE) {
        return answer;
    }
    if (b.at_high != s->high) {
        dse_copy(s->high, b.at_high, size);
    }
    s->has_event = 1;
    if (b.high < 1.0) {
        s->end = fmax(s->start + b.high * s->width, nextafter(s->start, INFINITY));
        dse_dense_states(p, b.high, s->to);
    }
    return DSE_DONE;
}

#endif
