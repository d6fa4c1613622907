/* y = k u + c, with feed-through during initialization. Its reset may keep parameters (KEEPS_PARAMETERS),
 * and c may count the instances there have been (COUNTS). */
#include "fmu.h"
enum { U, K, C, Y };
#ifdef COUNTS
static int instances;
#define FIRST_C instances++
#else
#define FIRST_C 0
#endif
static void set_defaults(Model *m) { m->value[U] = 0, m->value[K] = 1, m->value[C] = FIRST_C, m->value[Y] = 0; }
#ifdef KEEPS_PARAMETERS
static int reset(Model *m) { return m->value[U] = m->value[Y] = 0, OK; }
#else
static int reset(Model *m) { return set_defaults(m), OK; }
#endif
#ifdef ROOT /* y = k sqrt(u) + c; u below 0 is discarded */
#include <math.h>
#define GIVEN sqrt(m->value[U])
#define IN_DOMAIN (m->value[U] >= 0.0)
#else
#define GIVEN m->value[U]
#define IN_DOMAIN true
#endif
static int initialize(Model *m)
{
    if (!IN_DOMAIN)
        return DISCARD;
    m->value[Y] = m->value[K] * GIVEN + m->value[C];
    return OK;
}
static int step(Model *m, double time, double h) { return (void)time, (void)h, initialize(m); }
