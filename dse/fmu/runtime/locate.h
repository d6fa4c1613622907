/* Where in the last step a relation changes first: on the dense output, by the secant, safely. */
#ifndef DSE_LOCATE_H
#define DSE_LOCATE_H

#include "dormand_prince.h"
#include "rosenbrock.h"

/* The states at the part *part* of the last step. */
static inline void dse_dense_states(const dse_component *m, double part, double states[]) {
#if DSE_HAS_STIFF
    if (m->solver.is_stiff) {
        dse_ro_states(m, part, states);
        return;
    }
#endif
    dse_dp_states(m, part, states);
}

/* Look for the first change of a relation in (low, high], given the crossing functions at both ends; at *high* one has
 * changed. *high* becomes the first point past the change, to *nearest*. */
static bool dse_narrow(dse_component *m, double low, double *high, double at_low[], double at_high[], uint8_t truth[]) {
    struct dse_solver *s = &m->solver;
    const double ulps = 4.0 * DBL_EPSILON * fmax(fabs(s->start), fabs(s->end)) / s->width;
    const double nearest = fmin(0.25, fmax(1e-13, ulps));
    double low_share = 1.0, high_share = 1.0; /* Illinois: the end that stays counts half */
    double crossing[DSE_ROOM(DSE_RELATIONS)];
    uint8_t now[DSE_ROOM(DSE_RELATIONS)];
    double width_before = *high - low;
    for (uint32_t pass = 1; *high - low > nearest && pass < 200; pass++) {
        double at = *high;
        for (int k = 0; k < DSE_RELATIONS; k++) {
            const double left = low_share * at_low[k], right = high_share * at_high[k];
            if (truth[k] != m->held[k] && left * right <= 0.0 && left != right) {
                at = fmin(at, low + (*high - low) * (left / (left - right)));
            }
        }
        if (pass % 4 == 0) {
            /* Where the secant does not get on, halve. */
            if (*high - low > 0.25 * width_before) {
                at = 0.5 * (low + *high);
            }
            width_before = *high - low;
        }
        at = fmin(fmax(at, low + 0.5 * nearest), *high - 0.5 * nearest);
        dse_dense_states(m, at, s->trial);
        if (!dse_place(m, s->start + at * s->width, s->trial) || !dse_look(m, crossing, now)) {
            return false;
        }
        if (dse_differs(m, now)) {
            *high = at;
            high_share = 1.0;
            low_share *= 0.5;
            memcpy(at_high, crossing, sizeof crossing);
            memcpy(truth, now, sizeof now);
        } else {
            low = at;
            low_share = 1.0;
            high_share *= 0.5;
            memcpy(at_low, crossing, sizeof crossing);
        }
    }
    return true;
}

/* End the step at the first change of a relation in it, if there is one. */
static bool dse_locate(dse_component *m) {
    struct dse_solver *s = &m->solver;
    double at_low[DSE_ROOM(DSE_RELATIONS)], at_high[DSE_ROOM(DSE_RELATIONS)];
    uint8_t truth[DSE_ROOM(DSE_RELATIONS)];
    double low = 0.0, high = 1.0;
    s->has_event = 0;
    if (DSE_RELATIONS == 0) {
        return true;
    }
    memcpy(at_low, s->at_start, sizeof at_low);
    if (!dse_look(m, at_high, truth)) {
        return false;
    }
    memcpy(s->at_start, at_high, sizeof at_high);
    bool is_found = dse_differs(m, truth);
    if (dse_is_suspicious(m)) {
        for (uint32_t k = 1; k < 16; k++) {
            double crossing[DSE_ROOM(DSE_RELATIONS)];
            uint8_t now[DSE_ROOM(DSE_RELATIONS)];
            const double at = k / 16.0;
            dse_dense_states(m, at, s->trial);
            if (!dse_place(m, s->start + at * s->width, s->trial) || !dse_look(m, crossing, now)) {
                return false;
            }
            if (dse_differs(m, now)) {
                is_found = true;
                high = at;
                memcpy(at_high, crossing, sizeof crossing);
                memcpy(truth, now, sizeof now);
                break;
            }
            low = at;
            memcpy(at_low, crossing, sizeof crossing);
        }
    }
    if (!is_found) {
        return true;
    }
    if (!dse_narrow(m, low, &high, at_low, at_high, truth)) {
        return false;
    }
    s->has_event = 1;
    s->has_slope = 0;
    if (high < 1.0) {
        s->end = fmax(s->start + high * s->width, nextafter(s->start, INFINITY));
        dse_dense_states(m, high, s->to);
    }
    return true;
}

#endif
