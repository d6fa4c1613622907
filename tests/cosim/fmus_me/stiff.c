/* x' = -k (x - cos t) - sin t, so x = cos t whatever k is, and y' = -y: reals x, y, x', y', k, evaluations. */
#define STATES 2
#define INDICATORS 0
#define REALS 6
#define WHOLES 1
#include "exchange_fmu.h"

static void start(Model *m)
{
    m->reals[0] = m->reals[1] = 1.0;
    m->reals[4] = 1e6;
}
static int derive(Model *m)
{
    m->reals[2] = -m->reals[4] * (m->reals[0] - cos(m->time)) - sin(m->time);
    m->reals[3] = -m->reals[1];
    m->reals[5] += m->mode == CONTINUOUS;
    return OK;
}
static void indicate(const Model *m, double *indicators) {}
static void update(Model *m, News *news) {}
#ifdef DIRECTIONAL
static int directional(Model *m, const double *seed, double *sensitivity)
{
    m->wholes[0]++;
    sensitivity[0] = -m->reals[4] * seed[0];
    sensitivity[1] = -seed[1];
    return OK;
}
#endif
