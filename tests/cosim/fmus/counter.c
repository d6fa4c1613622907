/* Counts by an increment while enabled; odd tells whether the count is. */
#include "fmu.h"
enum { ENABLE, INCREMENT, COUNTED, ODD };
static void set_defaults(Model *m) { memset(m->value, 0, sizeof m->value); }
static int reset(Model *m) { return set_defaults(m), OK; }
static int initialize(Model *m) { return m->value[ODD] = (double)((int)m->value[COUNTED] & 1), OK; }
static int step(Model *m, double time, double h)
{
    (void)time, (void)h;
    if (m->value[ENABLE] != 0)
        m->value[COUNTED] += m->value[INCREMENT];
    return initialize(m);
}
