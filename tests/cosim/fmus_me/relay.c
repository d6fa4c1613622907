/* x' = -1 above the band, 1 below it: reals x, x', half the band's width; wholes direction, switches. */
#define STATES 1
#define INDICATORS 1
#define REALS 3
#define WHOLES 2
#include "exchange_fmu.h"

static void start(Model *m)
{
    m->reals[0] = 0.5;
    m->wholes[0] = -1;
}
static int derive(Model *m)
{
    m->reals[1] = m->wholes[0];
    return OK;
}
/* Positive as long as it goes on in this direction. */
static void indicate(const Model *m, double *indicators) { indicators[0] = m->reals[2] - m->reals[0] * m->wholes[0]; }
static void update(Model *m, News *news)
{
    if (m->reals[2] - m->reals[0] * m->wholes[0] <= 0.0) {
        m->wholes[0] = -m->wholes[0];
        m->wholes[1]++;
    }
}
