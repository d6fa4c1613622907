/* One accepted step: its width and the solver that makes it. */
#ifndef DSE_INTEGRATE_H
#define DSE_INTEGRATE_H

#include "locate.h"

/* Hysteresis of the choice between the solvers, in steps (Hairer, Wanner II, IV.2 for the first two). */
#define DSE_STIFF_AFTER 15
#define DSE_NOT_STIFF_AFTER 6
#define DSE_EXPLICIT_AFTER 25
/* What a stiff step costs, in explicit ones: a column of the Jacobian each a state, and the stages. */
#define DSE_STIFF_COST ((DSE_STATES + 10.0) / 6.0)

/* Begin anew from what stands in v, whose derivatives are up to date. */
static bool dse_restart(dse_component *m) {
    struct dse_solver *s = &m->solver;
    uint8_t truth[DSE_ROOM(DSE_RELATIONS)];
    s->end = m->time;
    s->has_step = s->has_event = 0;
    dse_get_states(m, s->to);
    s->has_slope = dse_look(m, s->at_start, truth) && dse_get_slope(m, s->slope);
    return s->has_slope;
}

/* Width of a first step (Hairer, Norsett, Wanner I, II.4), at most *room*. */
static bool dse_first_width(dse_component *m, double room, double *width) {
    struct dse_solver *s = &m->solver;
    double state = 0.0, slope = 0.0, bend = 0.0;
    for (int k = 0; k < DSE_STATES; k++) {
        const double allowed = dse_allowed(m, k, s->from[k], s->from[k]);
        state = fmax(state, fabs(s->from[k]) / allowed);
        slope = fmax(slope, fabs(s->slope[k]) / allowed);
    }
    const double guess = fmin(room, state < 1e-5 || slope < 1e-5 ? 1e-6 : 0.01 * state / slope);
    *width = guess;
    if (DSE_STATES == 0 || !(guess > 0.0)) {
        *width = room;
        return true;
    }
    for (int k = 0; k < DSE_STATES; k++) {
        s->trial[k] = s->from[k] + guess * s->slope[k];
    }
    if (!dse_slope(m, s->start + guess, s->trial, s->stage[1])) {
        dse_forgive(m); /* the error control will find out how far it can go */
        return true;
    }
    for (int k = 0; k < DSE_STATES; k++) {
        const double allowed = dse_allowed(m, k, s->from[k], s->from[k]);
        bend = fmax(bend, fabs(s->stage[1][k] - s->slope[k]) / allowed);
    }
    const double fastest = fmax(slope, bend / guess);
    const double second = fastest <= 1e-15 ? fmax(1e-6, 1e-3 * guess) : pow(0.01 / fastest, 1.0 / 5.0);
    *width = fmin(fmin(100.0 * guess, second), room);
    return true;
}

static inline void dse_try(dse_component *m, double *error) {
#if DSE_HAS_STIFF
    if (m->solver.is_stiff) {
        dse_ro_try(m, error);
        return;
    }
#endif
    dse_dp_try(m, error);
}

/* After an accepted step: v and slope at its end, dense output. */
static bool dse_finish(dse_component *m) {
    struct dse_solver *s = &m->solver;
#if DSE_HAS_STIFF
    if (s->is_stiff) {
        dse_ro_prepare(m);
        return dse_slope(m, s->end, s->to, s->slope) && dse_sample(m, 1.0);
    }
#endif
    dse_dp_prepare(m);
    memcpy(s->slope, s->stage[6], sizeof s->slope);
    return true;
}

/* Whether the other solver would have been better, by what this step showed. Only the automatic choice asks. */
static void dse_choose(dse_component *m) {
#if DSE_SOLVER == DSE_AUTO_SOLVER
    struct dse_solver *s = &m->solver;
    /* A stiff step each communication step is the least there can be; half of the cost is the hysteresis. */
    const bool is_cheap = s->width * DSE_STIFF_COST >= s->span;
    const bool speaks_for_other =
        DSE_STATES > 0
        && (s->is_stiff ? dse_ro_stiffness(m) < 0.5 * DSE_DP_STABLE * DSE_STIFF_COST
                        : !is_cheap && dse_dp_stiffness(m) > DSE_DP_STABLE);
    const uint32_t enough = s->is_stiff ? DSE_EXPLICIT_AFTER : DSE_STIFF_AFTER;
    if (speaks_for_other) {
        s->signs_of_this = 0;
        if (++s->signs_of_other >= enough) {
            s->signs_of_other = 0;
            s->will_be_stiff = !s->is_stiff;
        }
    } else if (++s->signs_of_this >= (s->is_stiff ? 1 : DSE_NOT_STIFF_AFTER)) {
        s->signs_of_this = s->signs_of_other = 0;
    }
#else
    (void)m;
#endif
}

