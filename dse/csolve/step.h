/* One accepted step: its width, its solver, and the event at its end. */
#ifndef DSE_CSOLVE_STEP_H
#define DSE_CSOLVE_STEP_H

#include "locate.h"

/* Hysteresis of the choice between the solvers, in steps (Hairer, Wanner II, IV.2 for the first two). */
#define DSE_STIFF_AFTER 15
#define DSE_NOT_STIFF_AFTER 6
#define DSE_EXPLICIT_AFTER 25

/* Width of a first step (Hairer, Norsett, Wanner I, II.4), at most *room*; false after a failure. */
static inline bool dse_first_width(dse_problem *p, double room, double *width) {
    struct dse_solver *s = dse_solver_of(p);
    const int64_t n = DSE_STATE_COUNT(p);
    double state = 0.0, slope = 0.0, bend = 0.0;
    for (int64_t k = 0; k < n; k++) {
        const double allowed = dse_allowed(p, k, s->from[k], s->from[k]);
        state = fmax(state, fabs(s->from[k]) / allowed);
        slope = fmax(slope, fabs(s->slope[k]) / allowed);
    }
    const double guess = fmin(room, state < 1e-5 || slope < 1e-5 ? 1e-6 : 0.01 * state / slope);
    *width = guess;
    if (n == 0 || !(guess > 0.0)) {
        *width = room;
        return true;
    }
    for (int64_t k = 0; k < n; k++) {
        s->trial[k] = s->from[k] + guess * s->slope[k];
    }
    const dse_answer answer = dse_slope_at(p, s->start + guess, s->trial, s->stage[1]);
    if (answer != DSE_DONE) {
        return answer == DSE_REFUSED; /* the error control determines the possible width */
    }
    for (int64_t k = 0; k < n; k++) {
        const double allowed = dse_allowed(p, k, s->from[k], s->from[k]);
        bend = fmax(bend, fabs(s->stage[1][k] - s->slope[k]) / allowed);
    }
    const double fastest = fmax(slope, bend / guess);
    const double second = fastest <= 1e-15 ? fmax(1e-6, 1e-3 * guess) : pow(0.01 / fastest, 1.0 / 5.0);
    *width = fmin(fmin(100.0 * guess, second), room);
    return true;
}

/* Try a step of *width* to *end*; if it is accurate, *end* is the model's present point, and *slope* is its slope. */
static inline dse_answer dse_try(dse_problem *p, double *error) {
    struct dse_solver *s = dse_solver_of(p);
    const int64_t n = DSE_STATE_COUNT(p);
    const bool is_stiff = DSE_HAS_STIFF && s->is_stiff;
    dse_begin_samples(p);
    dse_answer answer = is_stiff ? dse_ro_try(p, error) : dse_dp_try(p, error);
    if (answer != DSE_DONE || *error > 1.0) {
        return answer;
    }
    if (!is_stiff) {
        dse_dp_prepare(p);
        dse_copy(s->slope, s->stage[6], n);
        return DSE_DONE;
    }
    dse_ro_prepare(p);
    answer = dse_slope_at(p, s->end, s->to, s->found);
    if (answer == DSE_DONE) {
        answer = dse_sample(p, 1.0);
    }
    if (answer == DSE_DONE) {
        dse_copy(s->slope, s->found, n);
    }
    return answer;
}

/* Whether the other solver would have been better, judged by the last step. */
static inline void dse_choose(dse_problem *p) {
    struct dse_solver *s = dse_solver_of(p);
    struct dse_past *past = &s->past;
    if (!DSE_MAY_CHOOSE(p) || DSE_STATE_COUNT(p) == 0) {
        return;
    }
    /* Cost of a stiff step in explicit steps: one column of the Jacobian per state, and the stages. One stiff step per
     * communication step is the minimum; half of the cost is the hysteresis. */
    const double cost = ((double)DSE_STATE_COUNT(p) + 10.0) / 6.0;
    const bool is_cheap = s->width * cost >= s->span;
    const bool speaks_for_other = s->is_stiff ? dse_ro_stiffness(p) < 0.5 * DSE_STIFF_FROM * cost
                                              : !is_cheap && dse_dp_stiffness(p) > DSE_STIFF_FROM;
    if (speaks_for_other) {
        past->signs_of_this = 0;
        if (++past->signs_of_other >= (s->is_stiff ? DSE_EXPLICIT_AFTER : DSE_STIFF_AFTER)) {
            past->signs_of_other = 0;
            past->will_be_stiff = !s->is_stiff;
        }
    } else if (++past->signs_of_this >= (s->is_stiff ? 1 : DSE_NOT_STIFF_AFTER)) {
        past->signs_of_this = past->signs_of_other = 0;
    }
}

