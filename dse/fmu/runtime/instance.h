/* One instance of a component: its life, its time, its saved states. Independent of the FMI version. Until the
 * initialization is over, inputs and parameters are collected in *start*. The component's present values, *now*, are
 * computed from it whenever values have changed and an output is read, so the initialization always starts from the
 * same values. c_component.h for C and simulation.h for Modelica (DSE_MODEL) implement this, and the steps.
 */
#ifndef DSE_INSTANCE_H
#define DSE_INSTANCE_H

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"
#include "slot.h"
#ifdef DSE_PARTNER
#include "partner.h"
#endif
#ifdef DSE_UDP
#include "udp.h"
#endif
#ifdef DSE_CODED
#include "coded.h"
#endif

#if defined _WIN32
#define DSE_EXPORT __declspec(dllexport)
#else
#define DSE_EXPORT __attribute__((visibility("default")))
#endif
/* The name of the present FMI function. Where several components share a library, names there have a prefix. */
#ifdef DSE_PREFIX
#define DSE_HERE (&__func__[sizeof DSE_PREFIX - 1])
#else
#define DSE_HERE __func__
#endif
/* Not inlined into the many accessors that call it: compiling copies would dominate the build time. */
#define DSE_APART __attribute__((noinline))
#define DSE_LIKELY(condition) __builtin_expect(!!(condition), 1)
#define DSE_UNLIKELY(condition) __builtin_expect(!!(condition), 0)
#define DSE_ANY_STATE (DSE_INSTANTIATED | DSE_INITIALIZING | DSE_STEPPING | DSE_TERMINATED)
#define DSE_VALUES_KNOWN (DSE_INITIALIZING | DSE_STEPPING | DSE_TERMINATED)

#ifndef DSE_MODEL
typedef dse_component dse_settings;
#endif

/* Content of a saved state: only numbers, so that it can be copied and written to a file. */
struct dse_snapshot {
    uint32_t state;
    uint32_t is_stale; /* *now* is older than *start*; for a model see also DSE_STALE_... */
    uint32_t is_set_up;
    uint16_t is_changed;       /* of a model: something was set since the last step */
    uint16_t is_in_event_mode; /* of a model for model exchange */
    uint32_t has_new;          /* of a model for co-simulation: *now* has values that the last step did not use */
    uint32_t padding;
    int64_t hits;              /* sample hits that have run */
    double start_time;
    double time;
    double tolerance; /* the importer's; 0 if it has none */
    dse_settings start;
    dse_component now;
};

#ifdef DSE_OSMP
/* Binaries as FMI 2.0 can pass them, see c_component_osmp.h. Not part of a saved state. */
struct dse_osmp {
    int32_t told[DSE_BINARIES][3];
    bool is_told[DSE_BINARIES];
    bool is_shown;
    unsigned char side;
    size_t sizes[2][DSE_BINARIES];
    struct dse_binary_room shown[2];
};
#endif

struct dse_instance {
    struct dse_snapshot at;
    void (*tell)(struct dse_instance *instance, int is_warning, const char *message);
    void (*callback)(void); /* the importer's logger; only *tell* uses its type */
    void *environment;
    char *name;
    bool is_exchange; /* the importer has the solver */
#ifdef DSE_PARTNER
    struct dse_partner partner;
#endif
#ifdef DSE_UDP
    struct dse_udp udp;
#endif
#ifdef DSE_CODED
    struct dse_coded coded;
#endif
#ifdef DSE_OSMP
    struct dse_osmp osmp; /* last: the members before it have the same places without it */
#endif
};

/* Call when outputs may have changed. */
#ifdef DSE_OSMP
#define DSE_CHANGED(instance) ((instance)->osmp.is_shown = false)
#else
#define DSE_CHANGED(instance) ((void)0)
#endif

static const char *dse_state_name(uint32_t state) {
    switch (state) {
    case DSE_INSTANTIATED: return "before the initialization mode";
    case DSE_INITIALIZING: return "in the initialization mode";
    case DSE_STEPPING: return "while stepping";
    case DSE_TERMINATED: return "after the termination";
    default: return "in an unknown state";
    }
}

/* Report an error to the importer; false, so that a caller can return it. */
static DSE_APART bool dse_refuse(struct dse_instance *instance, const char *function, const char *format, ...) {
    char text[512];
    int used = snprintf(text, sizeof text, "%s: ", function);
    va_list arguments;
    va_start(arguments, format);
    if (used > 0 && (size_t)used < sizeof text) {
        vsnprintf(text + used, sizeof text - (size_t)used, format, arguments);
    }
    va_end(arguments);
    instance->tell(instance, 0, text);
    return false;
}

static DSE_APART bool dse_refuse_state(struct dse_instance *instance, const char *function) {
    return instance && dse_refuse(instance, function, "not allowed %s", dse_state_name(instance->at.state));
}

static inline bool dse_is_allowed(struct dse_instance *instance, const char *function, uint32_t states) {
    if (DSE_UNLIKELY(!instance || !(instance->at.state & states))) {
        return dse_refuse_state(instance, function);
    }
    return true;
}

/* Ends a UDP session with the run, and reports its packet errors. */
static void dse_end_session(struct dse_instance *instance) {
#ifdef DSE_UDP
    char said[DSE_UDP_LONGEST + 1];
    dse_udp_end(&instance->udp);
    if (dse_udp_tell_trouble(&instance->udp, said)) {
        instance->tell(instance, 1, said);
    }
    memset(&instance->udp.counts, 0, sizeof instance->udp.counts);
#else
    (void)instance;
#endif
}

