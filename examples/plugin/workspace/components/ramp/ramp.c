#include "ramp.h"
void ramp_init(ramp *self) { self->out.travel = 0.0; }
void ramp_step(ramp *self, double h) { self->out.travel += h * self->par.speed; }
