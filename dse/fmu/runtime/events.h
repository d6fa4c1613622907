/* Operations at an instant: clocks, the event iteration (Modelica 3.6, 8.6), reinit, the initialization. */
#ifndef DSE_EVENTS_H
#define DSE_EVENTS_H

#include "integrate.h"

#define DSE_HAS_EVENTS                                                                                                 \
    (DSE_RELATIONS + DSE_CONDITIONS + DSE_TRIGGERS + DSE_CLOCKS + DSE_PRE + DSE_DISCRETES + DSE_SELECTIONS > 0)
#define DSE_MOST_PASSES 100
#define DSE_MOST_TRIED 10 /* relations, of which all combinations are tried */

/* Limit for chattering: number of consecutive events, each close to the one before. */
#define DSE_CLOSE_EVENTS 16

static inline double dse_tick_time(const dse_component *m, int clock, int64_t tick) {
    const struct dse_clock *at = &dse_clocks[clock];
    const double since = (double)(at->phase + tick * at->period) / (double)at->denominator;
    return at->is_from_start ? m->started + since : since;
}

/* The time of the next tick of a clock; infinite if there is none. */
static inline double dse_next_tick(const dse_component *m) {
    double next = INFINITY;
    for (int k = 0; k < DSE_CLOCKS; k++) {
        next = fmin(next, dse_tick_time(m, k, m->next_tick[k]));
    }
    return next;
}

/* Set each clock to its first tick not before *time* - *spare*. */
static void dse_wind_clocks(dse_component *m, double time, double spare) {
    for (int k = 0; k < DSE_CLOCKS; k++) {
        const struct dse_clock *at = &dse_clocks[k];
        const double since = at->is_from_start ? -spare : time - spare;
        const double ticks = ceil((since * (double)at->denominator - (double)at->phase) / (double)at->period);
        int64_t tick = ticks > 0.0 ? (int64_t)ticks : 0;
        while (tick > 0 && dse_tick_time(m, k, tick - 1) >= time - spare) {
            tick--;
        }
        while (dse_tick_time(m, k, tick) < time - spare) {
            tick++;
        }
        m->next_tick[k] = tick;
    }
}

/* Whether a model's function succeeded, which returned *code*. */
static bool dse_is_done(dse_component *m, int code) { return code == 0 || dse_trouble(m, code, 0); }

static bool dse_is_checked(dse_component *m, int answer) {
    return answer == 0 || dse_trouble(m, answer == 2 ? DSE_TERMINATED_BY_MODEL : DSE_VIOLATED, 0);
}

/* Whether discretes and conditions have the same values as before the pass. */
static bool dse_is_settled(const dse_component *m) {
    for (int k = 0; k < DSE_PRE; k++) {
        const double now = m->v[dse_discrete[k]], before = m->pre[k];
        if (now != before && (now == now || before == before)) {
            return false;
        }
    }
    return DSE_CONDITIONS == 0 || memcmp(m->is_true, m->was_true, DSE_CONDITIONS) == 0;
}

/* Hold the relations with their values for v and pre; *is_old*: whether they are unchanged. */
static bool dse_hold(dse_component *m, bool *is_old) {
    double look[DSE_LOOK];
    if (!dse_see(m, look)) {
        return false;
    }
    *is_old = !dse_differs(m, look);
    memcpy(m->held, dse_truth_in(look), DSE_RELATIONS);
    return true;
}

static void dse_keep_before(dse_component *m) {
    for (int k = 0; k < DSE_PRE; k++) {
        m->pre[k] = m->v[dse_discrete[k]];
    }
    memcpy(m->was_true, m->is_true, sizeof m->was_true);
}

/* Whether the equations at an event have a solution in which the relations are as they are held. */
static bool dse_fits(dse_component *m) {
    bool is_held = false;
    memset(m->is_active, 0, sizeof m->is_active);
    memcpy(m->v, m->before_pass, sizeof m->v);
    if (model_event(m) != 0 || !dse_hold(m, &is_held)) {
        dse_forgive(m);
        return false;
    }
    return is_held;
}

/* Try every combination of the relations that have *moved*, all false first: of what sticks and could start to either
 * side, like friction, repeated evaluation takes one side and the other in turn, and never neither. */
static bool dse_search_event(dse_component *m, const uint8_t moved[]) {
    uint8_t others[DSE_ROOM(DSE_RELATIONS)];
    int which[DSE_MOST_TRIED], count = 0;
    for (int k = 0; k < DSE_RELATIONS; k++) {
        if (moved[k] && count == DSE_MOST_TRIED) {
            return false;
        }
        if (moved[k]) {
            which[count++] = k;
        }
    }
    memcpy(others, m->held, DSE_RELATIONS);
    for (uint32_t choice = 0; choice < UINT32_C(1) << count; choice++) {
        memcpy(m->held, others, DSE_RELATIONS);
        for (int n = 0; n < count; n++) {
            m->held[which[n]] = (uint8_t)(choice >> n & 1U);
        }
        if (dse_fits(m)) {
            return true;
        }
    }
    return false;
}

