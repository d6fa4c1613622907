#include "brake_blending.h"

#include <math.h>

void brake_blending_init(brake_blending *self) {
    double width = self->par.full_speed - self->par.end_speed, above = self->in.speed - self->par.end_speed;
    double fading = above <= 0 ? 0 : above < width ? above / width : 1;
    double machines = fmin(self->par.share * self->in.brake_demand, fading * self->in.regeneration);
    self->out.regeneration_demand = fmax(machines, 0);
    self->out.friction_demand = self->in.brake_demand - self->out.regeneration_demand;
}

void brake_blending_step(brake_blending *self) {
    brake_blending_init(self);
}
