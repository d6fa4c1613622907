/* y(k+1) = a y(k) + b u(k), y(0) = y0: no feed-through. */
#include "fmu.h"
enum { U, A, B, Y0, Y };
static void set_defaults(Model *m) { m->value[U] = 0, m->value[A] = 1, m->value[B] = 0, m->value[Y0] = m->value[Y] = 0; }
static int reset(Model *m) { return set_defaults(m), OK; }
static int initialize(Model *m) { return m->value[Y] = m->value[Y0], OK; }
static int step(Model *m, double time, double h)
{
    (void)time, (void)h;
    m->value[Y] = m->value[A] * m->value[Y] + m->value[B] * m->value[U];
    return OK;
}
