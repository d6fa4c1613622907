/* An FMU around a handful of numbers, FMI 1.0, 2.0 or 3.0 as -DFMI says: every variable is value[reference], whatever
 * its type. The file that includes this one defines the model; the tests know its variables (conftest.py). */
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#if FMI == 1
#define JOINED(identifier, name) identifier##_fmi##name
#define PREFIXED(identifier, name) JOINED(identifier, name)
#define NAME(name) PREFIXED(IDENTIFIER, name)
typedef char Truth;
typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger log;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
} Callbacks;
#elif FMI == 2
#define NAME(name) fmi2##name
typedef int Truth;
typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger log;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;
#else
#define NAME(name) fmi3##name
typedef bool Truth;
typedef void (*Logger)(void *, int, const char *, const char *);
#endif

enum { OK, WARNING, DISCARD, ERROR, FATAL };

#ifdef MAY_ROLL_BACK
#define ACCEPTS(final) true
#else
#define ACCEPTS(final) (final)
#endif

typedef struct {
    double value[32];
    bool initializing, ended, early, event, uses_events, may_return_early;
    double reached; /* of an early return */
    double told;    /* the tolerance, 0 for none */
    void (*finished)(void *, int);
    void (*between)(void *, double, bool, bool, bool, bool, bool *, double *);
    Logger log;
    void *environment;
    void (*release)(void *);
} Model;

static void set_defaults(Model *m);               /* values of a new instance */
static int reset(Model *m);                       /* what fmiXReset does to a used one; returns a status */
static int initialize(Model *m);                  /* on leaving initialization mode, and before outputs are read in it */
static int step(Model *m, double time, double h); /* returns a status */

#ifdef OWN_WATCH
static int before_writing(Model *m, uint32_t reference); /* returns a status */
#else
static int before_writing(Model *m, uint32_t reference) { return (void)m, (void)reference, OK; }
#endif

static void say(Model *m, const char *text, int number)
{
#if FMI < 3
    m->log(m->environment, "instance", ERROR, "error", "%s %d\n", text, number);
#else
    (void)number;
    m->log(m->environment, ERROR, "error", text);
#endif
}

static int alive;
static const char *resources_told; /* to the instance that is made */

static Model *fresh(Model *m, Logger log, void *environment, const char *token)
{
    set_defaults(m);
    m->log = log;
#ifdef ASTRAY
    environment = (void *)(intptr_t)1; /* as FMUs do that pass their own handle on */
#endif
    m->environment = environment;
    if (strcmp(token, "the token") != 0) {
        say(m, "wrong token", 7);
        return NULL;
    }
#ifdef ONCE
    if (alive)
        return NULL;
#endif
    alive++;
    return m;
}

#if FMI == 1
EXPORT void *NAME(InstantiateSlave)(const char *name, const char *token, const char *location, const char *mime_type,
                                    double timeout, char visible, char interactive, Callbacks callbacks, char logging)
{
    (void)visible, (void)logging;
    if (!name || !mime_type || timeout != 0 || interactive || strncmp(location, "file://", 7) != 0)
        return NULL;
    resources_told = location;
    Model *m = callbacks.allocate(1, sizeof *m);
    m->release = callbacks.release;
    m->finished = callbacks.finished;
    if (fresh(m, callbacks.log, m, token))
        return m;
    callbacks.release(m);
    return NULL;
}
EXPORT int NAME(InitializeSlave)(void *m, double start, char has_stop, double stop)
{
    return start != 0 || !has_stop || stop <= 0 ? ERROR : initialize(m);
}
EXPORT int NAME(DoStep)(void *m, double time, double h, char is_new) { return is_new ? step(m, time, h) : ERROR; }
#elif FMI == 2
EXPORT void *fmi2Instantiate(const char *name, int type, const char *token, const char *resources,
                             const Callbacks *callbacks, int visible, int logging)
{
    (void)visible, (void)logging;
    if (!name || type != 1 || strncmp(resources, "file://", 7) != 0)
        return NULL;
    resources_told = resources;
    Model *m = callbacks->allocate(1, sizeof *m);
    m->release = callbacks->release;
    m->finished = callbacks->finished;
    if (fresh(m, callbacks->log, callbacks->environment, token))
        return m;
    callbacks->release(m);
    return NULL;
}
EXPORT int fmi2SetupExperiment(void *m, int has_tolerance, double tolerance, double start, int has_stop, double stop)
{
    ((Model *)m)->told = has_tolerance ? tolerance : 0.0;
    return start != 0 || !has_stop || stop <= 0 ? ERROR : OK;
}
EXPORT int fmi2EnterInitializationMode(void *m) { return ((Model *)m)->initializing = true, OK; }
EXPORT int fmi2DoStep(void *m, double time, double h, int final) { return ACCEPTS(final) ? step(m, time, h) : ERROR; }
#else
EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                         bool logging, bool events, bool early, const uint32_t *intermediate,
                                         size_t n_intermediate, void *environment, Logger log, void *update)
{
    (void)visible, (void)logging, (void)intermediate;
#if !defined(HAS_EVENTS) || defined(REFUSES_EVENTS)
    if (events || early)
        return NULL;
#endif
    if (!name || (n_intermediate && !update) || strchr("/\\", resources[strlen(resources) - 1]) == NULL)
        return NULL;
    resources_told = resources;
    Model *m = calloc(1, sizeof *m);
    m->release = free;
    m->uses_events = events;
    m->may_return_early = early;
    m->between = (void (*)(void *, double, bool, bool, bool, bool, bool *, double *))update;
    if (fresh(m, log, environment, token))
        return m;
    free(m);
    return NULL;
}
EXPORT int fmi3EnterInitializationMode(void *m, bool has_tolerance, double tolerance, double start, bool has_stop,
                                       double stop)
{
    ((Model *)m)->told = has_tolerance ? tolerance : 0.0;
    ((Model *)m)->initializing = true;
    return start != 0 || !has_stop || stop <= 0 ? ERROR : OK;
}
EXPORT int fmi3DoStep(void *m, double time, double h, bool final, bool *event, bool *ended, bool *early, double *reached)
{
    *reached = time + h;
    int status = ACCEPTS(final) ? step(m, time, h) : ERROR;
    *event = ((Model *)m)->event;
    *ended = ((Model *)m)->ended;
    *early = ((Model *)m)->early;
    if (*early && ((Model *)m)->may_return_early)
        *reached = ((Model *)m)->reached;
    return status;
}
#endif

