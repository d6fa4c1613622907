#include "drive_robot.h"

#include "../../traffic/profile/speed_profile.h"

#include <math.h>

static void output(drive_robot *self, double torque) {
    for (int32_t i = 0; i < 4; ++i) self->out.wheel_torque[i] = 0.25 * torque;
    self->out.set_speed = self->in.motion.speed;
}

void drive_robot_init(drive_robot *self) {
    self->ticks = 0;
    self->way = 0;
    self->has_stopped = false;
    self->last = self->in.motion.speed;
    output(self, 0);
}

void drive_robot_step(drive_robot *self) {
    const double sense = self->par.reverses ? -1 : 1, speed = self->in.motion.speed;
    ++self->ticks;
    self->way += 0.5 * (self->last + speed) * DRIVE_ROBOT_STEP;
    self->last = speed;
    speed_profile prescribed = {0, self->par.start_after, self->par.acceleration, self->par.speed};
    speed_profile_motion wanted = speed_profile_at(&prescribed, self->ticks * DRIVE_ROBOT_STEP);
    double late = wanted.travelled - sense * self->way, slow = wanted.speed - sense * speed;
    if (fmax(self->in.emergency_torque, self->in.yielding_torque) > self->par.release_torque) self->has_stopped = true;
    double correction = self->par.place_gain * late + self->par.speed_gain * slow, most = self->par.max_correction;
    double acceleration = wanted.acceleration + fmax(fmin(correction, most), -most);
    output(self, self->has_stopped ? 0 : sense * self->par.nominal_mass * acceleration * self->par.wheel_radius);
}
