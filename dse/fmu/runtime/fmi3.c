/* The functions of FMI 3.0 over one component. Those of model exchange are in fmi3_exchange.h; those that are refused
 * are in fmi3_refused.h. */
#define _POSIX_C_SOURCE 200809L /* for partner.h and udp.h, if included */
#include "fmi3_abi.h"
#include "model.h"
/* In FMI 3.0 time is a variable; it follows the component's own. */
#define DSE_TIME DSE_SLOT_COUNT
#ifdef DSE_HAS_ARRAYS
#define DSE_ARRAYS
#endif
#include "value.h"

/* Functions that only refuse do not use their arguments. */
#pragma GCC diagnostic ignored "-Wunused-parameter"

#define STATUS(is_ok) ((is_ok) ? fmi3OK : fmi3Error)
#define REFUSE(instance, reason)                                                                                       \
    do {                                                                                                               \
        if (instance) {                                                                                                \
            dse_refuse(instance, DSE_HERE, reason);                                                                    \
        }                                                                                                              \
        return fmi3Error;                                                                                              \
    } while (0)

static void tell(struct dse_instance *instance, int is_warning, const char *message) {
    const fmi3Logger logger = (fmi3Logger)instance->callback;
    if (logger && is_warning) {
        logger(instance->environment, fmi3Warning, "logStatusWarning", message);
    } else if (logger) {
        logger(instance->environment, fmi3Error, "logStatusError", message);
    }
}

#define REFUSED(name, reason, ...)                                                                                     \
    DSE_EXPORT fmi3Status name(fmi3Instance c, __VA_ARGS__) { REFUSE(c, reason); }
#define REFUSED_PLAIN(name, reason)                                                                                    \
    DSE_EXPORT fmi3Status name(fmi3Instance c) { REFUSE(c, reason); }

/* NULL after reporting why, if *reason* is given or the token is not that of this FMU. */
static fmi3Instance create(
    const char *function, fmi3String name, fmi3String token, void *environment, fmi3Logger logger, const char *reason) {
    struct dse_instance *instance = dse_create(name ? name : "");
    if (!instance) {
        return NULL;
    }
    instance->tell = tell;
    instance->callback = (void (*)(void))logger;
    instance->environment = environment;
    if (!reason && (!name || !*name)) {
        reason = "the instance has no name";
    }
    if (!reason && (!token || strcmp(token, DSE_TOKEN) != 0)) {
        reason = "the instantiation token is not that of this FMU; modelDescription.xml and library belong to "
                 "different builds";
    }
    if (reason) {
        dse_refuse(instance, function, "%s", reason);
        dse_destroy(instance);
        return NULL;
    }
    return instance;
}

DSE_EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

/* Errors are always logged; there is nothing else to log. */
DSE_EXPORT fmi3Status fmi3SetDebugLogging(
    fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[]) {
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE));
}

/* Life */

DSE_EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
    fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean has_event_mode, fmi3Boolean may_return_early,
    const fmi3ValueReference intermediate[], size_t intermediate_count, void *environment, fmi3Logger logger,
    fmi3IntermediateUpdate update) {
    return create(
        DSE_HERE, name, token, environment, logger, has_event_mode ? "there is no event mode in this FMU" : NULL);
}

DSE_EXPORT void fmi3FreeInstance(fmi3Instance c) { dse_destroy(c); }

DSE_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
    fmi3Float64 start_time, fmi3Boolean has_stop_time, fmi3Float64 stop_time) {
    if (!dse_is_allowed(c, DSE_HERE, DSE_INSTANTIATED)
        || !dse_set_up(c, DSE_HERE, start_time, has_tolerance ? tolerance : 0.0)) {
        return fmi3Error;
    }
    dse_enter_initialization(c);
    return fmi3OK;
}

DSE_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    if (!dse_is_allowed(c, DSE_HERE, DSE_INITIALIZING)) {
        return fmi3Error;
    }
    return STATUS(dse_exit_initialization(c, DSE_HERE));
}

DSE_EXPORT fmi3Status fmi3Terminate(fmi3Instance c) {
    struct dse_instance *instance = c;
    if (!dse_is_allowed(instance, DSE_HERE, DSE_STEPPING)) {
        return fmi3Error;
    }
    dse_end_session(instance);
    instance->at.state = DSE_TERMINATED;
    return fmi3OK;
}

DSE_EXPORT fmi3Status fmi3Reset(fmi3Instance c) {
    if (!dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE)) {
        return fmi3Error;
    }
    dse_rewind(c);
    return fmi3OK;
}

DSE_EXPORT fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean never_back,
    fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last_time) {
    const struct dse_instance *instance = c;
    const bool is_ok = dse_do_step(c, DSE_HERE, time, step);
    *event = *terminate = *early = false;
    if (instance) {
        *last_time = instance->at.time;
        *terminate = !is_ok && DSE_HAS_ENDED(instance);
    }
    return STATUS(is_ok || *terminate);
}

/* Values */

DSE_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference references[], size_t count,
    fmi3Float64 values[], size_t value_count) {
    return STATUS(dse_get_reals(c, DSE_HERE, references, count, values));
}

DSE_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference references[], size_t count,
    const fmi3Float64 values[], size_t value_count) {
    return STATUS(dse_set_reals(c, DSE_HERE, references, count, values));
}

