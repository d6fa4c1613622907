/* FMI 3 with event mode: y is the integral of u, taken in the middle of each step if that can be asked for; d is a
 * discrete input that may be set in events only, seen is its sum over all events; every *period* seconds there is an
 * event inside: told as it comes if that is allowed, else at the end of the step, and announced if *announces*. */
#define HAS_EVENTS
#define OWN_WATCH
#include "fmu.h"
enum { U, D, PERIOD, ANNOUNCES, Y, SEEN, EVENTS, UPDATES, STEPS, MODE, INSIDE };
enum { FINE, ENDLESS, ENDS, STANDS_STILL };
static void set_defaults(Model *m)
{
    memset(m->value, 0, sizeof m->value);
    m->value[PERIOD] = 1e9;
    m->value[INSIDE] = 1.0; /* anything may be set until step mode is entered */
    m->early = m->event = false;
}
static int reset(Model *m) { return set_defaults(m), OK; }
static int initialize(Model *m) { return (void)m, OK; }
static int before_writing(Model *m, uint32_t reference)
{
    if (reference != D || m->value[INSIDE] == 1.0)
        return OK;
    say(m, "d was set outside of event mode", 0);
    return ERROR;
}
static double next_event(const Model *m) { return (m->value[EVENTS] + 1.0) * m->value[PERIOD]; }
static void advance(Model *m, double time, double h)
{
    bool early;
    double at;
    if (m->between)
        m->between(m->environment, time + 0.5 * h, true, true, false, false, &early, &at);
    m->value[Y] += h * m->value[U];
    m->value[STEPS] += 1;
}
static int step(Model *m, double time, double h)
{
    double end = time + h;
    m->early = m->event = false;
    if ((int)m->value[MODE] == STANDS_STILL) {
        m->early = true;
        m->reached = time;
        return OK;
    }
    if (m->uses_events && next_event(m) < end && m->may_return_early) {
        end = m->reached = next_event(m) > time ? next_event(m) : time;
        m->early = true;
    }
    m->event = m->uses_events && next_event(m) <= end;
    if (end > time)
        advance(m, time, m->early ? end - time : h);
    return OK;
}
EXPORT int fmi3EnterEventMode(void *model)
{
    Model *m = model;
    m->value[INSIDE] = 1.0;
    if (m->event)
        m->value[EVENTS] += 1;
    m->event = false;
    return OK;
}
EXPORT int fmi3UpdateDiscreteStates(void *model, bool *again, bool *ends, bool *nominals, bool *states, bool *has_next,
                                    double *next)
{
    Model *m = model;
    m->value[UPDATES] += 1;
    m->value[SEEN] += m->value[D];
    *again = (int)m->value[MODE] == ENDLESS;
    *ends = (int)m->value[MODE] == ENDS && m->value[EVENTS] > 0;
    *nominals = *states = false;
    *has_next = m->value[ANNOUNCES] != 0.0;
    *next = next_event(m);
    return OK;
}
EXPORT int fmi3EnterStepMode(void *m)
{
    ((Model *)m)->value[INSIDE] = 0.0;
    return OK;
}
