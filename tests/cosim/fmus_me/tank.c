/* h' = -k sqrt(h) until the tank is empty, where the equation ends: reals h, h', k; wholes is empty. A negative
 * level is refused, so the event lies at the border of what can be evaluated. */
#define STATES 1
#define INDICATORS 1
#define REALS 3
#define WHOLES 1
#include "exchange_fmu.h"

static void start(Model *m) { m->reals[0] = m->reals[2] = 1.0; }
static int derive(Model *m)
{
    if (m->wholes[0])
        return m->reals[1] = 0.0, OK;
    if (m->reals[0] < 0.0)
        return DISCARD;
    m->reals[1] = -m->reals[2] * sqrt(m->reals[0]);
    return OK;
}
static void indicate(const Model *m, double *indicators) { indicators[0] = m->wholes[0] ? 1.0 : m->reals[0]; }
static void update(Model *m, News *news)
{
    if (!m->wholes[0] && m->reals[0] <= 0.0) {
        m->wholes[0] = 1;
        m->reals[0] = 0.0;
        news->states_changed = 1;
    }
}
