/* ARS(2,2,2): a body, explicit, on wheels, implicit. Ascher, Ruuth, Spiteri, Appl. Numer. Math. 25 (1997), 2.6.
 *
 * Second order; the implicit part is L-stable and stiffly accurate. Each step has two stages. Each call adds one stage,
 * as inputs may have changed in between. No step is longer than 10 ms.
 */
#ifndef CHASSIS_ARS_H
#define CHASSIS_ARS_H

#include "wheel.h"

#define ARS_WHEELS 4
#define ARS_STATES 16

typedef struct {
    int states, wheels;
    double body[ARS_STATES], rates[ARS_STATES];
    wheel wheel[ARS_WHEELS], turning[ARS_WHEELS]; /* and its rates */
} ars_state;

/* One stage: *at* has the body's states. The wheels must satisfy y = base + gh f(y), with a second-order guess in
 * at->wheel. Returns the wheels and the body's rates. *before* has the wheels at the beginning of the step. */
typedef void ars_stage(void *car, double gh, const wheel *base, const wheel *before, ars_state *at);

void ars_advance(void *car, ars_stage *stage, ars_state *state, double h, int substeps);

/* The rates of a state, by a stage of zero length. */
void ars_rates(void *car, ars_stage *stage, ars_state *state);

#endif
