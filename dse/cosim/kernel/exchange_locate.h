/* Where in the last step an event indicator crosses zero first: on the dense output, by the secant, safely. */
#ifndef DSE_COSIM_EXCHANGE_LOCATE_H
#define DSE_COSIM_EXCHANGE_LOCATE_H

#include "exchange_stiff.h"

static void dense_states(const Exchange *x, double part, double *states)
{
    if (x->was_stiff)
        stiff_states(x, part, states);
    else
        explicit_states(x, part, states);
}

/* The indicators at the part *at* of the last step. */
static Answer look_within(System *system, const Element *element, double at, double *indicators)
{
    Exchange *x = element->exchange;
    dense_states(x, at, x->trial);
    /* The slope is not needed; some FMUs compute their indicators along with it. */
    const Answer answer = find_slope(system, element, x->start + at * x->width, x->trial, x->found);
    return answer == DONE ? look(system, element, indicators) : answer;
}

static void swap(double **one, double **other)
{
    double *const kept = *one;
    *one = *other;
    *other = kept;
}

/* The first crossing in (low, high] by the secants of those that have crossed at *high*; the end that stays counts by
 * its share. */
static double guess_crossing(const Exchange *x, double low, double high, double low_share, double high_share)
{
    double at = high;
    for (int64_t k = 0; k < x->n_indicators; k++) {
        const double left = low_share * x->low_indicators[k], right = high_share * x->high_indicators[k];
        if (has_crossed(x->indicators[k], x->high_indicators[k]) && left * right <= 0.0 && left != right)
            at = fmin(at, low + (high - low) * (left / (left - right)));
    }
    return at;
}

/* Given low_indicators and high_indicators at both ends: *high* becomes the first point past the crossing, but for
 * next to nothing. */
static Answer narrow_down(System *system, const Element *element, double low, double *high)
{
    Exchange *x = element->exchange;
    const double ulps = 4.0 * DBL_EPSILON * fmax(fabs(x->start), fabs(x->end)) / x->width;
    const double nearest = fmin(0.25, fmax(1e-13, ulps));
    double low_share = 1.0, high_share = 1.0; /* Illinois */
    double before = *high - low;
    for (int64_t pass = 1; *high - low > nearest && pass < 200; pass++) {
        double at = guess_crossing(x, low, *high, low_share, high_share);
        if (pass % 4 == 0) {
            /* Where the secant does not get on, halve. */
            if (*high - low > 0.25 * before)
                at = 0.5 * (low + *high);
            before = *high - low;
        }
        at = fmin(fmax(at, low + 0.5 * nearest), *high - 0.5 * nearest);
        const Answer answer = look_within(system, element, at, x->seen_indicators);
        if (answer != DONE)
            return answer;
        if (first_crossed(x, x->seen_indicators) >= 0) {
            *high = at;
            high_share = 1.0;
            low_share *= 0.5;
            swap(&x->high_indicators, &x->seen_indicators);
        } else {
            low = at;
            low_share = 1.0;
            high_share *= 0.5;
            swap(&x->low_indicators, &x->seen_indicators);
        }
    }
    return DONE;
}

enum { LOOKS = 16 };

/* Look for a crossing that the ends of the step do not show: *low* and *high* close in on it. */
static Answer scan(System *system, const Element *element, double *low, double *high, bool *is_found)
{
    Exchange *x = element->exchange;
    for (int64_t k = 1; k < LOOKS; k++) {
        const double at = (double)k / LOOKS;
        const Answer answer = look_within(system, element, at, x->seen_indicators);
        if (answer != DONE)
            return answer;
        if (first_crossed(x, x->seen_indicators) >= 0) {
            *high = at;
            *is_found = true;
            swap(&x->high_indicators, &x->seen_indicators);
            return DONE;
        }
        *low = at;
        swap(&x->low_indicators, &x->seen_indicators);
    }
    return DONE;
}

/* End the last step at the first crossing in it, if there is one. Its last sample is that of its end. */
static Answer locate(System *system, const Element *element)
{
    Exchange *x = element->exchange;
    double low = 0.0, high = 1.0;
    x->has_event = 0;
    if (x->n_indicators == 0)
        return DONE;
    copy_values(x->low_indicators, x->indicators, x->n_indicators);
    copy_values(x->high_indicators, x->sample[x->samples - 1], x->n_indicators);
    bool is_found = first_crossed(x, x->high_indicators) >= 0;
    Answer answer = is_suspicious(x) ? scan(system, element, &low, &high, &is_found) : DONE;
    if (answer == DONE && is_found)
        answer = narrow_down(system, element, low, &high);
    if (answer != DONE || !is_found)
        return answer;
    x->has_event = 1;
    if (high < 1.0) {
        x->end = fmax(x->start + high * x->width, nextafter(x->start, INFINITY));
        dense_states(x, high, x->to);
    }
    return DONE;
}

#endif
