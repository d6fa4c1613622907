/* y is the time until *at*; there something happens, as *mode* says. */
#define OWN_TERMINATE
#include "fmu.h"
enum { MODE, AT, Y, N, U };
enum {
    FINE, STEP_ERROR, BECOMES_NAN, BECOMES_INFINITE, STEP_WARNING, STEP_FATAL, CRASH, STEP_DISCARD, ENDS, RETURNS_EARLY,
    NO_INITIALIZATION, HUGE_INTEGER, NO_RESET, NO_TERMINATE
};
static bool is(const Model *m, int mode) { return (int)m->value[MODE] == mode; }
static void set_defaults(Model *m) { memset(m->value, 0, sizeof m->value), m->ended = m->early = false; }
static int reset(Model *m)
{
    bool refused = is(m, NO_RESET);
    set_defaults(m);
    return refused ? ERROR : OK;
}
static int finish(Model *m) { return is(m, NO_TERMINATE) ? ERROR : OK; }
static int initialize(Model *m)
{
    if (!is(m, NO_INITIALIZATION))
        return OK;
    say(m, "no equilibrium found in iteration", 12);
    return ERROR;
}
static int step(Model *m, double time, double h)
{
    m->value[Y] = time + h;
    if (time < m->value[AT])
        return OK;
    if (is(m, BECOMES_NAN))
        m->value[Y] = strtod("nan", NULL);
    if (is(m, BECOMES_INFINITE))
        m->value[Y] = strtod("-inf", NULL);
    if (is(m, HUGE_INTEGER))
        m->value[N] = 9007199254740994.0;
    if (is(m, CRASH))
        abort();
    m->ended = is(m, ENDS);
    m->early = is(m, RETURNS_EARLY);
    if (is(m, STEP_ERROR) || is(m, STEP_FATAL))
        say(m, "tyre left the road", 42);
    if (is(m, STEP_WARNING))
        return WARNING;
    if (is(m, STEP_DISCARD))
        return DISCARD;
    return is(m, STEP_ERROR) ? ERROR : is(m, STEP_FATAL) ? FATAL : OK;
}
