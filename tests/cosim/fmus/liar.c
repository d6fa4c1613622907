/* A clock that goes on where it was after a reset: y counts the steps of all runs. */
#include "fmu.h"
enum { U, Y };
static void set_defaults(Model *m) { m->value[U] = m->value[Y] = 0; }
static int reset(Model *m) { return m->value[U] = 0, OK; }
static int initialize(Model *m) { return (void)m, OK; }
static int step(Model *m, double time, double h) { return (void)time, (void)h, m->value[Y] += 1, OK; }