static void dse_rewind(struct dse_instance *instance) {
    dse_end_session(instance);
    memset(&instance->at, 0, sizeof instance->at);
#ifdef DSE_OSMP
    memset(instance->osmp.is_told, 0, sizeof instance->osmp.is_told);
#endif
    DSE_CHANGED(instance);
    instance->at.state = DSE_INSTANTIATED;
#ifdef DSE_MODEL
    memcpy(instance->at.start.v, dse_starts, DSE_VALUES * sizeof *dse_starts);
#else
    dse_component_start(&instance->at.start);
#endif
}

static struct dse_instance *dse_create(const char *name) {
    struct dse_instance *instance = calloc(1, sizeof *instance);
    size_t length = strlen(name) + 1;
    if (!instance) {
        return NULL;
    }
    instance->name = malloc(length);
    if (!instance->name) {
        free(instance);
        return NULL;
    }
    memcpy(instance->name, name, length);
    dse_rewind(instance);
    return instance;
}

static void dse_destroy(struct dse_instance *instance) {
    if (instance) {
#ifdef DSE_PARTNER
        dse_partner_end(&instance->partner);
#endif
#ifdef DSE_UDP
        dse_end_session(instance);
        dse_udp_close(&instance->udp);
#endif
#ifdef DSE_CODED
        dse_coded_end(&instance->coded);
#endif
        free(instance->name);
        free(instance);
    }
}

/* *tolerance*: 0 if the importer has none. */
static bool dse_set_up(struct dse_instance *instance, const char *function, double start_time, double tolerance) {
    if (!isfinite(start_time)) {
        return dse_refuse(instance, function, "the start time is not a finite number");
    }
    if (!(tolerance >= 0.0 && tolerance < 1.0)) {
        return dse_refuse(instance, function, "the tolerance of %g is not between 0 and 1", tolerance);
    }
    instance->at.tolerance = tolerance;
    instance->at.start_time = instance->at.time = start_time;
    instance->at.is_set_up = 1;
    return true;
}

static void dse_enter_initialization(struct dse_instance *instance) {
    instance->at.state = DSE_INITIALIZING;
    instance->at.is_stale = 1;
}

/* Whether a step of *step* seconds may be made from *time*. */
static inline bool dse_is_step_possible(struct dse_instance *instance, const char *function, double time, double step) {
    const struct dse_snapshot *at;
    if (DSE_UNLIKELY(!dse_is_allowed(instance, function, DSE_STEPPING))) {
        return false;
    }
    at = &instance->at;
    if (DSE_UNLIKELY(!(step > 0.0 && step <= DBL_MAX))) {
        return dse_refuse(instance, function, "the step of %g s is not positive and finite", step);
    }
    if (DSE_UNLIKELY(!(fabs(time - at->time) <= 1e-6 * step + 1e-12 * fabs(time)))) {
        return dse_refuse(instance, function, "starts at %.17g s, but the instance stands at %.17g s", time, at->time);
    }
    return true;
}

/* Saved states: a copy of the snapshot. Serialized, the token comes first: states of other components are refused. */
#define DSE_SERIALIZED_SIZE (sizeof DSE_TOKEN + sizeof(struct dse_snapshot))

static bool dse_keep(
    struct dse_instance *instance, const char *function, const struct dse_snapshot *from, void **state) {
#ifdef DSE_PARTNER
    return dse_refuse(instance, function, "the state of its process cannot be saved");
#endif
#ifdef DSE_UDP
    return dse_refuse(instance, function, "the state of the other side cannot be saved");
#endif
#ifdef DSE_CODED
    return dse_refuse(instance, function, "the state of code that Simulink generated cannot be saved");
#endif
    if (!*state) {
        *state = malloc(sizeof *from);
    }
    if (!*state) {
        return dse_refuse(instance, function, "out of memory");
    }
    memcpy(*state, from, sizeof *from);
    return true;
}

static bool dse_restore(struct dse_instance *instance, const char *function, const void *state) {
    if (!state) {
        return dse_refuse(instance, function, "no saved state given");
    }
    memcpy(&instance->at, state, sizeof instance->at);
    DSE_CHANGED(instance);
    return true;
}

static bool dse_serialize(
    struct dse_instance *instance, const char *function, const void *state, void *bytes, size_t size) {
    if (!state || size < DSE_SERIALIZED_SIZE) {
        return dse_refuse(instance, function, "no saved state given, or too little room for it");
    }
    memcpy(bytes, DSE_TOKEN, sizeof DSE_TOKEN);
    memcpy((char *)bytes + sizeof DSE_TOKEN, state, sizeof(struct dse_snapshot));
    return true;
}

static bool dse_deserialize(
    struct dse_instance *instance, const char *function, const void *bytes, size_t size, void **state) {
    struct dse_snapshot read;
    if (size != DSE_SERIALIZED_SIZE || memcmp(bytes, DSE_TOKEN, sizeof DSE_TOKEN) != 0) {
        return dse_refuse(instance, function, "the bytes are not a saved state of this component");
    }
    memcpy(&read, (const char *)bytes + sizeof DSE_TOKEN, sizeof read);
    return dse_keep(instance, function, &read, state);
}

#endif
