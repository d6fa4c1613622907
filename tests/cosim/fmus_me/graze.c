/* An indicator that is below zero for a moment only: reals x, x', middle, half the moment; wholes crossings. */
#define STATES 1
#define INDICATORS 1
#define REALS 4
#define WHOLES 2
#include "exchange_fmu.h"

static void start(Model *m) {}
static double height(const Model *m)
{
    return (m->reals[0] - m->reals[2]) * (m->reals[0] - m->reals[2]) - m->reals[3] * m->reals[3];
}
static int derive(Model *m)
{
    m->reals[1] = 1.0;
    return OK;
}
static void indicate(const Model *m, double *indicators) { indicators[0] = height(m); }
static void update(Model *m, News *news)
{
    const int is_below = height(m) <= 0.0;
    m->wholes[0] += is_below != m->wholes[1];
    m->wholes[1] = is_below;
}
