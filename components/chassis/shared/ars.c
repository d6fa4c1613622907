#include "ars.h"

#define GAMMA 0.29289321881345247560   /* 1 - 1/sqrt(2) */
#define DELTA (-0.70710678118654752440) /* 1 - 1/(2 gamma) */
#define NO_LENGTH 1e-12

void ars_rates(void *car, ars_stage *stage, ars_state *state) {
    ars_state at = *state;
    stage(car, NO_LENGTH, state->wheel, state->wheel, &at);
    for (int i = 0; i < state->states; ++i) state->rates[i] = at.rates[i];
}

void ars_advance(void *car, ars_stage *stage, ars_state *state, double h, int substeps) {
    if (substeps < 1) substeps = 1;
    double dt = h / substeps, gh = GAMMA * dt;
    ars_rates(car, stage, state);
    for (int n = 0; n < substeps; ++n) {
        ars_state first = *state, last = *state;
        wheel base[ARS_WHEELS];
        for (int i = 0; i < state->states; ++i) first.body[i] += gh * state->rates[i];
        stage(car, gh, state->wheel, state->wheel, &first);
        for (int i = 0; i < state->states; ++i) last.body[i] += dt * (DELTA * state->rates[i] + (1 - DELTA) * first.rates[i]);
        for (int i = 0; i < state->wheels; ++i) {
            base[i] = wheel_towards(&state->wheel[i], &first.wheel[i], (1 - GAMMA) / GAMMA);
            last.wheel[i] = wheel_towards(&state->wheel[i], &first.wheel[i], 1 / GAMMA);
        }
        stage(car, gh, base, state->wheel, &last);
        *state = last;
    }
}