/* *kinds* are those whose variables the description declares with this type. */
#define WHOLE(name, type, kinds, lowest, highest)                                                                      \
    DSE_EXPORT fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference references[], size_t count,           \
        type values[], size_t value_count) {                                                                           \
        bool is_ok = dse_begin_get(c, DSE_HERE);                                                                       \
        for (size_t k = 0; is_ok && k < count; k++) {                                                                  \
            const uint32_t end = references[k] + DSE_COUNT(references[k]);                                             \
            for (uint32_t reference = references[k]; is_ok && reference != end; reference++) {                         \
                int64_t value = 0;                                                                                     \
                is_ok = dse_get_whole(c, DSE_HERE, reference, kinds, lowest, highest, &value);                         \
                *values++ = (type)value;                                                                               \
            }                                                                                                          \
        }                                                                                                              \
        return STATUS(is_ok);                                                                                          \
    }                                                                                                                  \
    DSE_EXPORT fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference references[], size_t count,           \
        const type values[], size_t value_count) {                                                                     \
        bool is_ok = dse_begin_set(c, DSE_HERE);                                                                       \
        for (size_t k = 0; is_ok && k < count; k++) {                                                                  \
            const uint32_t end = references[k] + DSE_COUNT(references[k]);                                             \
            for (uint32_t reference = references[k]; is_ok && reference != end; reference++) {                         \
                is_ok = dse_set_whole(c, DSE_HERE, reference, kinds, (int64_t)*values++);                              \
            }                                                                                                          \
        }                                                                                                              \
        return STATUS(is_ok);                                                                                          \
    }

WHOLE(Int32, fmi3Int32, DSE_INTEGER, INT32_MIN, INT32_MAX)
WHOLE(Int64, fmi3Int64, DSE_ENUMERATION, INT64_MIN, INT64_MAX)
WHOLE(Boolean, fmi3Boolean, DSE_BOOLEAN, INT64_MIN, INT64_MAX)

#ifdef DSE_HAS_TEXTS
#include "c_component_texts.h"

/* *action* for each value, called *reference* and counted by *at*. */
#define EACH_TEXT(begin, action)                                                                                       \
    bool is_ok = begin(c, DSE_HERE);                                                                                   \
    size_t at = 0;                                                                                                     \
    for (size_t k = 0; is_ok && k < count; k++) {                                                                      \
        const uint32_t end = references[k] + DSE_COUNT(references[k]);                                                 \
        for (uint32_t reference = references[k]; is_ok && reference != end; reference++, at++) {                       \
            is_ok = action;                                                                                            \
        }                                                                                                              \
    }                                                                                                                  \
    return STATUS(is_ok)

DSE_EXPORT fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference references[], size_t count,
    fmi3String values[], size_t value_count) {
    EACH_TEXT(dse_begin_get, dse_get_text(c, DSE_HERE, reference, &values[at]));
}

DSE_EXPORT fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference references[], size_t count,
    const fmi3String values[], size_t value_count) {
    EACH_TEXT(dse_begin_set, dse_set_text(c, DSE_HERE, reference, values[at]));
}

DSE_EXPORT fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference references[], size_t count,
    size_t sizes[], fmi3Binary values[], size_t value_count) {
    EACH_TEXT(dse_begin_get, dse_get_bytes(c, DSE_HERE, reference, &values[at], &sizes[at]));
}

DSE_EXPORT fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference references[], size_t count,
    const size_t sizes[], const fmi3Binary values[], size_t value_count) {
    EACH_TEXT(dse_begin_set, dse_set_bytes(c, DSE_HERE, reference, values[at], sizes[at]));
}
#endif

/* For accessors of types without variables: an access reports the variable's type. */
static bool has_none(struct dse_instance *instance, const char *function, const uint32_t references[], size_t count) {
    return dse_is_allowed(instance, function, DSE_ANY_STATE)
           && (count == 0 || dse_find(instance, function, references[0], 0));
}

#define ABSENT(name, type)                                                                                             \
    DSE_EXPORT fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference references[], size_t count,           \
        type values[], size_t value_count) {                                                                           \
        return STATUS(has_none(c, DSE_HERE, references, count));                                                       \
    }                                                                                                                  \
    DSE_EXPORT fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference references[], size_t count,           \
        const type values[], size_t value_count) {                                                                     \
        return STATUS(has_none(c, DSE_HERE, references, count));                                                       \
    }

ABSENT(Float32, fmi3Float32)
ABSENT(Int8, fmi3Int8)
ABSENT(UInt8, fmi3UInt8)
ABSENT(Int16, fmi3Int16)
ABSENT(UInt16, fmi3UInt16)
ABSENT(UInt32, fmi3UInt32)
ABSENT(UInt64, fmi3UInt64)

/* Saved states */

DSE_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) {
    struct dse_instance *instance = c;
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE) && dse_keep(c, DSE_HERE, &instance->at, state));
}

DSE_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE) && dse_restore(c, DSE_HERE, state));
}

DSE_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    free(*state);
    *state = NULL;
    return fmi3OK;
}

DSE_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size) {
    *size = DSE_SERIALIZED_SIZE;
    return fmi3OK;
}

DSE_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE) && dse_serialize(c, DSE_HERE, state, bytes, size));
}

DSE_EXPORT fmi3Status fmi3DeserializeFMUState(
    fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    return STATUS(dse_is_allowed(c, DSE_HERE, DSE_ANY_STATE) && dse_deserialize(c, DSE_HERE, bytes, size, state));
}

#ifdef DSE_MODEL
#include "fmi3_exchange.h"
#endif
#include "fmi3_refused.h"