/* The equations at an event, where loops may take another root. */
static int dse_evaluate_event(dse_component *m) {
    m->settled = m->time;
    m->refused = 1.0;
    const int code = model_event(m);
    m->refused = 0.0;
    return code;
}

/* The equations at an event, with relations and variables of one solution. Relations of variables that jump here are
 * found by repeated evaluation from the values before, until they equal those that were used; if it goes round in a
 * circle (Brent's test), by a search. Without such a solution, in a loop through a when-clause, those from before the
 * pass are used: the next pass uses the new ones. */
static bool dse_solve_event(dse_component *m) {
    uint8_t held[DSE_ROOM(DSE_RELATIONS)], seen[DSE_ROOM(DSE_RELATIONS)], moved[DSE_ROOM(DSE_RELATIONS)] = {0};
    memcpy(held, m->held, DSE_RELATIONS);
    memcpy(seen, m->held, DSE_RELATIONS);
    memcpy(m->before_pass, m->v, DSE_RELATIONS > 0 ? sizeof m->v : 0);
    for (int turn = 0; turn <= DSE_MOST_PASSES; turn++) {
        bool is_held = true;
        memset(m->is_active, 0, sizeof m->is_active);
        if (!dse_is_done(m, dse_evaluate_event(m))) {
            return false;
        }
        if (DSE_RELATIONS == 0 || turn == DSE_MOST_PASSES) {
            return true;
        }
        if (!dse_hold(m, &is_held)) {
            return false;
        }
        if (is_held) {
            return true;
        }
        for (int k = 0; k < DSE_RELATIONS; k++) {
            moved[k] |= m->held[k] != seen[k];
        }
        if (memcmp(m->held, seen, DSE_RELATIONS) == 0) {
            if (dse_search_event(m, moved)) {
                return true;
            }
            turn = DSE_MOST_PASSES - 1;
        } else if ((turn & (turn - 1)) == 0) {
            memcpy(seen, m->held, DSE_RELATIONS);
            memset(moved, 0, sizeof moved);
        }
        memcpy(m->v, m->before_pass, sizeof m->v);
        if (turn == DSE_MOST_PASSES - 1) {
            memcpy(m->held, held, DSE_RELATIONS);
        }
    }
    return true;
}

/* One pass of the event iteration; *has_jumped*: whether a state was reinitialized. */
static bool dse_pass(dse_component *m, dse_tell *tell, bool *has_jumped) {
    if (!dse_solve_event(m) || !dse_is_checked(m, model_event_check(m, tell))) {
        return false;
    }
    memset(m->ticks, 0, sizeof m->ticks);
    const int answer = model_reinitialize(m);
    *has_jumped = answer > 0;
    return answer >= 0 || dse_trouble(m, -answer, 0);
}

/* The event iteration, from v at m->time before the event. Clocks that are due until m->time + *spare* tick. Relations
 * may depend on pre, so they are updated after pre. Afterwards v is complete, and the integration can be restarted. */
static bool dse_event(dse_component *m, dse_tell *tell, double spare) {
    bool is_settled = false;
    for (int k = 0; k < DSE_CLOCKS; k++) {
        m->ticks[k] = dse_tick_time(m, k, m->next_tick[k]) <= m->time + spare;
        m->next_tick[k] += m->ticks[k];
    }
    m->solver.past.events++;
    (void)dse_is_selection_due(m, true);
    for (int pass = 0; pass <= DSE_MOST_PASSES; pass++) {
        bool has_jumped, is_held;
        dse_keep_before(m);
        if (!dse_hold(m, &is_held)) {
            return false;
        }
        if (is_settled && is_held && !dse_is_selection_due(m, true)) {
            memset(m->is_active, 0, sizeof m->is_active);
            return true;
        }
        if (!dse_pass(m, tell, &has_jumped)) {
            return false;
        }
        is_settled = !has_jumped && dse_is_settled(m);
    }
    return dse_trouble(m, DSE_UNSETTLED, 0);
}

/* The initialization, from v as set and m->time. */
static bool dse_solve_initial(dse_component *m, dse_tell *tell) {
    const double spare = 1e-9 * fmax(1.0, fabs(m->time));
    bool is_held = false;
    if (!dse_is_done(m, model_parameters(m)) || !dse_is_done(m, model_guess(m))) {
        return false;
    }
    m->started = m->time;
    dse_wind_clocks(m, m->time, spare);
    for (int k = 0; k < DSE_PRE; k++) {
        m->pre[k] = m->v[dse_discrete[k]];
    }
    if (!dse_hold(m, &is_held)) {
        dse_forgive(m); /* of guesses, not of values: the first pass repeats the check */
    }
    is_held = false;
    for (int pass = 0; !is_held && pass < DSE_MOST_PASSES; pass++) {
        memset(m->is_active, 0, sizeof m->is_active);
        if (!dse_is_done(m, model_initial(m)) || !dse_is_checked(m, model_event_check(m, tell))
            || !dse_hold(m, &is_held)) {
            return false;
        }
    }
    if (!is_held) {
        return dse_trouble(m, DSE_UNSETTLED, 0);
    }
    /* Parameters that are not fixed have their values only now. */
    return dse_is_done(m, model_parameters(m)) && dse_event(m, tell, spare);
}

#endif
