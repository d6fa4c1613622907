/* A small model as an FMU for model exchange, FMI 2.0 or 3.0. A model defines STATES, INDICATORS, REALS and WHOLES,
 * then includes this and writes derive, indicate, update and start. Reals 0 … STATES-1 are the states, the next
 * STATES their derivatives. Strict about modes: what FMI forbids is an error that says so. */
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROOM(COUNT) ((COUNT) > 0 ? (COUNT) : 1)
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT
#endif

enum { OK, WARNING, DISCARD, ERROR };
enum { MADE, INITIALIZING, EVENTS, CONTINUOUS, ENDED };

typedef struct {
    int again, terminate, nominals_changed, states_changed, has_next;
    double next;
} News;

typedef struct {
    double time, reals[ROOM(REALS)], nominals[ROOM(STATES)];
    int32_t wholes[ROOM(WHOLES)];
    int mode;
    int completed, wants_event, wants_end; /* set by *completed* of a model */
    double last_completed, told; /* the tolerance, 0 for none */
    void *environment, *log;
} Model;

static int derive(Model *m);                            /* derivatives from time, states and inputs: a status */
static void indicate(const Model *m, double *indicators);
static void update(Model *m, News *news);               /* one pass of the event iteration */
static void start(Model *m);                            /* values of a new instance */

#ifdef DIRECTIONAL
static int directional(Model *m, const double *seed, double *sensitivity);
#endif

#ifndef COMPLETED
#define COMPLETED(m)
#endif
#ifndef COUNTED_STATES
#define COUNTED_STATES STATES
#endif

static void say(Model *m, const char *text)
{
#if FMI == 2
    ((void (*)(void *, const char *, int, const char *, const char *, ...))m->log)(m->environment, "", ERROR, "", text);
#else
    ((void (*)(void *, int, const char *, const char *))m->log)(m->environment, ERROR, "", text);
#endif
}

static int wrong(Model *m, const char *text)
{
    say(m, text);
    return ERROR;
}

#define NEEDS(WHEN, TEXT) \
    if (!(WHEN)) return wrong(m, TEXT)

static Model *made(void *environment, void *log)
{
    Model *m = calloc(1, sizeof *m);
    m->environment = environment;
    m->log = log;
    for (int k = 0; k < STATES; k++)
        m->nominals[k] = 1.0;
    start(m);
    return m;
}

static int reset(Model *m)
{
    void *environment = m->environment, *log = m->log;
    memset(m, 0, sizeof *m);
    m->environment = environment, m->log = log;
    for (int k = 0; k < STATES; k++)
        m->nominals[k] = 1.0;
    start(m);
    return OK;
}

static int get_reals(Model *m, const uint32_t *references, size_t count, double *values)
{
    if (m->mode != MADE && derive(m) > WARNING)
        return DISCARD;
    for (size_t i = 0; i < count; i++)
        values[i] = m->reals[references[i]];
    return OK;
}

static int set_reals(Model *m, const uint32_t *references, size_t count, const double *values)
{
    for (size_t i = 0; i < count; i++)
        m->reals[references[i]] = values[i];
    return OK;
}

static int set_wholes(Model *m, const uint32_t *references, size_t count, const int32_t *values)
{
    NEEDS(m->mode != CONTINUOUS, "a discrete variable is set outside event mode");
    for (size_t i = 0; i < count; i++)
        m->wholes[references[i]] = values[i];
    return OK;
}

static int get_wholes(Model *m, const uint32_t *references, size_t count, int32_t *values)
{
    for (size_t i = 0; i < count; i++)
        values[i] = m->wholes[references[i]];
    return OK;
}

static int set_mode(Model *m, int from, int to, const char *text)
{
    NEEDS(m->mode == from, text);
    m->mode = to;
    return OK;
}

static int set_time(Model *m, double time)
{
    NEEDS(m->mode == EVENTS || m->mode == CONTINUOUS, "time is set in a wrong mode");
    NEEDS(time >= m->last_completed - 1e-9, "time goes back behind a completed step");
    m->time = time;
    return OK;
}

static int set_states(Model *m, const double *states, size_t count)
{
    NEEDS(m->mode == CONTINUOUS, "states are set outside continuous-time mode");
    NEEDS(count == STATES && count > 0, "a wrong number of states");
    memcpy(m->reals, states, count * sizeof *states);
    return OK;
}

static int get_states(Model *m, double *states, size_t count)
{
    NEEDS(m->mode != MADE, "states are read too early");
    NEEDS(count == STATES, "a wrong number of states");
    memcpy(states, m->reals, count * sizeof *states);
    return OK;
}

static int get_derivatives(Model *m, double *slope, size_t count)
{
    NEEDS(m->mode != MADE && count == STATES, "derivatives are read too early, or a wrong number of them");
    const int status = derive(m);
    memcpy(slope, m->reals + STATES, count * sizeof *slope);
    return status;
}

