/* x'' = -w^2 x + u: reals x, v, x', v', w, u; reals 6 is a copy of u as the derivatives last saw it. */
#define STATES 2
#define INDICATORS 0
#define REALS 7
#define WHOLES 0
#include "exchange_fmu.h"

static void start(Model *m) { m->reals[0] = m->reals[4] = 1.0; }
static int derive(Model *m)
{
    m->reals[2] = m->reals[1];
    m->reals[3] = m->reals[5] - m->reals[4] * m->reals[4] * m->reals[0];
    m->reals[6] = m->reals[5];
    return OK;
}
static void indicate(const Model *m, double *indicators) {}
static void update(Model *m, News *news) {}
#ifdef DIRECTIONAL
static int directional(Model *m, const double *seed, double *sensitivity)
{
    sensitivity[0] = seed[1];
    sensitivity[1] = -m->reals[4] * m->reals[4] * seed[0];
    return OK;
}
#endif
