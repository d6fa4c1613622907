#include "ars.h"

#include <math.h>

#define GAMMA 0.29289321881345247560   /* 1 - 1/sqrt(2) */
#define DELTA (-0.70710678118654752440) /* 1 - 1/(2 gamma) */
#define NO_LENGTH 1e-12
#define LONGEST 0.01 /* s: the body is explicit, and oscillates with 50 rad/s */

void ars_rates(void *car, ars_stage *stage, ars_state *state) {
    ars_state at = *state;
    stage(car, NO_LENGTH, state->wheel, state->wheel, &at);
    for (int i = 0; i < state->states; ++i) state->rates[i] = at.rates[i];
}

void ars_advance(void *car, ars_stage *stage, ars_state *state, double h, int substeps) {
    int least = h < 1e4 ? (int)ceil(h / LONGEST - 1e-6) : 1000000;
    if (substeps < least) substeps = least;
    if (substeps < 1) substeps = 1;
    double dt = h / substeps, gh = GAMMA * dt;
    ars_rates(car, stage, state);
    for (int n = 0; n < substeps; ++n) {
        ars_state first = *state, last = *state;
        wheel base[ARS_WHEELS];
        for (int i = 0; i < state->states; ++i) first.body[i] += gh * state->rates[i];
        for (int i = 0; i < state->wheels; ++i) first.wheel[i] = wheel_after(&state->wheel[i], &state->turning[i], gh);
        stage(car, gh, state->wheel, state->wheel, &first);
        for (int i = 0; i < state->states; ++i) last.body[i] += dt * (DELTA * state->rates[i] + (1 - DELTA) * first.rates[i]);
        for (int i = 0; i < state->wheels; ++i) {
            wheel rate = wheel_rate(&state->wheel[i], &first.wheel[i], gh);
            base[i] = wheel_after(&state->wheel[i], &rate, (1 - GAMMA) * dt);
            last.wheel[i] = wheel_after(&base[i], &rate, gh);
        }
        stage(car, gh, base, state->wheel, &last);
        for (int i = 0; i < state->wheels; ++i) last.turning[i] = wheel_rate(&base[i], &last.wheel[i], gh);
        *state = last;
    }
}
