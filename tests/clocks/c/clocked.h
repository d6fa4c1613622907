/* An FMI 3.0 co-simulation FMU with clocks that takes the standard at its word: a call in the wrong mode, or a clocked
 * variable that is touched while none of its clocks ticks, is an error. A model defines what is declared here. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { OK, WARNING, DISCARD, ERROR };
enum { NOT_YET_KNOWN, UNCHANGED, CHANGED };
enum { CREATED, INITIALIZING, EVENTS, STEPS, ENDED };
enum { MOST_BYTES = 2048, MOST_NUMBERS = 32 };

typedef struct {
    size_t size;
    uint8_t bytes[MOST_BYTES];
} Message;

typedef struct Model Model;

typedef struct {
    int mode;
    double time;
    uint32_t active;              /* clocks that tick, one bit for each reference */
    double numbers[MOST_NUMBERS]; /* by reference */
    void *environment;
    void (*log)(void *, int, const char *, const char *);
} Common;

static size_t model_size(void);
static void begin(Model *m);                       /* parameters are set, initialization ends */
static uint32_t clocks_of(uint32_t reference);     /* of a variable, as bits */
static double number(Model *m, uint32_t reference);
static void take(Model *m, uint32_t reference, double value);
static Message *message(Model *m, uint32_t reference); /* to be read or written */
static bool polled(Model *m, uint32_t clock);
static void ticked(Model *m, uint32_t clock);
static int interval(Model *m, uint32_t clock, double *numerator, double *denominator);
static double go(Model *m, double end, bool *has_event); /* how far it gets */
static bool update(Model *m, bool *ends, double *next);   /* whether again */

#define COMMON(m) ((Common *)(m))

static int wrong(Model *m, const char *what, uint32_t reference) {
    char line[200];
    snprintf(line, sizeof line, "%s of %u in mode %d, ticking %x", what, reference, COMMON(m)->mode, COMMON(m)->active);
    if (COMMON(m)->log)
        COMMON(m)->log(COMMON(m)->environment, ERROR, "error", line);
    return ERROR;
}

/* Whether a variable may be touched now. */
static bool may(Model *m, uint32_t reference) {
    const uint32_t clocks = clocks_of(reference);
    const int mode = COMMON(m)->mode;
    return !clocks || mode <= INITIALIZING || (mode == EVENTS && (COMMON(m)->active & clocks));
}

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
        bool logging, bool events, bool early, const uint32_t *between, size_t n_between, void *environment,
        void (*log)(void *, int, const char *, const char *), void *update_between) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)between, (void)n_between;
    (void)update_between;
    Model *m = events ? calloc(1, model_size()) : NULL;
    if (m) {
        COMMON(m)->environment = environment;
        COMMON(m)->log = log;
        COMMON(m)->numbers[1] = early; /* no variable has it */
    }
    return m;
}

EXPORT void fmi3FreeInstance(void *m) { free(m); }
EXPORT int fmi3Terminate(void *m) { COMMON(m)->mode = ENDED; return OK; }

EXPORT int fmi3Reset(void *m) {
    Common kept = *COMMON(m);
    memset(m, 0, model_size());
    COMMON(m)->environment = kept.environment;
    COMMON(m)->log = kept.log;
    COMMON(m)->numbers[1] = kept.numbers[1];
    return OK;
}

EXPORT int fmi3EnterInitializationMode(void *m, bool t, double tol, double start, bool s, double stop) {
    (void)t, (void)tol, (void)start, (void)s, (void)stop;
    if (COMMON(m)->mode != CREATED)
        return wrong(m, "fmi3EnterInitializationMode", 0);
    COMMON(m)->mode = INITIALIZING;
    begin(m);
    return OK;
}

static int pass(Model *m, int from, int to, const char *what) {
    if (COMMON(m)->mode != from)
        return wrong(m, what, 0);
    COMMON(m)->mode = to;
    return OK;
}

EXPORT int fmi3ExitInitializationMode(void *m) { return pass(m, INITIALIZING, EVENTS, "fmi3ExitInitializationMode"); }
EXPORT int fmi3EnterEventMode(void *m) { return pass(m, STEPS, EVENTS, "fmi3EnterEventMode"); }
EXPORT int fmi3EnterStepMode(void *m) { return pass(m, EVENTS, STEPS, "fmi3EnterStepMode"); }

