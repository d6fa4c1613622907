/* x' = u + n with a continuous input u and a discrete one n: reals x, x', u; wholes n, changes of n that events saw,
 * the last n. */
#define STATES 1
#define INDICATORS 0
#define REALS 3
#define WHOLES 3
#include "exchange_fmu.h"

static void start(Model *m) {}
static int derive(Model *m)
{
    m->reals[1] = m->reals[2] + m->wholes[0];
    return OK;
}
static void indicate(const Model *m, double *indicators) {}
static void update(Model *m, News *news)
{
    m->wholes[1] += m->wholes[0] != m->wholes[2];
    m->wholes[2] = m->wholes[0];
}