/* No step is small enough, for want of values beyond: whether there is an event just ahead after which there are some,
 * as in `if h > 0 then -sqrt(h) else 0` where h reaches 0. The step then ends there, straight on along the slope. */
static bool dse_meet_border(dse_component *m, double least) {
    struct dse_solver *s = &m->solver;
    const struct dse_trouble trouble = s->trouble;
    double crossing[DSE_ROOM(DSE_RELATIONS)];
    uint8_t truth[DSE_ROOM(DSE_RELATIONS)];
    for (int pass = 0; DSE_RELATIONS > 0 && (trouble.code > 0 || trouble.code == DSE_NOT_FINITE) && pass < 6; pass++) {
        s->width = least * (1 << 2 * pass);
        s->end = s->start + s->width;
        for (int k = 0; k < DSE_STATES; k++) {
            s->to[k] = s->from[k] + s->width * s->slope[k];
        }
        dse_forgive(m);
        (void)dse_place(m, s->end, s->to);
        if (dse_look(m, crossing, truth) && dse_differs(m, truth)) {
            memset(s->dense, 0, sizeof s->dense);
            for (int k = 0; k < DSE_STATES; k++) {
                s->dense[s->is_stiff ? 3 : 0][k] = s->to[k] - s->from[k];
            }
            dse_forgive(m);
            s->has_step = s->has_event = s->is_at_border = 1;
            s->has_slope = 0;
            s->steps++;
            return true;
        }
    }
    s->trouble = trouble;
    return false;
}

/* Take one step from s->end, at most to *limit*. */
static bool dse_take_step(dse_component *m, double limit) {
    struct dse_solver *s = &m->solver;
    const double room = limit - s->end;
    bool was_rejected = false;
    s->is_stiff = s->will_be_stiff; /* not earlier: the dense output was the other solver's */
    s->start = s->end;
    memcpy(s->from, s->to, sizeof s->from);
    s->has_jacobian = s->has_step = 0;
    if (s->next_width <= 0.0) {
        if (!dse_first_width(m, room, &s->next_width)) {
            return false;
        }
        s->error_before = 1e-4;
    }
    double wanted = s->next_width;
    for (;;) {
        double error;
        /* A rest is not left for a tiny last step. */
        s->width = wanted >= 0.999 * room ? room : fmin(wanted, 0.5 * room);
        s->end = s->width == room ? limit : s->start + s->width;
        dse_forgive(m);
        dse_forget_samples(m);
        if (DSE_RELATIONS > 0) {
            s->sample_at[0] = 0.0;
            memcpy(s->sample[0], s->at_start, sizeof s->at_start);
            s->samples = 1;
        }
        dse_try(m, &error);
        const double damped = pow(error, 0.17);
        if (error <= 1.0 && dse_finish(m)) {
            const double factor = damped / pow(s->error_before, 0.04) / 0.9;
            double next = s->width / fmin(5.0, fmax(was_rejected ? 1.0 : 0.1, factor));
            if (s->width < wanted && !was_rejected) {
                next = fmax(next, wanted); /* what ended the step early is no reason for a small one */
            }
            s->next_width = next;
            s->error_before = fmax(error, 1e-4);
            break;
        }
        s->rejected++;
        was_rejected = true;
        wanted = error <= DBL_MAX && error > 1.0 ? s->width / fmin(5.0, damped / 0.9) : 0.2 * s->width;
        const double least = 16.0 * DBL_EPSILON * fmax(fabs(s->start), s->span);
        if (wanted <= least) {
            m->time = s->start;
            return dse_meet_border(m, least) || dse_trouble(m, DSE_TOO_INACCURATE, 0);
        }
    }
    s->is_at_end = 1;
    dse_choose(m);
    s->steps++;
    s->has_step = 1;
    if (!dse_locate(m)) {
        return false;
    }
    s->has_slope = !s->has_event;
    return true;
}

#endif
