/* An instance of a model from Modelica: initialization, steps, reading, messages. Independent of the FMI version. */
#ifndef DSE_SIMULATION_H
#define DSE_SIMULATION_H

#include "instance.h"

#include "co_simulation.h"

static struct dse_instance *dse_instance_of(dse_component *m) {
    return (struct dse_instance *)(void *)((char *)m - offsetof(struct dse_instance, at.now));
}

/* Reports a violated assert or a terminate; a warning only once. */
static void dse_tell_check(dse_component *m, int check, int is_warning, const char *text) {
    struct dse_instance *instance = dse_instance_of(m);
    char message[512];
    if (is_warning && m->has_told[check]) {
        return;
    }
    m->has_told[check] = 1;
    (void)snprintf(message, sizeof message, "at %.12g s: %s", m->time, text);
    instance->tell(instance, is_warning, message);
}

/* Report the model's trouble; false. */
static DSE_APART bool dse_tell_trouble(struct dse_instance *instance, const char *function) {
    const dse_reason *trouble = &instance->at.now.solver.trouble;
    const double time = trouble->time;
    if (trouble->code > 0) {
        return dse_refuse(instance, function, "at %.12g s: %s", time, dse_failure[trouble->code - 1]);
    }
    switch (trouble->code) {
    case DSE_NOT_FINITE:
        return dse_refuse(instance, function, "at %.12g s: the derivative of '%s' is not a finite number", time,
            dse_state_names[trouble->subject]);
    case DSE_SINGULAR: return dse_refuse(instance, function, "at %.12g s: the stiff solver's matrix is singular", time);
    case DSE_TOO_INACCURATE:
        return dse_refuse(instance, function, "at %.12g s: no step is small enough for the tolerance of %g", time,
            instance->at.now.solver.tolerance);
    case DSE_TOO_MANY_STEPS:
        return dse_refuse(instance, function, "at %.12g s: more than %d internal steps in one step; %s", time,
            DSE_MOST_STEPS, DSE_HAS_STIFF ? "the tolerance may be too small" : "the stiff solver may be needed");
    case DSE_CHATTERS:
        return dse_refuse(instance, function, "at %.12g s: chatters, %d events with next to no time between them: %s",
            time, DSE_CLOSE_EVENTS, dse_relations[trouble->subject]);
    case DSE_UNSETTLED:
        return dse_refuse(
            instance, function, "at %.12g s: the event iteration finds no end in %d passes", time, DSE_MOST_PASSES);
    case DSE_TERMINATED_BY_MODEL:
        return dse_refuse(instance, function, "at %.12g s: the model has ended the simulation", time);
    default: return dse_refuse(instance, function, "at %.12g s: an assert of the model is violated", time);
    }
}

/* Whether the model itself has ended the simulation. */
static inline bool dse_has_ended(const struct dse_instance *instance) {
    return instance && instance->at.now.solver.trouble.code == DSE_TERMINATED_BY_MODEL;
}

static void dse_tell_nothing(dse_component *m, int check, int is_warning, const char *text) {
    (void)m, (void)check, (void)is_warning, (void)text;
}

/* The initial values, from all values set until now; false on trouble, which is stored. */
static DSE_APART bool dse_find_initial(struct dse_instance *instance, dse_tell *tell) {
    dse_component *m = &instance->at.now;
    uint8_t told[sizeof m->has_told];
    memcpy(told, m->has_told, sizeof told);
    memset(m, 0, sizeof *m);
    memcpy(m->has_told, told, sizeof told);
    memcpy(m->v, instance->at.start.v, sizeof m->v);
    m->time = instance->at.start_time;
    m->solver.tolerance = instance->at.tolerance > 0.0 ? instance->at.tolerance : DSE_DEFAULT_TOLERANCE;
    m->solver.past.will_be_stiff = DSE_SOLVER == DSE_STIFF_SOLVER;
    instance->at.is_changed = 0;
    if (!dse_solve_initial(m, tell) || !dse_is_done(m, model_outputs(m))) {
        return false;
    }
    model_aliases(m);
    instance->at.is_stale = 0;
    return true;
}

static bool dse_initialize(struct dse_instance *instance, const char *function) {
    return dse_find_initial(instance, dse_tell_check) || dse_tell_trouble(instance, function);
}

/* Values of at.is_stale while stepping. */
enum { DSE_FRESH = 0, DSE_STALE_OUTPUTS = 1, DSE_STALE_DERIVATIVES = 2, DSE_STALE_INPUTS = 3 };

