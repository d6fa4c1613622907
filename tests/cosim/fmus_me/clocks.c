/* Two clocks and a state event: x' = ticks of the first clock. Reals x, x', period, other period, time of the state
 * event, time of the last tick; wholes ticks, other ticks, state events, events in all. */
#define STATES 1
#define INDICATORS 1
#define REALS 6
#define WHOLES 4
#include "exchange_fmu.h"

static void start(Model *m)
{
    m->reals[2] = 0.1;
    m->reals[3] = 0.25;
    m->reals[4] = 0.5;
}
static int derive(Model *m)
{
    m->reals[1] = m->wholes[0];
    return OK;
}
static void indicate(const Model *m, double *indicators)
{
    indicators[0] = m->wholes[2] ? 1.0 : m->reals[4] - m->time;
}
static double due(const Model *m, int clock) { return (m->wholes[clock] + 1) * m->reals[2 + clock]; }
static void update(Model *m, News *news)
{
    m->wholes[3]++;
    for (int clock = 0; clock < 2; clock++)
        if (m->time >= due(m, clock)) {
            m->wholes[clock]++;
            m->reals[5] = m->time;
        }
    if (!m->wholes[2] && m->time >= m->reals[4])
        m->wholes[2] = 1;
    news->has_next = 1;
    news->next = fmin(due(m, 0), due(m, 1));
}
