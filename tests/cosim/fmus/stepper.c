/* FMI 1 and 2: y is the time stepped over, sum the integral of u along its slope; how a step ends is up to *mode*.
 * A step of more than *most* seconds is made in part, or not at all, or asynchronously; ALWAYS_CALLS_BACK makes every
 * third step at once and calls back all the same. */
#define _POSIX_C_SOURCE 200809L
#include "fmu.h"
#include <pthread.h>
#include <time.h>
enum { MODE, MOST, U, Y, STEPS, SUM, REACHED, SLOPE, ASKED, LATER };
enum { WHOLE, IN_PART, STUCK, WANTS_TO_END, ASKED_FOR, CALLS_BACK, FAILS_LATE, ALWAYS_CALLS_BACK, BEYOND };
enum { PENDING = 5 };
static void set_defaults(Model *m) { memset(m->value, 0, sizeof m->value), m->value[MOST] = 1.0; }
static int reset(Model *m) { return set_defaults(m), OK; }
static int initialize(Model *m) { return (void)m, OK; }
static void advance(Model *m, double h)
{
    m->value[Y] += h;
    m->value[STEPS] += 1;
    m->value[SUM] += h * (m->value[U] + 0.5 * h * m->value[SLOPE]);
}
static void *finish_later(void *model)
{
    Model *m = model;
    nanosleep(&(struct timespec){0, 1000000}, NULL);
    if ((int)m->value[MODE] == ALWAYS_CALLS_BACK)
        advance(m, m->value[LATER]);
    m->finished(m->environment, (int)m->value[MODE] == FAILS_LATE ? ERROR : OK);
    return NULL;
}
static int step(Model *m, double time, double h)
{
    const int mode = (int)m->value[MODE];
    if (mode == ALWAYS_CALLS_BACK && (int)m->value[STEPS] % 3 == 0) {
        advance(m, h);
        m->finished(m->environment, OK);
        return OK;
    }
    if (mode == WHOLE || h <= m->value[MOST])
        return advance(m, h), OK;
    m->value[REACHED] = time + (mode == IN_PART ? m->value[MOST] : 0.0);
    if (mode == IN_PART)
        advance(m, m->value[MOST]);
    if (mode == BEYOND)
        m->value[REACHED] = 1e300;
    if (mode <= WANTS_TO_END || mode == BEYOND)
        return DISCARD;
    if (mode == ALWAYS_CALLS_BACK)
        m->value[LATER] = h;
    else
        advance(m, h);
    m->value[ASKED] = 0;
    pthread_t thread;
    if (mode != ASKED_FOR && (pthread_create(&thread, NULL, finish_later, m) != 0 || pthread_detach(thread) != 0))
        return ERROR;
    return PENDING;
}
EXPORT int NAME(GetStatus)(void *model, int what, int *status)
{
    Model *m = model;
    *status = (int)m->value[MODE] != ASKED_FOR || ++m->value[ASKED] < 3 ? PENDING : OK;
    return what == 0 ? OK : ERROR;
}
EXPORT int NAME(GetRealStatus)(void *m, int what, double *time)
{
    *time = ((Model *)m)->value[REACHED];
    return what == 2 ? OK : DISCARD;
}
EXPORT int NAME(GetBooleanStatus)(void *m, int what, Truth *ends)
{
    *ends = (int)((Model *)m)->value[MODE] == WANTS_TO_END;
    return what == 3 ? OK : DISCARD;
}
EXPORT int NAME(SetRealInputDerivatives)(void *m, const uint32_t *reference, size_t n, const int *order,
                                         const double *value)
{
    if (n != 1 || *reference != U || *order != 1)
        return ERROR;
    ((Model *)m)->value[SLOPE] = *value;
    return OK;
}