/* The staleness after another value was set. */
static inline uint32_t dse_staleness(const struct dse_instance *instance) {
    if (instance->at.state != DSE_STEPPING) {
        return 1;
    }
    return instance->is_exchange ? DSE_STALE_DERIVATIVES : DSE_STALE_INPUTS;
}

/* Newly set values are copied to the model, and dependent parameters are computed; *is_new*: whether a value differs.
 * False on trouble, which is stored. */
static bool dse_take_over(struct dse_instance *instance, bool *is_new) {
    const double *set = instance->at.start.v;
    double *now = instance->at.now.v;
    uint8_t found = 0;
    *is_new = false;
    if (!instance->at.is_changed) {
        return true;
    }
    instance->at.is_changed = 0;
    for (uint32_t k = 0; k < DSE_SLOT_COUNT; k++) {
        const uint32_t place = dse_slots[k].offset / 8;
        if ((dse_slots[k].settable & DSE_STEPPING) && memcmp(&set[place], &now[place], sizeof *now) != 0) {
            now[place] = set[place];
            found |= dse_slots[k].settable;
        }
    }
    *is_new = found != 0;
    return !(found & DSE_OF_PARAMETER) || dse_is_done(&instance->at.now, model_parameters(&instance->at.now));
}

/* Update v before it is read. */
static DSE_APART bool dse_refresh(struct dse_instance *instance, const char *function) {
    dse_component *m = &instance->at.now;
    bool is_new = false;
    if (instance->at.state == DSE_INITIALIZING) {
        /* In a loop of components the inputs are not final yet. If they have no solution, the start values are
         * returned. Whether the final inputs have one is reported at the end of the initialization. */
        if (!dse_find_initial(instance, dse_tell_nothing)) {
            memcpy(m->v, instance->at.start.v, sizeof m->v);
            instance->at.is_stale = 1;
        }
        return true;
    }
    if (m->solver.trouble.code != DSE_NO_TROUBLE) {
        return true; /* after a failure the last values are returned */
    }
    /* Outputs follow inputs at once, so that a master can pass values on and solve loops between two steps. Discrete
     * variables and events wait for the next step. */
    if ((instance->is_exchange || instance->at.is_stale == DSE_STALE_INPUTS) && !dse_take_over(instance, &is_new)) {
        return dse_tell_trouble(instance, function);
    }
    instance->at.has_new |= is_new;
    if ((instance->at.is_stale == DSE_STALE_DERIVATIVES || is_new) && !dse_is_done(m, model_derivatives(m))) {
        return dse_tell_trouble(instance, function);
    }
    if (!dse_is_done(m, model_outputs(m))) {
        return dse_tell_trouble(instance, function);
    }
    model_aliases(m);
    instance->at.is_stale = 0;
    return true;
}

static bool dse_exit_initialization(struct dse_instance *instance, const char *function) {
    dse_component *m = &instance->at.now;
    if (instance->at.is_stale && !dse_initialize(instance, function)) {
        return false;
    }
    if (!dse_check_all(m, dse_tell_check) || !dse_restart(m)) {
        return dse_tell_trouble(instance, function);
    }
    instance->at.state = DSE_STEPPING;
    instance->at.is_in_event_mode = instance->is_exchange;
    return true;
}

/* Advance from *time* by *step*, both in seconds, with the inputs set last, held over the step. A clock that ticks at
 * *time* ticks now. One at time + step ticks in the next step, so that it uses the inputs of that instant. */
static bool dse_do_step(struct dse_instance *instance, const char *function, double time, double step) {
    struct dse_snapshot *at;
    dse_component *m;
    bool is_new = false;
    if (DSE_UNLIKELY(!dse_is_step_possible(instance, function, time, step))) {
        return false;
    }
    at = &instance->at;
    m = &at->now;
    if (instance->is_exchange) {
        return dse_refuse(instance, function, "the instance is for model exchange");
    }
    if (m->solver.trouble.code != DSE_NO_TROUBLE) {
        return dse_refuse(instance, function, "the simulation has failed at %.12g s", m->solver.trouble.time);
    }
    const double spare = DSE_SPARE * step;
    const bool had_new = at->has_new;
    at->has_new = 0;
    m->solver.span = step;
    at->is_stale = DSE_CHECKS > 0 ? DSE_FRESH : DSE_STALE_OUTPUTS; /* asserts have computed the outputs already */
    if (!dse_take_over(instance, &is_new) || !dse_begin_step(m, dse_tell_check, is_new || had_new, spare)
        || !dse_advance(m, dse_tell_check, time + step, !(is_new || had_new), spare)) {
        at->time = m->solver.trouble.time;
        return dse_tell_trouble(instance, function);
    }
    at->time = time + step;
    return true;
}

#endif
