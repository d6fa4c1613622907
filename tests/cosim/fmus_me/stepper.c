/* x' = 1 until a completed step finds x past a limit; then it asks for an event and stands still: reals x, x',
 * limit; wholes is still. */
#define STATES 1
#define INDICATORS 0
#define REALS 3
#define WHOLES 1
#define COMPLETED(m) m->wants_event = !m->wholes[0] && m->reals[0] >= m->reals[2]
#include "exchange_fmu.h"

static void start(Model *m) {}
static int derive(Model *m)
{
    m->reals[1] = m->wholes[0] ? 0.0 : 1.0;
    return OK;
}
static void indicate(const Model *m, double *indicators) {}
static void update(Model *m, News *news) { m->wholes[0] = m->reals[0] >= m->reals[2]; }
