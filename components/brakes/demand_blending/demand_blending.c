#include "demand_blending.h"

#include <math.h>

/* The friction brake gives what the powertrain does not: of the asked recuperation only what is there already counts. */
void demand_blending_init(demand_blending *self) {
    const double brake = self->in.demand.brake_torque;
    const double speed = 0.5 * (self->in.wheel_speed.front + self->in.wheel_speed.rear);
    const double width = self->par.full_speed - self->par.end_speed, above = speed - self->par.end_speed;
    const double fading = above <= 0 ? 0 : above < width ? above / width : 1;
    const double most = fmin(self->par.max_torque, self->par.max_power / fmax(speed, 1));
    const double asked = fmin(self->par.share * brake, fading * most);
    const double given = fmax(-(self->in.wheels.front + self->in.wheels.rear), 0);
    self->out.powertrain_demand = self->in.demand.drive_torque - asked;
    self->out.brake_demand = brake - fmin(asked, given);
}

void demand_blending_step(demand_blending *self) {
    demand_blending_init(self);
}
