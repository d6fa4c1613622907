/* An instance of a component written in C: its initialization and its steps. Its members in *start* that are neither
 * inputs nor parameters stay zero, so init sees values as set, all else zero. */
#ifndef DSE_C_COMPONENT_H
#define DSE_C_COMPONENT_H

#include "instance.h"
#ifdef DSE_OSMP
#include "c_component_osmp.h"
#define DSE_TAKE_BINARIES(instance, function) dse_take_binaries(instance, function)
#else
#define DSE_TAKE_BINARIES(instance, function) true
#endif

#ifdef DSE_CODED
/* The values in *told* and *ask* from init or step go to the model, its *answer* to the component's members. */
static bool dse_ask_coded(struct dse_instance *instance, const char *function, bool begins) {
    dse_component *now = &instance->at.now;
    char said[DSE_CODED_LONGEST + 1];
    double value;
    if (!dse_component_wrong(now, &value)) {
        if (!dse_coded_ask(&instance->coded, begins, now->told, now->ask, now->answer, said)) {
            return dse_refuse(instance, function, "%s", said);
        }
        dse_component_take(now);
    }
    const char *wrong = dse_component_wrong(now, &value);
    return !wrong || dse_refuse(instance, function, "%s: it is %.12g", wrong, value);
}
#define DSE_ASK_CODED(instance, function, begins) dse_ask_coded(instance, function, begins)
#else
#define DSE_ASK_CODED(instance, function, begins) true
#endif

#if defined DSE_UDP
/* The values in *ask* from init or step are sent, the received ones go to the component's members. */
static bool dse_ask_partner(struct dse_instance *instance, const char *function, double step) {
    dse_component *now = &instance->at.now;
    char said[DSE_UDP_LONGEST + 1];
    const int done = dse_udp_ask(&instance->udp, instance->at.time, step, now->ask, now->answer, said);
    if (done == DSE_UDP_DONE) {
        dse_component_take(now);
        return true;
    }
    if (done == DSE_UDP_ENDED && step > 0.0) {
        return false; /* the end of the run is not an error, see DSE_HAS_ENDED */
    }
    return dse_refuse(instance, function, "%s",
        done == DSE_UDP_ENDED ? "the other side has ended the session before its first step" : said);
}
#define DSE_ASK_PARTNER(instance, function, step) dse_ask_partner(instance, function, step)
#elif defined DSE_PARTNER
/* The values in *ask* from init or step go to the partner, its *answer* to the component's members. */
static bool dse_ask_partner(struct dse_instance *instance, const char *function, double step) {
    dse_component *now = &instance->at.now;
    char said[DSE_PARTNER_LONGEST + 1];
    if (!dse_partner_ask(&instance->partner, step > 0.0 ? DSE_PARTNER_STEP : DSE_PARTNER_START, now->ask,
                         sizeof now->ask / sizeof *now->ask, now->answer, sizeof now->answer / sizeof *now->answer,
                         said)) {
        return dse_refuse(instance, function, "%s", said);
    }
    dse_component_take(now);
    return true;
}
#define DSE_ASK_PARTNER(instance, function, step) dse_ask_partner(instance, function, step)
#else
#define DSE_ASK_PARTNER(instance, function, step) true
#endif

static DSE_APART bool dse_refresh(struct dse_instance *instance, const char *function) {
    (void)function;
    if (!DSE_TAKE_BINARIES(instance, function)) {
        return false;
    }
    DSE_CHANGED(instance);
    memcpy(&instance->at.now, &instance->at.start, sizeof instance->at.now);
    dse_component_init(&instance->at.now);
    if (!DSE_ASK_PARTNER(instance, function, 0.0) || !DSE_ASK_CODED(instance, function, true)) {
        return false;
    }
    instance->at.is_stale = 0;
    return true;
}

static bool dse_exit_initialization(struct dse_instance *instance, const char *function) {
    if (instance->at.is_stale && !dse_refresh(instance, function)) {
        return false;
    }
    instance->at.state = DSE_STEPPING;
    return true;
}

/* Advance from *time* by *step*, both in seconds. A sampled component runs at every hit start_time + k * period in
 * [time, time + step). k is counted, never summed up. The tolerance for a hit is 1e-4 of the period, so that an
 * importer whose clock drifts by rounding neither loses nor repeats one. */
static inline bool dse_do_step(struct dse_instance *instance, const char *function, double time, double step) {
    struct dse_snapshot *at;
    if (DSE_UNLIKELY(!dse_is_step_possible(instance, function, time, step))
        || !DSE_TAKE_BINARIES(instance, function)) {
        return false;
    }
    DSE_CHANGED(instance);
    at = &instance->at;
#ifdef DSE_PERIOD
    const double end = (time - at->start_time) + step - 1e-4 * DSE_PERIOD;
    while ((double)at->hits * DSE_PERIOD < end) {
        dse_component_step(&at->now);
        if (!DSE_ASK_CODED(instance, function, false) || !DSE_ASK_PARTNER(instance, function, DSE_PERIOD)) {
            return false;
        }
        at->hits++;
    }
#else
    dse_component_step(&at->now, step);
    if (!DSE_ASK_PARTNER(instance, function, step)) {
        return false;
    }
#endif
    at->time = time + step;
    return true;
}

#endif
