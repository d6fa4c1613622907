/* An FMU around a handful of numbers, FMI 2.0 or 3.0 as -DFMI says: every variable is value[reference], whatever its
 * type. The file that includes this one defines the model; the tests know its variables (conftest.py). */
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

#if FMI == 2
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

typedef struct {
    double value[32];
    bool initializing, ended, early;
    Logger log;
    void *environment;
    void (*release)(void *);
} Model;

static void set_defaults(Model *m);               /* values of a new instance */
static int reset(Model *m);                       /* what fmiXReset does to a used one; returns a status */
static int initialize(Model *m);                  /* on leaving initialization mode, and before outputs are read in it */
static int step(Model *m, double time, double h); /* returns a status */

static void say(Model *m, const char *text, int number)
{
#if FMI == 2
    m->log(m->environment, "instance", ERROR, "error", "%s %d\n", text, number);
#else
    (void)number;
    m->log(m->environment, ERROR, "error", text);
#endif
}

static int alive;

static Model *fresh(Model *m, Logger log, void *environment, const char *token)
{
    set_defaults(m);
    m->log = log;
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

#if FMI == 2
EXPORT void *fmi2Instantiate(const char *name, int type, const char *token, const char *resources,
                             const Callbacks *callbacks, int visible, int logging)
{
    (void)visible, (void)logging;
    if (!name || type != 1 || strncmp(resources, "file://", 7) != 0)
        return NULL;
    Model *m = callbacks->allocate(1, sizeof *m);
    m->release = callbacks->release;
    if (fresh(m, callbacks->log, callbacks->environment, token))
        return m;
    callbacks->release(m);
    return NULL;
}
EXPORT int fmi2SetupExperiment(void *m, int has_tolerance, double tolerance, double start, int has_stop, double stop)
{
    (void)m, (void)tolerance;
    return has_tolerance || start != 0 || !has_stop || stop <= 0 ? ERROR : OK;
}
EXPORT int fmi2EnterInitializationMode(void *m) { return ((Model *)m)->initializing = true, OK; }
EXPORT int fmi2DoStep(void *m, double time, double h, int final) { return final ? step(m, time, h) : ERROR; }
#else
EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                         bool logging, bool events, bool early, const uint32_t *intermediate,
                                         size_t n_intermediate, void *environment, Logger log, void *update)
{
    (void)visible, (void)logging, (void)intermediate, (void)update;
    if (!name || events || early || n_intermediate || strchr("/\\", resources[strlen(resources) - 1]) == NULL)
        return NULL;
    Model *m = calloc(1, sizeof *m);
    m->release = free;
    if (fresh(m, log, environment, token))
        return m;
    free(m);
    return NULL;
}
EXPORT int fmi3EnterInitializationMode(void *m, bool has_tolerance, double tolerance, double start, bool has_stop,
                                       double stop)
{
    (void)tolerance;
    ((Model *)m)->initializing = true;
    return has_tolerance || start != 0 || !has_stop || stop <= 0 ? ERROR : OK;
}
EXPORT int fmi3DoStep(void *m, double time, double h, bool final, bool *event, bool *ended, bool *early, double *reached)
{
    *reached = time + h;
    int status = final ? step(m, time, h) : ERROR;
    *event = false;
    *ended = ((Model *)m)->ended;
    *early = ((Model *)m)->early;
    return status;
}
#endif

EXPORT void NAME(FreeInstance)(void *m)
{
    alive--;
    ((Model *)m)->release(m);
}
EXPORT int NAME(ExitInitializationMode)(void *m)
{
    int status = initialize(m);
    ((Model *)m)->initializing = false;
    return status;
}

static int finish(Model *m);
#ifndef OWN_TERMINATE
static int finish(Model *m) { return (void)m, OK; }
#endif

EXPORT int NAME(Reset)(void *m)
{
    ((Model *)m)->initializing = false;
    return reset(m);
}
EXPORT int NAME(Terminate)(void *m) { return finish(m); }

static int before_reading(Model *m) { return m->initializing ? initialize(m) : OK; }

#if FMI == 2
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
        for (size_t i = 0; i < n; i++)                                                                               \
            ((Model *)m)->value[reference[i]] = (double)value[i];                                                    \
        return OK;                                                                                                   \
    }
#if FMI == 2
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
