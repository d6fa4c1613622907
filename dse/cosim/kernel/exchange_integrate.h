/* One accepted step of the solver: its width, and which solver makes it. */
#ifndef DSE_COSIM_EXCHANGE_INTEGRATE_H
#define DSE_COSIM_EXCHANGE_INTEGRATE_H

#include "exchange_locate.h"

/* Hysteresis of the choice between the solvers, in steps (Hairer, Wanner II, IV.2 for the first two). */
enum { STIFF_AFTER = 15, NOT_STIFF_AFTER = 6, EXPLICIT_AFTER = 25 };

/* |h lambda| that stability alone holds the explicit solver to. Its region ends at 3.3, but the error control settles
 * before, at 2.7; where accuracy decides, the product is 1 or less. */
#define STIFF_FROM 2.0

/* Width of a first step (Hairer, Norsett, Wanner I, II.4), at most *room*. */
static bool first_width(System *system, const Element *element, double room, double *width)
{
    Exchange *x = element->exchange;
    double state = 0.0, slope = 0.0, bend = 0.0;
    for (int64_t k = 0; k < x->n_states; k++) {
        const double scale = allowed(x, k, x->from[k], x->from[k]);
        state = fmax(state, fabs(x->from[k]) / scale);
        slope = fmax(slope, fabs(x->slope[k]) / scale);
    }
    const double guess = fmin(room, state < 1e-5 || slope < 1e-5 ? 1e-6 : 0.01 * state / slope);
    *width = guess;
    if (x->n_states == 0 || !(guess > 0.0)) {
        *width = room;
        return true;
    }
    for (int64_t k = 0; k < x->n_states; k++)
        x->trial[k] = x->from[k] + guess * x->slope[k];
    const Answer answer = find_slope(system, element, x->start + guess, x->trial, x->stage[1]);
    if (answer != DONE)
        return answer == REFUSED; /* the error control will find out how far it can go */
    for (int64_t k = 0; k < x->n_states; k++)
        bend = fmax(bend, fabs(x->stage[1][k] - x->slope[k]) / allowed(x, k, x->from[k], x->from[k]));
    const double fastest = fmax(slope, bend / guess);
    const double second = fastest <= 1e-15 ? fmax(1e-6, 1e-3 * guess) : pow(0.01 / fastest, 1.0 / 5.0);
    *width = fmin(fmin(100.0 * guess, second), room);
    return true;
}

/* Try a step of *width*, which ends at *end*, and make it ready for looks within it if it is accurate. */
static Answer try_step(System *system, const Element *element, double *error)
{
    Exchange *x = element->exchange;
    begin_samples(x);
    if (!x->was_stiff) {
        const Answer answer = try_explicit(system, element, error);
        if (answer == DONE && *error <= 1.0) {
            prepare_explicit(x);
            copy_values(x->slope, x->stage[6], x->n_states);
        }
        return answer;
    }
    Answer answer = try_stiff(system, element, error);
    if (answer != DONE || *error > 1.0)
        return answer;
    prepare_stiff(x);
    answer = find_slope(system, element, x->end, x->to, x->found);
    if (answer == DONE)
        answer = sample(system, element, 1.0);
    if (answer == DONE)
        copy_values(x->slope, x->found, x->n_states);
    return answer;
}

/* Whether the other solver would have been better, by what the last step showed. */
static void choose_solver(Exchange *x)
{
    Standing *now = &x->now;
    if (x->n_states == 0 || !x->can_be_stiff)
        return;
    /* What a stiff step costs, in explicit ones: a column of the Jacobian each a state, and the stages. A stiff step
     * each communication step is the least there can be; half of the cost is the hysteresis. */
    const double cost = ((double)x->n_states + 10.0) / 6.0;
    const bool is_cheap = x->width * cost >= x->span;
    const bool speaks_for_other = x->was_stiff ? stiff_stiffness(x) < 0.5 * STIFF_FROM * cost
                                               : !is_cheap && explicit_stiffness(x) > STIFF_FROM;
    if (speaks_for_other) {
        now->signs_of_this = 0;
        if (++now->signs_of_other >= (x->was_stiff ? EXPLICIT_AFTER : STIFF_AFTER)) {
            now->signs_of_other = 0;
            now->is_stiff = !x->was_stiff;
        }
    } else if (++now->signs_of_this >= (x->was_stiff ? 1 : NOT_STIFF_AFTER)) {
        now->signs_of_this = now->signs_of_other = 0;
    }
}

