/* An integrator of its input that can save its state, and does one thing wrong, as a -D flag says. */
#define MAY_ROLL_BACK
#include "../../fmus/fmu.h"

#if !defined(_WIN32)
#include <unistd.h>
#endif

enum { U, K, Y, N };

static int made;    /* instances, ever */
static volatile double last; /* input of whoever stepped last */
static void *volatile lost;

static void set_defaults(Model *m)
{
    memset(m->value, 0, sizeof m->value);
    m->value[K] = 2;
    made++;
#ifdef FRAGILE
    if (made > FRAGILE)
        abort();
#endif
#ifdef COUNTS_INSTANCES
    m->value[N] = made > 1;
#endif
#ifdef LEAKS
    lost = memset(malloc(LEAKS), 1, LEAKS);
#endif
}

static int reset(Model *m)
{
#ifdef KEEPS_PARAMETERS
    m->value[U] = m->value[Y] = 0;
#elif defined(RESET_CRASHES)
    abort();
#else
    m->value[U] = m->value[Y] = 0, m->value[K] = 2;
#endif
    return OK;
}

static int initialize(Model *m)
{
#ifdef INITIALIZATION_HANGS
    while (m->value[K] > 0)
        continue;
#endif
#ifdef INITIALIZATION_FAILS
    say(m, "no equilibrium found in iteration", 12);
    return ERROR;
#endif
    (void)m;
    return OK;
}

static int step(Model *m, double time, double h)
{
    double u = m->value[U];
    (void)time;
#ifdef SHARES_ITS_INPUT
    u = last, last = m->value[U];
#elif defined(RACES)
    last = u;
    for (volatile int i = 0; i < 2000; i++)
        continue;
    u = last;
#endif
#ifdef HATES_INPUTS
    if (u > 0.1 || u < -0.1)
        abort();
#endif
#ifdef ONLY_EVEN_STEPS
    if (h < 0.0095)
        return ERROR;
#endif
#ifdef DIFFERS_BY_PROCESS
    u += getpid();
#endif
#ifdef EATS_MEMORY
    for (;;)
        lost = memset(malloc(1 << 24), 1, 1 << 24);
#endif
    m->value[Y] += h * m->value[K] * u;
    return OK;
}

/* ---- saving the state ---- */

#if FMI == 2
#define STATE(verb) fmi2##verb##FMUstate
#else
#define STATE(verb) fmi3##verb##FMUState
#endif

EXPORT int STATE(Get)(void *instance, void **state)
{
    Model *m = instance;
#ifdef SAVING_DISTURBS
    m->value[Y] += 1;
#endif
    if (!*state)
        *state = calloc(1, sizeof m->value);
    memcpy(*state, m->value, sizeof m->value);
    return OK;
}
EXPORT int STATE(Set)(void *instance, void *state)
{
    Model *m = instance;
#ifdef FORGETS_STATE
    m->value[K] = ((double *)state)[K];
#else
    memcpy(m->value, state, sizeof m->value);
#endif
    return OK;
}
EXPORT int STATE(Free)(void *instance, void **state)
{
    (void)instance;
    free(*state);
    *state = NULL;
    return OK;
}
#if FMI == 2
EXPORT int fmi2SerializedFMUstateSize(void *instance, void *state, size_t *size)
#else
EXPORT int fmi3SerializedFMUStateSize(void *instance, void *state, size_t *size)
#endif
{
    (void)state;
    return *size = sizeof ((Model *)instance)->value, OK;
}
EXPORT int STATE(Serialize)(void *instance, void *state, void *bytes, size_t size)
{
    (void)instance;
    return memcpy(bytes, state, size), OK;
}
#if FMI == 2
EXPORT int fmi2DeSerializeFMUstate(void *instance, const void *bytes, size_t size, void **state)
#else
EXPORT int fmi3DeserializeFMUState(void *instance, const void *bytes, size_t size, void **state)
#endif
{
    (void)instance;
    if (!*state)
        *state = calloc(1, size);
    memcpy(*state, bytes, size);
#ifdef BYTES_LOSE_STATE
    ((double *)*state)[Y] = 0;
#endif
    return OK;
}
