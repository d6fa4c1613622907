/* No state: a switch that is on for a while, a clock, and the time: reals time, on from, on until, period; wholes
 * on, ticks. */
#define STATES 0
#ifndef INDICATORS
#define INDICATORS 2
#endif
#define REALS 4
#define WHOLES 2
#include "exchange_fmu.h"

static void start(Model *m) { m->reals[3] = 0.3; }
static int derive(Model *m)
{
    m->reals[0] = m->time;
    return OK;
}
static void indicate(const Model *m, double *indicators)
{
    indicators[0] = m->time - m->reals[1];
    indicators[INDICATORS - 1] = m->time - m->reals[2];
}
static void update(Model *m, News *news)
{
    m->wholes[0] = m->time >= m->reals[1] && m->time < m->reals[2];
    m->wholes[1] += m->time >= (m->wholes[1] + 1) * m->reals[3];
    news->has_next = 1;
    news->next = (m->wholes[1] + 1) * m->reals[3];
}