/* No step is small enough, for want of values beyond: whether there is an event just ahead after which there are some,
 * as in "if h > 0 then -sqrt(h) else 0" where h reaches 0. The step then ends there, straight on along the slope. */
static bool meet_border(System *system, const Element *element, double least, bool *is_met)
{
    Exchange *x = element->exchange;
    const Refusal refusal = x->refusal;
    *is_met = false;
    for (int64_t pass = 0; x->n_indicators > 0 && pass < 6; pass++) {
        x->width = least * (double)(1 << 2 * pass);
        x->end = x->start + x->width;
        for (int64_t k = 0; k < x->n_states; k++)
            x->to[k] = x->from[k] + x->width * x->slope[k];
        Answer answer = put_point(system, element, x->end, x->to);
        if (answer == DONE)
            answer = look(system, element, x->high_indicators);
        if (answer == FAILED)
            return false;
        if (answer == DONE && first_crossed(x, x->high_indicators) >= 0) {
            x->has_event = x->is_at_border = *is_met = true;
            copy_values(x->states, x->to, x->n_states);
            x->now.steps++;
            return true;
        }
    }
    x->refusal = refusal;
    return true;
}

/* Neither accurate nor possible however small the step: there is an event, or a failure. */
static bool give_up(System *system, const Element *element, bool was_refused, double least)
{
    Exchange *x = element->exchange;
    bool is_met = false;
    if (was_refused && (!meet_border(system, element, least, &is_met) || is_met))
        return is_met;
    return was_refused ? fail_refused(system, element, x) : fail_at(system, x, TOO_INACCURATE, 0);
}

/* The width to go on with after a step with this *error*. */
static void learn(Exchange *x, double wanted, double error, double damped, bool was_rejected)
{
    const double factor = damped / pow(x->now.error_before, 0.04) / 0.9;
    double next = x->width / fmin(5.0, fmax(was_rejected ? 1.0 : 0.1, factor));
    if (x->width < wanted && !was_rejected)
        next = fmax(next, wanted); /* what ended the step early is no reason for a small one */
    x->now.next_width = next;
    x->now.error_before = fmax(error, 1e-4);
}

/* Take one step from now.time, at most to *limit*, and end it at the first event in it. *states* are then those of its
 * end; so are slope and indicators if there is no event. */
static bool take_step(System *system, const Element *element, double limit)
{
    Exchange *x = element->exchange;
    const double room = limit - x->now.time;
    bool was_rejected = false;
    x->start = x->now.time;
    x->was_stiff = x->now.is_stiff;
    x->has_jacobian = x->has_event = x->is_at_border = 0;
    if (x->n_states == 0 && x->n_indicators == 0) {
        x->end = limit;
        x->now.steps++;
        return must(system, element, put_point(system, element, limit, x->states)) && (x->is_at_end = 1);
    }
    copy_values(x->from, x->states, x->n_states);
    if (x->now.next_width <= 0.0) {
        if (!first_width(system, element, room, &x->now.next_width))
            return false;
        x->now.error_before = 1e-4;
    }
    double wanted = x->now.next_width;
    for (;;) {
        double error = INFINITY;
        /* A rest is not left for a tiny last step. */
        x->width = wanted >= 0.999 * room ? room : fmin(wanted, 0.5 * room);
        x->end = x->width == room ? limit : x->start + x->width;
        const Answer answer = try_step(system, element, &error);
        if (answer == FAILED)
            return false;
        const double damped = pow(error, 0.17);
        if (answer == DONE && error <= 1.0) {
            learn(x, wanted, error, damped, was_rejected);
            break;
        }
        x->now.rejected++;
        was_rejected = true;
        wanted = answer == DONE && isfinite(error) ? x->width / fmin(5.0, damped / 0.9) : 0.2 * x->width;
        const double least = 16.0 * DBL_EPSILON * fmax(fabs(x->start), x->span);
        if (wanted <= least)
            return give_up(system, element, answer == REFUSED, least);
    }
    x->is_at_end = 1;
    choose_solver(x);
    x->now.steps++;
    if (!must(system, element, locate(system, element)))
        return false;
    if (!x->has_event)
        copy_values(x->indicators, x->high_indicators, x->n_indicators);
    copy_values(x->states, x->to, x->n_states);
    return true;
}

#endif