EXPORT int fmi3GetFloat64(void *m, const uint32_t *r, size_t n, double *values, size_t k) {
    (void)k;
    for (size_t i = 0; i < n; i++) {
        if (!may(m, r[i]))
            return wrong(m, "fmi3GetFloat64", r[i]);
        values[i] = r[i] ? number(m, r[i]) : COMMON(m)->time;
    }
    return OK;
}

EXPORT int fmi3SetFloat64(void *m, const uint32_t *r, size_t n, const double *values, size_t k) {
    (void)k;
    for (size_t i = 0; i < n; i++) {
        if (!may(m, r[i]))
            return wrong(m, "fmi3SetFloat64", r[i]);
        take(m, r[i], values[i]);
    }
    return OK;
}

EXPORT int fmi3GetBinary(void *m, const uint32_t *r, size_t n, size_t *sizes, const uint8_t **values, size_t k) {
    (void)k;
    for (size_t i = 0; i < n; i++) {
        const Message *found = message(m, r[i]);
        if (!found || !may(m, r[i]))
            return wrong(m, "fmi3GetBinary", r[i]);
        sizes[i] = found->size;
        values[i] = found->bytes;
    }
    return OK;
}

EXPORT int fmi3SetBinary(void *m, const uint32_t *r, size_t n, const size_t *sizes, const uint8_t **values, size_t k) {
    (void)k;
    for (size_t i = 0; i < n; i++) {
        Message *found = message(m, r[i]);
        if (!found || !may(m, r[i]) || sizes[i] > MOST_BYTES)
            return wrong(m, "fmi3SetBinary", r[i]);
        found->size = sizes[i];
        memcpy(found->bytes, values[i], sizes[i]);
    }
    return OK;
}

/* An output clock says only once that it ticks. */
EXPORT int fmi3GetClock(void *m, const uint32_t *r, size_t n, bool *values) {
    if (COMMON(m)->mode != EVENTS)
        return wrong(m, "fmi3GetClock", *r);
    for (size_t i = 0; i < n; i++) {
        values[i] = !(COMMON(m)->active & 1u << r[i]) && polled(m, r[i]);
        COMMON(m)->active |= (uint32_t)values[i] << r[i];
    }
    return OK;
}

EXPORT int fmi3SetClock(void *m, const uint32_t *r, size_t n, const bool *values) {
    for (size_t i = 0; i < n; i++) {
        if (COMMON(m)->mode != EVENTS || !values[i] || COMMON(m)->active & 1u << r[i])
            return wrong(m, "fmi3SetClock", r[i]);
        COMMON(m)->active |= 1u << r[i];
        ticked(m, r[i]);
    }
    return OK;
}

/* What is not new is not told: the number may be anything. */
EXPORT int fmi3GetIntervalDecimal(void *m, const uint32_t *r, size_t n, double *intervals, int *qualifiers) {
    for (size_t i = 0; i < n; i++) {
        double numerator = 0.0, denominator = 1.0;
        if (COMMON(m)->mode != INITIALIZING && COMMON(m)->mode != EVENTS)
            return wrong(m, "fmi3GetIntervalDecimal", r[i]);
        qualifiers[i] = interval(m, r[i], &numerator, &denominator);
        intervals[i] = qualifiers[i] == CHANGED ? numerator / denominator : -99.0;
    }
    return OK;
}

EXPORT int fmi3GetIntervalFraction(void *m, const uint32_t *r, size_t n, uint64_t *counters, uint64_t *resolutions,
        int *qualifiers) {
    for (size_t i = 0; i < n; i++) {
        double numerator = 0.0, denominator = 1.0;
        if (COMMON(m)->mode != INITIALIZING && COMMON(m)->mode != EVENTS)
            return wrong(m, "fmi3GetIntervalFraction", r[i]);
        qualifiers[i] = interval(m, r[i], &numerator, &denominator);
        counters[i] = (uint64_t)numerator;
        resolutions[i] = (uint64_t)denominator;
    }
    return OK;
}

#define SHIFT 22 /* the parameter, in the same parts of a second as the interval */
#define PARTS 26
#define HASTY 31 /* says that it returns early with an event at the end of a step, too */

