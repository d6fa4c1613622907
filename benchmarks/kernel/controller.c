#include "controller.h"

#define PERIOD 0.01

void controller_init(Controller *self)
{
    self->out.demand = 0.0;
    self->is_first = true;
}

void controller_step(Controller *self)
{
    double error = self->par.set_speed - self->in.speed;
    double rate = self->is_first ? 0.0 : (error - self->error) / PERIOD;
    self->error = error;
    self->is_first = false;
    double demand = self->par.kp_speed * error + self->par.kd_speed * rate;
    if (self->in.detected) {
        double follow =
            self->par.kp_gap * (self->in.gap - self->par.set_gap) + self->par.kd_gap * self->in.closing_speed;
        if (follow < demand)
            demand = follow;
    }
    self->out.demand = demand < -4.0 ? -4.0 : demand > 2.5 ? 2.5 : demand;
}
