/* A model made from Modelica for model exchange: the importer integrates, the model provides derivatives and events.
 * Independent of the FMI version. */
#ifndef DSE_EXCHANGE_H
#define DSE_EXCHANGE_H

#include "simulation.h"

/* Event information for the importer. */
struct dse_news {
    bool has_ended, has_new_states, has_next_time;
    double next_time;
};

/* An importer stops at the requested time, except for rounding. */
static inline double dse_exchange_spare(const dse_component *m) { return 1e-12 * fmax(1.0, fabs(m->time)); }

static bool dse_is_exchange(struct dse_instance *instance, const char *function, uint32_t states) {
    if (!dse_is_allowed(instance, function, states)) {
        return false;
    }
    return instance->is_exchange || dse_refuse(instance, function, "the instance is for co-simulation");
}

static bool dse_set_mode(struct dse_instance *instance, const char *function, bool is_in_event_mode) {
    if (!dse_is_exchange(instance, function, DSE_STEPPING)) {
        return false;
    }
    instance->at.is_in_event_mode = is_in_event_mode;
    return true;
}

/* Report the trouble, and clear it: the importer may try another point. */
static bool dse_discard(struct dse_instance *instance, const char *function) {
    (void)dse_tell_trouble(instance, function);
    if (!dse_has_ended(instance)) {
        dse_forgive(&instance->at.now);
    }
    instance->at.is_stale = DSE_STALE_DERIVATIVES;
    return false;
}

/* Update derivatives and crossing functions. */
static bool dse_derive(struct dse_instance *instance, const char *function) {
    dse_component *m = &instance->at.now;
    bool is_new;
    if (instance->at.state == DSE_INITIALIZING) {
        return !instance->at.is_stale || dse_initialize(instance, function);
    }
    if (instance->at.is_stale != DSE_STALE_DERIVATIVES) {
        return true;
    }
    if (!dse_take_over(instance, &is_new) || !dse_derive_at(m)) {
        return dse_discard(instance, function);
    }
    instance->at.is_stale = DSE_STALE_OUTPUTS;
    return true;
}

static bool dse_exchange_time(struct dse_instance *instance, const char *function, double time) {
    if (!dse_is_exchange(instance, function, DSE_STEPPING)) {
        return false;
    }
    if (!isfinite(time)) {
        return dse_refuse(instance, function, "the time is not a finite number");
    }
    instance->at.time = instance->at.now.time = time;
    instance->at.is_stale = DSE_STALE_DERIVATIVES;
    return true;
}

static bool dse_is_count(struct dse_instance *instance, const char *function, size_t count, size_t expected) {
    return count == expected
           || dse_refuse(instance, function, "%lu values, where the model has %lu", (unsigned long)count,
               (unsigned long)expected);
}

/* Whether *count* values of *expected* may be read. */
static bool dse_is_readable(struct dse_instance *instance, const char *function, size_t count, size_t expected) {
    return dse_is_exchange(instance, function, DSE_VALUES_KNOWN) && dse_is_count(instance, function, count, expected);
}

static bool dse_exchange_set_states(
    struct dse_instance *instance, const char *function, const double states[], size_t count) {
    if (!dse_is_exchange(instance, function, DSE_STEPPING) || !dse_is_count(instance, function, count, DSE_STATES)) {
        return false;
    }
    dse_put_states(&instance->at.now, states);
    instance->at.is_stale = DSE_STALE_DERIVATIVES;
    return true;
}

static bool dse_exchange_get_states(
    struct dse_instance *instance, const char *function, double states[], size_t count) {
    if (!dse_is_readable(instance, function, count, DSE_STATES)
        || (instance->at.state == DSE_INITIALIZING && !dse_derive(instance, function))) {
        return false;
    }
    dse_get_states(&instance->at.now, states);
    return true;
}

static bool dse_exchange_get_slope(struct dse_instance *instance, const char *function, double slope[], size_t count) {
    if (!dse_is_readable(instance, function, count, DSE_STATES)
        || !dse_derive(instance, function)) {
        return false;
    }
    return dse_get_slope(&instance->at.now, slope) || dse_discard(instance, function);
}

static bool dse_exchange_get_nominals(
    struct dse_instance *instance, const char *function, double nominals[], size_t count) {
    if (!dse_is_readable(instance, function, count, DSE_STATES)) {
        return false;
    }
    memcpy(nominals, dse_nominals, DSE_STATES * sizeof *nominals);
    return true;
}

static bool dse_exchange_get_indicators(
    struct dse_instance *instance, const char *function, double indicators[], size_t count) {
    dse_component *m = &instance->at.now;
    double look[DSE_LOOK];
    if (!dse_is_readable(instance, function, count, DSE_INDICATORS)
        || !dse_derive(instance, function)) {
        return false;
    }
    if (!dse_see(m, look)) {
        return dse_discard(instance, function);
    }
    for (int k = 0; k < DSE_INDICATORS; k++) {
        indicators[k] = dse_event_indicator(m, k, look);
    }
    return true;
}

/* The event iteration at the present point, in event mode. */
static bool dse_exchange_update(struct dse_instance *instance, const char *function, struct dse_news *news) {
    dse_component *m = &instance->at.now;
    double before[DSE_N], after[DSE_N];
    bool is_new;
    if (!dse_is_exchange(instance, function, DSE_STEPPING)) {
        return false;
    }
    if (!instance->at.is_in_event_mode) {
        return dse_refuse(instance, function, "not allowed outside of the event mode");
    }
    dse_get_states(m, before);
    const bool is_done = dse_take_over(instance, &is_new) && dse_is_done(m, model_derivatives(m))
                         && dse_event(m, dse_tell_check, dse_exchange_spare(m)) && dse_check_all(m, dse_tell_check);
    dse_keep_roots(m);
    dse_get_states(m, after);
    news->has_ended = dse_has_ended(instance);
    news->has_new_states = DSE_STATES > 0 && memcmp(before, after, DSE_STATES * sizeof *before) != 0;
    news->next_time = dse_next_tick(m);
    news->has_next_time = isfinite(news->next_time);
    instance->at.is_stale = DSE_STALE_OUTPUTS;
    return is_done || dse_tell_trouble(instance, function) || news->has_ended;
}

/* The importer's solver has completed a step: keeps the roots of loops, and checks the asserts. *needs_event*: states
 * have to be selected anew. */
static bool dse_exchange_completed(
    struct dse_instance *instance, const char *function, bool *needs_event, bool *has_ended) {
    *needs_event = *has_ended = false;
    if (!dse_is_exchange(instance, function, DSE_STEPPING)) {
        return false;
    }
    if (DSE_CHECKS + DSE_ROOTS + DSE_SELECTIONS == 0) {
        return true;
    }
    if (!dse_derive(instance, function)) {
        return false;
    }
    dse_keep_roots(&instance->at.now);
    *needs_event = dse_is_selection_due(&instance->at.now, false);
    const bool is_done = dse_check_all(&instance->at.now, dse_tell_check);
    *has_ended = dse_has_ended(instance);
    return is_done || dse_tell_trouble(instance, function) || *has_ended;
}

#endif