/* No step is small enough, as there are no values beyond a border: searches an event just ahead after which there are
 * values, as in `if h > 0 then -sqrt(h) else 0` where h reaches 0. The step then ends there, straight along the slope;
 * else the trouble stays the same. */
static inline dse_answer dse_meet_border(dse_problem *p, double least) {
    struct dse_solver *s = dse_solver_of(p);
    const dse_reason trouble = s->trouble;
    const int64_t n = DSE_STATE_COUNT(p);
    for (int64_t pass = 0; DSE_CROSSING_COUNT(p) > 0 && pass < 6; pass++) {
        s->width = least * (double)(1 << 2 * pass);
        s->end = s->start + s->width;
        for (int64_t k = 0; k < n; k++) {
            s->to[k] = s->from[k] + s->width * s->slope[k];
        }
        const dse_answer answer = dse_look_beyond(p, s->end, s->to, s->high);
        if (answer == DSE_FAILED) {
            return answer;
        }
        if (answer == DSE_DONE && dse_first_crossed(p, s->high) >= 0) {
            for (int64_t k = 0; k < n; k++) {
                s->dense[0][k] = s->dense[1][k] = s->dense[2][k] = s->dense[3][k] = 0.0;
                s->dense[s->is_stiff ? 3 : 0][k] = s->to[k] - s->from[k];
            }
            s->has_step = s->has_event = s->is_at_border = 1;
            s->past.steps++;
            return DSE_DONE;
        }
    }
    s->trouble = trouble;
    return DSE_REFUSED;
}

/* The next width after a step with this *error*, where *wanted* was proposed. */
static inline void dse_learn(struct dse_solver *s, double wanted, double error, double damped, bool was_rejected) {
    const double factor = damped / pow(s->past.error_before, 0.04) / 0.9;
    double next = s->width / fmin(5.0, fmax(was_rejected ? 1.0 : 0.1, factor));
    if (s->width < wanted && !was_rejected) {
        next = fmax(next, wanted); /* an early end of the step is not a reason for a small next one */
    }
    s->past.next_width = next;
    s->past.error_before = fmax(error, 1e-4);
}

/* Take one step from *end*, at most to *limit*, and end it at the first event in it. *slope* and *at_end* are those of
 * its beginning, and then those of its end, unless there is an event. */
static inline bool dse_take_step(dse_problem *p, double limit) {
    struct dse_solver *s = dse_solver_of(p);
    const double room = limit - s->end;
    bool was_rejected = false;
    s->is_stiff = s->past.will_be_stiff; /* not earlier: the dense output was of the other solver */
    s->start = s->end;
    dse_copy(s->from, s->to, DSE_STATE_COUNT(p));
    s->has_jacobian = s->has_step = s->has_event = s->is_at_border = 0;
    if (s->past.next_width <= 0.0) {
        if (!dse_first_width(p, room, &s->past.next_width)) {
            return false;
        }
        s->past.error_before = 1e-4;
    }
    double wanted = s->past.next_width;
    for (;;) {
        double error = INFINITY;
        /* Avoids a tiny last step. */
        s->width = wanted >= 0.999 * room ? room : fmin(wanted, 0.5 * room);
        s->end = s->width == room ? limit : s->start + s->width;
        dse_answer answer = dse_try(p, &error);
        if (answer == DSE_FAILED) {
            return false;
        }
        const double damped = pow(error, 0.17);
        if (answer == DSE_DONE && error <= 1.0) {
            dse_settle(p);
            dse_learn(s, wanted, error, damped, was_rejected);
            break;
        }
        s->past.rejected++;
        was_rejected = true;
        wanted = answer == DSE_DONE && error <= DBL_MAX ? s->width / fmin(5.0, damped / 0.9) : 0.2 * s->width;
        const double least = 16.0 * DBL_EPSILON * fmax(fabs(s->start), s->span);
        if (wanted <= least) {
            if (answer == DSE_REFUSED && dse_wants_values(p)) {
                answer = dse_meet_border(p, least);
                if (answer == DSE_DONE) {
                    return true;
                }
            }
            return dse_give_up(p, answer);
        }
    }
    s->is_at_end = 1;
    dse_choose(p);
    s->past.steps++;
    s->has_step = 1;
    const dse_answer answer = dse_locate(p);
    return answer == DSE_DONE || dse_give_up(p, answer);
}

/* Whether an event at *time* is one of *most* consecutive events with almost no time between them. */
static inline bool dse_chatters(struct dse_solver *s, double time, int64_t most) {
    struct dse_past *past = &s->past;
    const bool is_close = past->events_close > 0 && time - past->last_event <= fmin(1e-8, 1e-6 * s->span);
    past->events_close = is_close ? past->events_close + 1 : 1;
    past->last_event = time;
    return past->events_close >= most;
}

#endif
