#include "pure_pursuit.h"

#include <math.h>

static double wanted(const pure_pursuit *self) {
    const pure_pursuit_par *par = &self->par;
    double lookahead = lateral_clamp(par->lookahead_time * self->in.motion.speed, par->min_lookahead, par->max_lookahead);
    double rear = par->front_load_share * par->wheelbase;
    lateral_point goal = lateral_path_on_circle(&self->in, rear, lookahead);
    double ahead = goal.x + rear, square = ahead * ahead + goal.y * goal.y;
    return square > 0 ? atan(2 * par->wheelbase * goal.y / square) : 0; /* sin of its bearing is y / sqrt(square) */
}

void pure_pursuit_init(pure_pursuit *self) {
    double steering = wanted(self);
    self->out.steering = lateral_clamp(steering, -self->par.max_steering, self->par.max_steering);
}

void pure_pursuit_step(pure_pursuit *self) {
    self->out.steering =
        lateral_steering(wanted(self), self->out.steering, self->par.max_steering, self->par.max_steering_rate);
}