EXPORT int fmi3GetShiftDecimal(void *m, const uint32_t *r, size_t n, double *shifts) {
    for (size_t i = 0; i < n; i++) {
        if (COMMON(m)->mode != INITIALIZING)
            return wrong(m, "fmi3GetShiftDecimal", r[i]);
        shifts[i] = COMMON(m)->numbers[SHIFT] / COMMON(m)->numbers[PARTS];
    }
    return OK;
}

EXPORT int fmi3GetShiftFraction(void *m, const uint32_t *r, size_t n, uint64_t *counters, uint64_t *resolutions) {
    for (size_t i = 0; i < n; i++) {
        if (COMMON(m)->mode != INITIALIZING)
            return wrong(m, "fmi3GetShiftFraction", r[i]);
        counters[i] = (uint64_t)COMMON(m)->numbers[SHIFT];
        resolutions[i] = (uint64_t)COMMON(m)->numbers[PARTS];
    }
    return OK;
}

EXPORT int fmi3UpdateDiscreteStates(void *m, bool *again, bool *ends, bool *nominals, bool *values, bool *has_next,
        double *next) {
    if (COMMON(m)->mode != EVENTS)
        return wrong(m, "fmi3UpdateDiscreteStates", 0);
    *ends = *nominals = *values = false;
    *next = INFINITY;
    *again = update(m, ends, next);
    *has_next = isfinite(*next);
    COMMON(m)->active = 0;
    return OK;
}

EXPORT int fmi3DoStep(void *m, double time, double step, bool no_rollback, bool *has_event, bool *ends, bool *early,
        double *reached) {
    (void)no_rollback;
    if (COMMON(m)->mode != STEPS || !(step > 0.0) || fabs(time - COMMON(m)->time) > 1e-12)
        return wrong(m, "fmi3DoStep", 0);
    *has_event = *ends = false;
    *reached = COMMON(m)->time = go(m, time + step, has_event);
    *early = *reached < time + step || (*has_event && COMMON(m)->numbers[HASTY]);
    return OK;
}

/* FMPy looks for all functions. */
#define NONE(name) EXPORT int name(void) { return ERROR; }
NONE(fmi3ActivateModelPartition) NONE(fmi3CompletedIntegratorStep) NONE(fmi3DeserializeFMUState)
NONE(fmi3EnterConfigurationMode) NONE(fmi3EnterContinuousTimeMode) NONE(fmi3EvaluateDiscreteStates)
NONE(fmi3ExitConfigurationMode) NONE(fmi3FreeFMUState) NONE(fmi3GetAdjointDerivative) NONE(fmi3GetBoolean)
NONE(fmi3GetContinuousStateDerivatives) NONE(fmi3GetContinuousStates) NONE(fmi3GetDirectionalDerivative)
NONE(fmi3GetEventIndicators) NONE(fmi3GetFMUState) NONE(fmi3GetFloat32) NONE(fmi3GetInt16) NONE(fmi3GetInt32)
NONE(fmi3GetInt64) NONE(fmi3GetInt8) NONE(fmi3GetNominalsOfContinuousStates) NONE(fmi3GetNumberOfContinuousStates)
NONE(fmi3GetNumberOfEventIndicators) NONE(fmi3GetNumberOfVariableDependencies) NONE(fmi3GetOutputDerivatives)
NONE(fmi3GetString) NONE(fmi3GetUInt16) NONE(fmi3GetUInt32) NONE(fmi3GetUInt64) NONE(fmi3GetUInt8)
NONE(fmi3GetVariableDependencies) NONE(fmi3InstantiateModelExchange) NONE(fmi3InstantiateScheduledExecution)
NONE(fmi3SerializeFMUState) NONE(fmi3SerializedFMUStateSize) NONE(fmi3SetBoolean) NONE(fmi3SetContinuousStates)
NONE(fmi3SetDebugLogging) NONE(fmi3SetFMUState) NONE(fmi3SetFloat32) NONE(fmi3SetInt16) NONE(fmi3SetInt32)
NONE(fmi3SetInt64) NONE(fmi3SetInt8) NONE(fmi3SetIntervalDecimal) NONE(fmi3SetIntervalFraction)
NONE(fmi3SetShiftDecimal) NONE(fmi3SetShiftFraction) NONE(fmi3SetString) NONE(fmi3SetTime) NONE(fmi3SetUInt16)
NONE(fmi3SetUInt32) NONE(fmi3SetUInt64) NONE(fmi3SetUInt8)
