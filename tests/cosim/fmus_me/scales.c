/* Two decays of very different sizes: x' = -50 x from 1e-9, y' = -y from 1e9, with nominals to match. */
#define STATES 2
#define INDICATORS 0
#define REALS 4
#define WHOLES 0
#include "exchange_fmu.h"

static void start(Model *m)
{
    m->nominals[0] = m->reals[0] = 1e-9;
    m->nominals[1] = m->reals[1] = 1e9;
}
static int derive(Model *m)
{
    m->reals[2] = -50.0 * m->reals[0];
    m->reals[3] = -m->reals[1];
    return OK;
}
static void indicate(const Model *m, double *indicators) {}
static void update(Model *m, News *news) {}
