/* x goes up by the relative tolerance that the FMU is told (0 for none) each second. */
#define STATES 1
#define INDICATORS 0
#define REALS 2
#define WHOLES 0
#include "exchange_fmu.h"

static void start(Model *m) {}
static int derive(Model *m)
{
    m->reals[1] = m->told;
    return OK;
}
static void indicate(const Model *m, double *indicators) {}
static void update(Model *m, News *news) {}