static int get_indicators(Model *m, double *indicators, size_t count)
{
    NEEDS(m->mode != MADE && count == INDICATORS, "indicators are read too early, or a wrong number of them");
    indicate(m, indicators);
    return OK;
}

static int get_nominals(Model *m, double *nominals, size_t count)
{
    NEEDS(count == STATES, "a wrong number of nominals");
    memcpy(nominals, m->nominals, count * sizeof *nominals);
    return OK;
}

static int news_of(Model *m, News *news)
{
    NEEDS(m->mode == EVENTS, "the event iteration outside event mode");
    memset(news, 0, sizeof *news);
    update(m, news);
    return OK;
}

static int completed_step(Model *m)
{
    NEEDS(m->mode == CONTINUOUS, "a step is completed outside continuous-time mode");
    m->completed++;
    m->last_completed = m->time;
    m->wants_event = m->wants_end = 0;
    COMPLETED(m);
    return OK;
}

static int get_state(Model *m, void **kept)
{
    if (!*kept)
        *kept = malloc(sizeof *m);
    memcpy(*kept, m, sizeof *m);
    return OK;
}

static int set_state(Model *m, void *kept)
{
    memcpy(m, kept, sizeof *m);
    return OK;
}

static int free_state(void **kept)
{
    free(*kept);
    *kept = NULL;
    return OK;
}

#if FMI == 2

typedef struct {
    void *log, *allocate, *release, *step_finished, *environment;
} Callbacks;

EXPORT void *fmi2Instantiate(const char *name, int type, const char *token, const char *resources,
                             const Callbacks *calls, int visible, int logging)
{
    return type == 0 ? made(calls->environment, calls->log) : NULL;
}
EXPORT void fmi2FreeInstance(Model *m) { free(m); }
EXPORT int fmi2Reset(Model *m) { return reset(m); }
EXPORT int fmi2SetupExperiment(Model *m, int has_tolerance, double tolerance, double from, int has_stop, double stop)
{
    m->told = has_tolerance ? tolerance : 0.0;
    m->time = m->last_completed = from;
    return OK;
}
EXPORT int fmi2EnterInitializationMode(Model *m) { return set_mode(m, MADE, INITIALIZING, "initialized twice"); }
EXPORT int fmi2ExitInitializationMode(Model *m) { return set_mode(m, INITIALIZING, EVENTS, "not initializing"); }
EXPORT int fmi2Terminate(Model *m) { m->mode = ENDED; return OK; }
EXPORT int fmi2EnterEventMode(Model *m)
{
    return set_mode(m, CONTINUOUS, EVENTS, "event mode is entered from a wrong mode");
}
EXPORT int fmi2EnterContinuousTimeMode(Model *m)
{
    return set_mode(m, EVENTS, CONTINUOUS, "continuous-time mode is entered from a wrong mode");
}
EXPORT int fmi2NewDiscreteStates(Model *m, News *news) { return news_of(m, news); }
EXPORT int fmi2CompletedIntegratorStep(Model *m, int never_back, int *event, int *end)
{
    const int status = completed_step(m);
    *event = m->wants_event, *end = m->wants_end;
    return status;
}
EXPORT int fmi2SetTime(Model *m, double time) { return set_time(m, time); }
EXPORT int fmi2SetContinuousStates(Model *m, const double *x, size_t n) { return set_states(m, x, n); }
EXPORT int fmi2GetContinuousStates(Model *m, double *x, size_t n) { return get_states(m, x, n); }
EXPORT int fmi2GetDerivatives(Model *m, double *x, size_t n) { return get_derivatives(m, x, n); }
EXPORT int fmi2GetEventIndicators(Model *m, double *z, size_t n) { return get_indicators(m, z, n); }
EXPORT int fmi2GetNominalsOfContinuousStates(Model *m, double *x, size_t n) { return get_nominals(m, x, n); }
EXPORT int fmi2GetReal(Model *m, const uint32_t *r, size_t n, double *v) { return get_reals(m, r, n, v); }
EXPORT int fmi2SetReal(Model *m, const uint32_t *r, size_t n, const double *v) { return set_reals(m, r, n, v); }
EXPORT int fmi2GetInteger(Model *m, const uint32_t *r, size_t n, int32_t *v) { return get_wholes(m, r, n, v); }
EXPORT int fmi2SetInteger(Model *m, const uint32_t *r, size_t n, const int32_t *v) { return set_wholes(m, r, n, v); }
EXPORT int fmi2GetFMUstate(Model *m, void **kept) { return get_state(m, kept); }
EXPORT int fmi2SetFMUstate(Model *m, void *kept) { return set_state(m, kept); }
EXPORT int fmi2FreeFMUstate(Model *m, void **kept) { return free_state(kept); }
#ifdef DIRECTIONAL
EXPORT int fmi2GetDirectionalDerivative(Model *m, const uint32_t *unknowns, size_t n_unknowns, const uint32_t *knowns,
                                 size_t n_knowns, const double *seed, double *sensitivity)
{
    return directional(m, seed, sensitivity);
}
#endif

