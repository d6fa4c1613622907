/* FMI 2 and 3: a string and, in FMI 3, a binary; heard is the length of the string it was given. What it says is up to
 * *mode*; "large" is *size* bytes, "growing" a byte more each second; *events* counts those of FMI 3. Its log lines name variables by reference, and come from a thread if asked to. */
#define _POSIX_C_SOURCE 200809L
#ifdef EVENTS
#define HAS_EVENTS
#endif
#include "fmu.h"
#include <pthread.h>
enum { MODE, SIZE, HEARD, SAID, GIVEN, BYTES, TAKEN, EVENTS_SEEN };
enum { ECHO, LARGE, NOTHING, LOGS, LOGS_FROM_THREADS, GROWING };
static char *large;
static char heard[32][64];
static void set_defaults(Model *m) { memset(m->value, 0, sizeof m->value), strcpy(heard[0], "hello"); }
static int reset(Model *m) { return set_defaults(m), OK; }
static int initialize(Model *m) { return (void)m, OK; }
static void *babble(void *model)
{
    for (int i = 0; i < 2000; i++)
        say(model, "from afar", i);
    return NULL;
}
static int step(Model *m, double time, double h)
{
    if ((int)m->value[MODE] == GROWING)
        return m->value[SIZE] = 1.0 + (int)(time + h), OK;
    if ((int)m->value[MODE] == LOGS)
        say(m, "the size #r1# is ##1, not #r99#", 7);
    pthread_t threads[4];
    for (int i = 0; i < 4 && (int)m->value[MODE] == LOGS_FROM_THREADS; i++)
        pthread_create(&threads[i], NULL, babble, m);
    for (int i = 0; i < 4 && (int)m->value[MODE] == LOGS_FROM_THREADS; i++)
        pthread_join(threads[i], NULL);
    return (int)m->value[MODE] >= LOGS ? ERROR : OK;
}
static const char *said(const Model *m)
{
    if ((int)m->value[MODE] == NOTHING)
        return NULL;
    if ((int)m->value[MODE] != LARGE && (int)m->value[MODE] != GROWING)
        return heard[0];
    const size_t size = (size_t)m->value[SIZE];
    large = realloc(large, size + 1);
    memset(large, 'x', size);
    large[size] = 0;
    return large;
}
EXPORT int NAME(GetString)(void *m, const uint32_t *reference, size_t n, const char **value COUNT)
{
    *value = said(m);
    return n == 1 && *reference == SAID ? OK : ERROR;
}
EXPORT int NAME(SetString)(void *m, const uint32_t *reference, size_t n, const char *const *value COUNT)
{
    ((Model *)m)->value[HEARD] = (double)strlen(*value);
    return n == 1 && *reference == GIVEN ? OK : ERROR;
}
#if FMI == 3
EXPORT int fmi3GetBinary(void *m, const uint32_t *reference, size_t n, size_t *sizes, const uint8_t **value, size_t count)
{
    *value = (const uint8_t *)said(m);
    *sizes = (int)((Model *)m)->value[MODE] == LARGE ? (size_t)((Model *)m)->value[SIZE] : *value ? 3 : 1;
    return n == 1 && count == 1 && *reference == BYTES ? OK : ERROR;
}
EXPORT int fmi3SetBinary(void *m, const uint32_t *reference, size_t n, const size_t *sizes, const uint8_t *const *value,
                         size_t count)
{
    ((Model *)m)->value[HEARD] = (double)*sizes;
    return n == 1 && count == 1 && *value && *reference == TAKEN ? OK : ERROR;
}
#endif
#ifdef EVENTS
EXPORT int fmi3EnterEventMode(void *m) { return (void)m, OK; }
EXPORT int fmi3UpdateDiscreteStates(void *m, bool *again, bool *ends, bool *nominals, bool *states, bool *has_next,
                                    double *next)
{
    ((Model *)m)->value[EVENTS_SEEN] += 1;
    *again = *ends = *nominals = *states = *has_next = false;
    *next = 0;
    return OK;
}
EXPORT int fmi3EnterStepMode(void *m) { return (void)m, OK; }
#endif
