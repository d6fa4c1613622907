#include "stanley.h"

#include <math.h>

#define GRAVITY 9.81 /* m/s2 */

static double wanted(const stanley *self) {
    const stanley_par *par = &self->par;
    double speed = self->in.motion.speed;
    lateral_place front = lateral_place_of(&self->in, (1 - par->front_load_share) * par->wheelbase);
    double yaw_rate = speed * front.curvature;
    double slip = (speed * yaw_rate / GRAVITY + self->in.lane.bank) / par->front_stiffness;
    double back = atan2(par->gain * front.offset, par->softening + fabs(speed));
    return slip - front.heading - back - par->yaw_damping * (self->in.motion.yaw_rate - yaw_rate);
}

void stanley_init(stanley *self) {
    self->out.steering = lateral_clamp(wanted(self), -self->par.max_steering, self->par.max_steering);
}

void stanley_step(stanley *self) {
    self->out.steering =
        lateral_steering(wanted(self), self->out.steering, self->par.max_steering, self->par.max_steering_rate);
}
