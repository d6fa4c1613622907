/* Heat in a rod with cold ends: x_i' = k (x_(i-1) - 2 x_i + x_(i+1)). Reals x, x', k; with FMI 3.0 x and x' are arrays. */
#define STATES 40
#define INDICATORS 0
#define REALS 81
#define WHOLES 1
#include "exchange_fmu.h"

static void start(Model *m)
{
    m->reals[2 * STATES] = 1.0;
    for (int i = 0; i < STATES; i++)
        m->reals[i] = sin((i + 1) * acos(-1.0) / (STATES + 1));
}
static void conduct(const Model *m, const double *x, double *slope)
{
    for (int i = 0; i < STATES; i++)
        slope[i] = m->reals[2 * STATES] * ((i > 0 ? x[i - 1] : 0.0) - 2.0 * x[i] + (i + 1 < STATES ? x[i + 1] : 0.0));
}
static int derive(Model *m) { return conduct(m, m->reals, m->reals + STATES), OK; }
static void indicate(const Model *m, double *indicators) {}
static void update(Model *m, News *news) {}
#ifdef DIRECTIONAL
static int directional(Model *m, const double *seed, double *sensitivity)
{
    m->wholes[0]++;
    return conduct(m, seed, sensitivity), OK;
}
#endif
