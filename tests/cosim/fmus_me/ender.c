/* Ends the simulation at a time: reals x, x', time; wholes how: 1 by a time event, 2 when a step is completed. */
#define STATES 1
#define INDICATORS 0
#define REALS 3
#define WHOLES 1
#define COMPLETED(m) m->wants_end = m->wholes[0] == 2 && m->time >= m->reals[2]
#include "exchange_fmu.h"

static void start(Model *m) {}
static int derive(Model *m)
{
    m->reals[1] = 1.0;
    return OK;
}
static void indicate(const Model *m, double *indicators) {}
static void update(Model *m, News *news)
{
    news->terminate = m->wholes[0] == 1 && m->time >= m->reals[2];
    news->has_next = m->wholes[0] == 1;
    news->next = m->reals[2];
}
