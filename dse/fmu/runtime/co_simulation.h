/* One communication step: inputs are held, the solver makes its own steps, events are located in time. */
#ifndef DSE_CO_SIMULATION_H
#define DSE_CO_SIMULATION_H

#include "events.h"

#define DSE_MOST_STEPS 1000000

/* Tolerance, in communication steps, between an importer's clock and a model's, for rounding. */
#define DSE_SPARE 1e-6

/* The asserts, for the present values in v. */
static bool dse_check_all(dse_component *m, dse_tell *tell) {
    if (DSE_CHECKS == 0) {
        return true;
    }
    if (!dse_is_done(m, model_outputs(m))) {
        return false;
    }
    model_aliases(m);
    return dse_is_checked(m, model_check(m, tell));
}

/* An event at m->time, then ready to integrate again. v is at m->time, derivatives included. */
static bool dse_event_and_restart(dse_component *m, dse_tell *tell, double spare) {
    return dse_event(m, tell, spare) && dse_check_all(m, tell) && dse_restart(m);
}

/* At the beginning of a communication step: events of new inputs or parameters, and due ticks. */
static bool dse_begin_step(dse_component *m, dse_tell *tell, bool is_changed, double spare) {
    if (!is_changed && dse_next_tick(m) > m->time + spare) {
        return true;
    }
    dse_get_states(m, m->solver.trial);
    if (!dse_place(m, m->time, m->solver.trial)) {
        return false;
    }
    if (!DSE_HAS_EVENTS) {
        return dse_restart(m);
    }
    return dse_event_and_restart(m, tell, spare);
}

/* Move v to the end of the last step, unless it is there. */
static inline bool dse_stand_at_end(dse_component *m) {
    return m->solver.is_at_end || dse_place(m, m->solver.end, m->solver.to);
}

/* A state event at the end of the last step, which is now. */
static bool dse_meet_event(dse_component *m, dse_tell *tell) {
    struct dse_solver *s = &m->solver;
    double look[DSE_LOOK];
    if (!dse_place(m, s->end, s->to) && !s->is_at_border) {
        return false;
    }
    s->is_at_border = 0;
    dse_forgive(m);
    if (!dse_see(m, look)) {
        return false;
    }
    if (dse_chatters(s, m->time, DSE_CLOSE_EVENTS)) {
        const int64_t which = dse_first_crossed(m, look);
        return dse_trouble(m, DSE_CHATTERS, which < 0 ? 0 : (uint32_t)which);
    }
    s->past.next_width = 0.0; /* the experience of the solver is from before the event */
    return dse_event_and_restart(m, tell, 0.0);
}

/* Set v for *states* at a *time* within the last step. They are accurate to the tolerance, and may be slightly beyond a
 * fold: then v is on the branch that follows. */
static bool dse_place_within(dse_component *m, double time, const double states[]) {
    if (dse_place(m, time, states)) {
        return true;
    }
    const dse_reason trouble = m->solver.trouble;
    dse_forgive(m);
    m->refused = INFINITY;
    const bool is_placed = DSE_ROOTS > 0 && dse_place(m, time, states);
    m->refused = 0.0;
    if (!is_placed) {
        m->solver.trouble = trouble;
    }
    return is_placed;
}

#ifndef DSE_BRANCHES
#define DSE_BRANCHES 0 /* whether there may be branches without events */
#endif

/* From m->time to *target* with the present inputs. *is_steady*: they have not changed, so the solver may step beyond;
 * its dense output then gives the states at *target*. False on trouble, which is stored. */
static bool dse_advance(dse_component *m, dse_tell *tell, double target, bool is_steady, double spare) {
    struct dse_solver *s = &m->solver;
    /* A long step may miss crossings, and jumps of branches without events. Without states, nothing measures its error. */
    const bool is_short = !is_steady || (DSE_STATES == 0 && DSE_ROOTS > 0);
    const double ahead = is_short ? 0.0 : DSE_RELATIONS + DSE_BRANCHES > 0 ? s->span : 1000.0 * s->span;
    const int64_t most = s->past.steps + DSE_MOST_STEPS;
    while (s->end <= target) {
        const double tick = dse_next_tick(m);
        const bool ticks_before = tick < target - spare;
        if (s->has_event) {
            if (!dse_meet_event(m, tell)) {
                return false;
            }
        } else if (ticks_before && s->end >= tick) {
            if (!dse_stand_at_end(m) || !dse_event_and_restart(m, tell, 0.0)) {
                return false;
            }
        } else if (s->end == target) {
            return dse_stand_at_end(m) && dse_check_all(m, tell);
        } else {
            if (DSE_CHECKS > 0 && s->has_step && !(dse_stand_at_end(m) && dse_check_all(m, tell))) {
                return false;
            }
            if (DSE_SELECTIONS > 0 && s->has_step) {
                if (!dse_stand_at_end(m)) {
                    return false;
                }
                if (dse_is_selection_due(m, false) && !dse_event_and_restart(m, tell, 0.0)) {
                    return false;
                }
            }
            if (s->past.steps == most) {
                m->time = s->end;
                return dse_trouble(m, DSE_TOO_MANY_STEPS, 0);
            }
            if (!dse_take_step(m, ticks_before ? tick : fmin(target + ahead, fmax(tick, target)))) {
                return false;
            }
        }
    }
    dse_dense_states(m, (target - s->start) / s->width, s->trial);
    return dse_place_within(m, target, s->trial) && dse_check_all(m, tell);
}

#endif
