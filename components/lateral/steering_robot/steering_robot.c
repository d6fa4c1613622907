#include "steering_robot.h"

#include <math.h>

#define LEFT 1 /* of drift_to */

static double wrapped(double angle) {
    return atan2(sin(angle), cos(angle));
}

static double wanted(steering_robot *self) {
    const lateral_motion *motion = &self->in.motion;
    double c = cos(self->heading), s = sin(self->heading);
    double dx = motion->x - self->par.rear_axle * cos(motion->heading) - self->x;
    double dy = motion->y - self->par.rear_axle * sin(motion->heading) - self->y;
    turn_pose pose = turn_path_at(&self->path, self->along);
    double x = c * dx + s * dy - pose.x, y = c * dy - s * dx - pose.y;
    self->along += x * cos(pose.heading) + y * sin(pose.heading);
    pose = turn_path_at(&self->path, self->along);
    x = c * dx + s * dy - pose.x;
    y = c * dy - s * dx - pose.y;
    double offset = y * cos(pose.heading) - x * sin(pose.heading);
    double turned = wrapped(motion->heading - self->heading - pose.heading);
    double slope = fabs(turned) > 1e-6 ? sin(turned) / turned : 1;
    double decay = fmax(self->par.decay_distance, self->par.decay_time * motion->speed);
    double curvature = pose.curvature * cos(turned) / (1 - pose.curvature * offset) - 2 * turned / decay -
                       offset * slope / (decay * decay);
    return atan(self->par.wheelbase * curvature);
}

void steering_robot_init(steering_robot *self) {
    const lateral_motion *motion = &self->in.motion;
    self->heading = motion->heading;
    self->x = motion->x - self->par.rear_axle * cos(motion->heading);
    self->y = motion->y - self->par.rear_axle * sin(motion->heading);
    double straight = motion->speed * self->par.turn_after, drift = self->par.drift;
    self->path = drift > 0 ? turn_path_drifting(self->par.drift_to == LEFT ? drift : -drift, motion->speed, straight)
                           : turn_path_of(self->par.turn, motion->speed, straight);
    self->along = 0;
    self->out.steering = 0;
}

void steering_robot_step(steering_robot *self) {
    double limit = self->par.max_steering;
    self->out.steering = lateral_steering(wanted(self), self->out.steering, limit, self->par.max_steering_rate);
}
