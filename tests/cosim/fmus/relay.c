/* Every input 0 … 10 appears at output 16 … 26, through as many types as FMI 3 has numbers. */
#include "fmu.h"
static void set_defaults(Model *m) { memset(m->value, 0, sizeof m->value); }
static int reset(Model *m) { return set_defaults(m), OK; }
static int initialize(Model *m) { return memcpy(m->value + 16, m->value, 11 * sizeof(double)), OK; }
static int step(Model *m, double time, double h) { return (void)time, (void)h, initialize(m); }
