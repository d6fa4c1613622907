/* The functions of FMI 2.0 over one component: co-simulation, and model exchange for a model from Modelica. */
#define _POSIX_C_SOURCE 200809L /* for partner.h and udp.h, if included */
#include "fmi2_abi.h"
#include "model.h"
#ifdef DSE_BINARIES
#define DSE_OSMP
#endif
#include "value.h"
#ifdef DSE_HAS_TEXTS
#include "c_component_texts.h"
#endif

/* Most functions that only refuse do not use their arguments. */
#pragma GCC diagnostic ignored "-Wunused-parameter"

#define STATUS(is_ok) ((is_ok) ? fmi2OK : fmi2Error)
#define REFUSE(component, reason)                                                                                      \
    do {                                                                                                               \
        if (component) {                                                                                               \
            dse_refuse(component, DSE_HERE, reason);                                                                   \
        }                                                                                                              \
        return fmi2Error;                                                                                              \
    } while (0)

static void tell(struct dse_instance *instance, int is_warning, const char *message) {
    const fmi2Logger logger = (fmi2Logger)instance->callback;
    if (logger && is_warning) {
        logger(instance->environment, instance->name, fmi2Warning, "logStatusWarning", message);
    } else if (logger) {
        logger(instance->environment, instance->name, fmi2Error, "logStatusError", message);
    }
}

DSE_EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

DSE_EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

/* Errors are always logged; there is nothing else to log. */
DSE_EXPORT fmi2Status fmi2SetDebugLogging(
    fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]) {
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE));
}

/* Life */

DSE_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
    const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    struct dse_instance *instance = dse_create(name ? name : "");
    const char *reason = NULL;
    if (!instance) {
        return NULL;
    }
    instance->tell = tell;
    instance->callback = functions ? (void (*)(void))functions->logger : NULL;
    instance->environment = functions ? functions->componentEnvironment : NULL;
    if (!name || !*name) {
        reason = "the instance has no name";
    } else if (!guid || strcmp(guid, DSE_TOKEN) != 0) {
        reason = "the GUID is not that of this FMU; modelDescription.xml and library belong to different builds";
    }
#ifdef DSE_MODEL
    instance->is_exchange = type == fmi2ModelExchange;
#else
    if (!reason && type != fmi2CoSimulation) {
        reason = "only co-simulation is supported";
    }
#endif
    if (reason) {
        dse_refuse(instance, DSE_HERE, "%s", reason);
        dse_destroy(instance);
        return NULL;
    }
    return instance;
}

DSE_EXPORT void fmi2FreeInstance(fmi2Component c) { dse_destroy(c); }

DSE_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
    fmi2Real start_time, fmi2Boolean has_stop_time, fmi2Real stop_time) {
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_INSTANTIATED)
                  && dse_set_up(c, DSE_HERE, start_time, has_tolerance ? tolerance : 0.0));
}

DSE_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    struct dse_instance *instance = c;
    if (!dse_is_allowed(instance, DSE_HERE, DSE_INSTANTIATED)) {
        return fmi2Error;
    }
    if (!instance->at.is_set_up) {
        REFUSE(instance, "fmi2SetupExperiment has to be called first");
    }
    dse_enter_initialization(instance);
    return fmi2OK;
}

DSE_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    if (!dse_is_allowed(c, DSE_HERE, DSE_INITIALIZING)) {
        return fmi2Error;
    }
    return STATUS(dse_exit_initialization(c, DSE_HERE));
}

DSE_EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
    struct dse_instance *instance = c;
    if (!dse_is_allowed(instance, DSE_HERE, DSE_STEPPING)) {
        return fmi2Error;
    }
    dse_end_session(instance);
    instance->at.state = DSE_TERMINATED;
    return fmi2OK;
}

DSE_EXPORT fmi2Status fmi2Reset(fmi2Component c) {
    if (!dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE)) {
        return fmi2Error;
    }
    dse_rewind(c);
    return fmi2OK;
}

DSE_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean never_back) {
    return dse_do_step(c, DSE_HERE, time, step) ? fmi2OK : DSE_HAS_ENDED(c) ? fmi2Discard : fmi2Error;
}

DSE_EXPORT fmi2Status fmi2CancelStep(fmi2Component c) { REFUSE(c, "no step is ever pending"); }

/* Values */

DSE_EXPORT fmi2Status fmi2GetReal(
    fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2Real values[]) {
    return STATUS(dse_get_reals(c, DSE_HERE, references, count, values));
}

DSE_EXPORT fmi2Status fmi2SetReal(
    fmi2Component c, const fmi2ValueReference references[], size_t count, const fmi2Real values[]) {
    return STATUS(dse_set_reals(c, DSE_HERE, references, count, values));
}

#ifdef DSE_OSMP
#define GET_WHOLE(c, function, reference, kinds, value)                                                                \
    (dse_is_osmp(reference, kinds) ? dse_get_osmp(c, function, reference, value)                                       \
                                   : dse_get_whole(c, function, reference, kinds, INT_MIN, INT_MAX, value))