#else

EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *resources, bool visible,
                                   bool logging, void *environment, void *log)
{
    return made(environment, log);
}
EXPORT void fmi3FreeInstance(Model *m) { free(m); }
EXPORT int fmi3Reset(Model *m) { return reset(m); }
EXPORT int fmi3EnterInitializationMode(Model *m, bool has_tolerance, double tolerance, double from, bool has_stop,
                                       double stop)
{
    m->told = has_tolerance ? tolerance : 0.0;
    m->time = m->last_completed = from;
    return set_mode(m, MADE, INITIALIZING, "initialized twice");
}
EXPORT int fmi3ExitInitializationMode(Model *m) { return set_mode(m, INITIALIZING, EVENTS, "not initializing"); }
EXPORT int fmi3Terminate(Model *m) { m->mode = ENDED; return OK; }
EXPORT int fmi3EnterEventMode(Model *m)
{
    return set_mode(m, CONTINUOUS, EVENTS, "event mode is entered from a wrong mode");
}
EXPORT int fmi3EnterContinuousTimeMode(Model *m)
{
    return set_mode(m, EVENTS, CONTINUOUS, "continuous-time mode is entered from a wrong mode");
}
EXPORT int fmi3UpdateDiscreteStates(Model *m, bool *again, bool *end, bool *nominals, bool *states, bool *has_next,
                                    double *next)
{
    News news;
    const int status = news_of(m, &news);
    *again = news.again, *end = news.terminate, *nominals = news.nominals_changed, *states = news.states_changed;
    *has_next = news.has_next, *next = news.next;
    return status;
}
EXPORT int fmi3CompletedIntegratorStep(Model *m, bool never_back, bool *event, bool *end)
{
    const int status = completed_step(m);
    *event = m->wants_event, *end = m->wants_end;
    return status;
}
EXPORT int fmi3SetTime(Model *m, double time) { return set_time(m, time); }
EXPORT int fmi3SetContinuousStates(Model *m, const double *x, size_t n) { return set_states(m, x, n); }
EXPORT int fmi3GetContinuousStates(Model *m, double *x, size_t n) { return get_states(m, x, n); }
EXPORT int fmi3GetContinuousStateDerivatives(Model *m, double *x, size_t n) { return get_derivatives(m, x, n); }
EXPORT int fmi3GetEventIndicators(Model *m, double *z, size_t n) { return get_indicators(m, z, n); }
EXPORT int fmi3GetNominalsOfContinuousStates(Model *m, double *x, size_t n) { return get_nominals(m, x, n); }
EXPORT int fmi3GetNumberOfContinuousStates(Model *m, size_t *n) { *n = COUNTED_STATES; return OK; }
EXPORT int fmi3GetNumberOfEventIndicators(Model *m, size_t *n) { *n = INDICATORS; return OK; }
EXPORT int fmi3GetFloat64(Model *m, const uint32_t *r, size_t n, double *v, size_t k)
{
    if (n == 1 && k > 1 && m->mode != MADE && derive(m) <= WARNING)
        return memcpy(v, m->reals + r[0], k * sizeof *v), OK;
    return get_reals(m, r, n, v);
}
EXPORT int fmi3SetFloat64(Model *m, const uint32_t *r, size_t n, const double *v, size_t k)
{
    return set_reals(m, r, n, v);
}
EXPORT int fmi3GetInt32(Model *m, const uint32_t *r, size_t n, int32_t *v, size_t k)
{
    return get_wholes(m, r, n, v);
}
EXPORT int fmi3SetInt32(Model *m, const uint32_t *r, size_t n, const int32_t *v, size_t k)
{
    return set_wholes(m, r, n, v);
}
EXPORT int fmi3GetFMUState(Model *m, void **kept) { return get_state(m, kept); }
EXPORT int fmi3SetFMUState(Model *m, void *kept) { return set_state(m, kept); }
EXPORT int fmi3FreeFMUState(Model *m, void **kept) { return free_state(kept); }
#ifdef DIRECTIONAL
EXPORT int fmi3GetDirectionalDerivative(Model *m, const uint32_t *unknowns, size_t n_unknowns, const uint32_t *knowns,
                                 size_t n_knowns, const double *seed, size_t n_seed, double *sensitivity, size_t n)
{
    return directional(m, seed, sensitivity);
}
#endif

#endif