#if FMI == 1
#define FREE_INSTANCE NAME(FreeSlaveInstance)
#define RESET NAME(ResetSlave)
#define TERMINATE NAME(TerminateSlave)
#else
#define FREE_INSTANCE NAME(FreeInstance)
#define RESET NAME(Reset)
#define TERMINATE NAME(Terminate)
#endif

EXPORT void FREE_INSTANCE(void *m)
{
    alive--;
    ((Model *)m)->release(m);
}
#if FMI > 1
EXPORT int NAME(ExitInitializationMode)(void *m)
{
    int status = initialize(m);
    ((Model *)m)->initializing = false;
    return status;
}
#endif

static int finish(Model *m);
#ifndef OWN_TERMINATE
static int finish(Model *m) { return (void)m, OK; }
#endif

EXPORT int RESET(void *m)
{
    ((Model *)m)->initializing = false;
    return reset(m);
}
EXPORT int TERMINATE(void *m) { return finish(m); }

#ifdef SAVES
#if FMI == 2
#define STATE(verb) fmi2##verb##FMUstate
#else
#define STATE(verb) fmi3##verb##FMUState
#endif
EXPORT int STATE(Get)(void *m, void **state)
{
    *state = *state ? *state : malloc(sizeof(Model));
    memcpy(*state, m, sizeof(Model));
    return OK;
}
EXPORT int STATE(Set)(void *m, void *state) { return memcpy(m, state, sizeof(Model)), OK; }
EXPORT int STATE(Free)(void *m, void **state)
{
    (void)m;
    free(*state);
    *state = NULL;
    return OK;
}
#endif

static int before_reading(Model *m) { return m->initializing ? initialize(m) : OK; }

#if FMI < 3
#define COUNT
#else
#define COUNT , size_t count
#endif
#define ACCESS(TYPE, C_TYPE)                                                                                         \
    EXPORT int NAME(Get##TYPE)(void *m, const uint32_t *reference, size_t n, C_TYPE *value COUNT)                    \
    {                                                                                                                \
        int status = before_reading(m);                                                                              \
        for (size_t i = 0; i < n; i++)                                                                               \
            value[i] = (C_TYPE)((Model *)m)->value[reference[i]];                                                    \
        return status;                                                                                               \
    }                                                                                                                \
    EXPORT int NAME(Set##TYPE)(void *m, const uint32_t *reference, size_t n, const C_TYPE *value COUNT)              \
    {                                                                                                                \
        for (size_t i = 0; i < n; i++) {                                                                             \
            if (before_writing(m, reference[i]) != OK)                                                               \
                return ERROR;                                                                                        \
            ((Model *)m)->value[reference[i]] = (double)value[i];                                                    \
        }                                                                                                            \
        return OK;                                                                                                   \
    }
#if FMI < 3
ACCESS(Real, double)
#ifndef NO_INTEGERS
ACCESS(Integer, int)
#endif
ACCESS(Boolean, Truth)
#else
ACCESS(Float64, double)
ACCESS(Float32, float)
ACCESS(Int8, int8_t)
ACCESS(UInt8, uint8_t)
ACCESS(Int16, int16_t)
ACCESS(UInt16, uint16_t)
#ifndef NO_INTEGERS
ACCESS(Int32, int32_t)
#endif
ACCESS(UInt32, uint32_t)
ACCESS(Int64, int64_t)
ACCESS(UInt64, uint64_t)
ACCESS(Boolean, Truth)
#endif