#define SET_WHOLE(c, function, reference, kinds, value)                                                                \
    (dse_is_osmp(reference, kinds) ? dse_set_osmp(c, function, reference, value)                                       \
                                   : dse_set_whole(c, function, reference, kinds, value))
#else
#define GET_WHOLE(c, function, reference, kinds, value)                                                                \
    dse_get_whole(c, function, reference, kinds, INT_MIN, INT_MAX, value)
#define SET_WHOLE(c, function, reference, kinds, value) dse_set_whole(c, function, reference, kinds, value)
#endif

#define WHOLE(name, type, kinds)                                                                                       \
    DSE_EXPORT fmi2Status fmi2Get##name(                                                                               \
        fmi2Component c, const fmi2ValueReference references[], size_t count, type values[]) {                         \
        bool is_ok = dse_begin_get(c, DSE_HERE);                                                                       \
        for (size_t k = 0; is_ok && k < count; k++) {                                                                  \
            int64_t value = 0;                                                                                         \
            is_ok = GET_WHOLE(c, DSE_HERE, references[k], kinds, &value);                                              \
            values[k] = (type)value;                                                                                   \
        }                                                                                                              \
        return STATUS(is_ok);                                                                                          \
    }                                                                                                                  \
    DSE_EXPORT fmi2Status fmi2Set##name(                                                                               \
        fmi2Component c, const fmi2ValueReference references[], size_t count, const type values[]) {                   \
        bool is_ok = dse_begin_set(c, DSE_HERE);                                                                       \
        for (size_t k = 0; is_ok && k < count; k++) {                                                                  \
            is_ok = SET_WHOLE(c, DSE_HERE, references[k], kinds, values[k]);                                           \
        }                                                                                                              \
        return STATUS(is_ok);                                                                                          \
    }

WHOLE(Integer, fmi2Integer, DSE_INTEGER | DSE_ENUMERATION)
WHOLE(Boolean, fmi2Boolean, DSE_BOOLEAN)

#ifdef DSE_HAS_TEXTS
DSE_EXPORT fmi2Status fmi2GetString(
    fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2String values[]) {
    bool is_ok = dse_begin_get(c, DSE_HERE);
    for (size_t k = 0; is_ok && k < count; k++) {
        is_ok = dse_get_text(c, DSE_HERE, references[k], &values[k]);
    }
    return STATUS(is_ok);
}

DSE_EXPORT fmi2Status fmi2SetString(
    fmi2Component c, const fmi2ValueReference references[], size_t count, const fmi2String values[]) {
    bool is_ok = dse_begin_set(c, DSE_HERE);
    for (size_t k = 0; is_ok && k < count; k++) {
        is_ok = dse_set_text(c, DSE_HERE, references[k], values[k]);
    }
    return STATUS(is_ok);
}
#else
DSE_EXPORT fmi2Status fmi2GetString(
    fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2String values[]) {
    REFUSE(c, "there are no strings");
}

DSE_EXPORT fmi2Status fmi2SetString(
    fmi2Component c, const fmi2ValueReference references[], size_t count, const fmi2String values[]) {
    REFUSE(c, "there are no strings");
}
#endif

/* Saved states */

DSE_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    struct dse_instance *instance = c;
#ifdef DSE_OSMP
    if (instance && !dse_take_binaries(c, DSE_HERE)) {
        return fmi2Error;
    }
#endif
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE) && dse_keep(c, DSE_HERE, &instance->at, state));
}

DSE_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE) && dse_restore(c, DSE_HERE, state));
}

DSE_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    free(*state);
    *state = NULL;
    return fmi2OK;
}

DSE_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    *size = DSE_SERIALIZED_SIZE;
    return fmi2OK;
}

DSE_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE) && dse_serialize(c, DSE_HERE, state, bytes, size));
}

DSE_EXPORT fmi2Status fmi2DeSerializeFMUstate(
    fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE) && dse_deserialize(c, DSE_HERE, bytes, size, state));
}

/* Optional functions of FMI 2.0 that this FMU does not support */

DSE_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[],
    size_t unknown_count, const fmi2ValueReference knowns[], size_t known_count, const fmi2Real seed[],
    fmi2Real sensitivity[]) {
    REFUSE(c, "directional derivatives are not provided");
}

DSE_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference references[],
    size_t count, const fmi2Integer order[], const fmi2Real values[]) {
    REFUSE(c, "inputs are held over a step; their derivatives are not used");
}

DSE_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference references[],
    size_t count, const fmi2Integer order[], fmi2Real values[]) {
    REFUSE(c, "output derivatives are not provided");
}

/* Steps never run in the background, so no status is ever pending: such requests return "discard". */
DSE_EXPORT fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    return fmi2Discard;
}

DSE_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    const struct dse_instance *instance = c;
    if (!instance || kind != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = instance->at.time;
    return fmi2OK;
}

DSE_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    return fmi2Discard;
}

DSE_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
#if defined DSE_MODEL || defined DSE_UDP
    if (c && kind == fmi2Terminated) {
        *value = DSE_HAS_ENDED(c);
        return fmi2OK;
    }
#endif
    return fmi2Discard;
}

DSE_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    return fmi2Discard;
}

#ifdef DSE_MODEL
#include "fmi2_exchange.h"
#endif
