/* x' = rate, and back by 1 where x reaches 1: reals x, x', rate; wholes resets. Its nominal doubles with every
 * reset. */
#define STATES 1
#define INDICATORS 1
#define REALS 3
#define WHOLES 1
#include "exchange_fmu.h"

static void start(Model *m) { m->reals[2] = 1.0; }
static int derive(Model *m)
{
    m->reals[1] = m->reals[2];
    return OK;
}
static void indicate(const Model *m, double *indicators) { indicators[0] = 1.0 - m->reals[0]; }
static void update(Model *m, News *news)
{
    if (m->reals[0] >= 1.0) {
        m->reals[0] -= 1.0;
        m->nominals[0] *= 2.0;
        m->wholes[0]++;
        news->states_changed = news->nominals_changed = 1;
        news->again = 1;
    }
}
