#include "emergency_lane_keeping.h"

#include <math.h>

#define BESIDE 6.0    /* m: ahead or behind, a vehicle that is beside the car */
#define ADJACENT 1.5  /* widths of the lane: to the middle of its line on the far side */
#define SLOW 1.0      /* m/s */

static double limited(double value, double most) {
    return fmin(fmax(value, -most), most);
}

/* Distance of the outer front wheel from the edge on the side *sense*, and the speed with which it nears it. */
static double distance_to(const emergency_lane_keeping *self, double sense) {
    double front = self->in.lane.offset + self->par.front_axle * sin(self->in.lane.heading);
    return 0.5 * (self->in.lane.width - self->par.width) - sense * front;
}

static double lateral_speed(const emergency_lane_keeping *self) {
    const double heading = self->in.lane.heading;
    return self->in.motion.speed * sin(heading) + self->in.motion.lateral_speed * cos(heading);
}

/* A vehicle on the lane to the left is, or will soon be, beside the car. */
static bool is_threatened(const emergency_lane_keeping *self) {
    double c = cos(self->in.lane.heading), s = sin(self->in.lane.heading), width = self->in.lane.width;
    for (int i = 0; i < LANE_SUPPORT_TRACKS; ++i) {
        if (self->in.tracks[i].id == 0) continue;
        double x = self->in.tracks[i].x, aside = self->in.lane.offset + s * x + c * self->in.tracks[i].y;
        if (aside < 0.5 * width || aside > ADJACENT * width) continue;
        double closing = self->in.motion.speed - self->in.tracks[i].vx; /* < 0: it overtakes */
        double time = x * closing > 0 ? x / closing : HUGE_VAL;
        if (fabs(x) < BESIDE || time < self->par.horizon) return true;
    }
    return false;
}

static bool is_due(const emergency_lane_keeping *self, double sense) {
    double nears = sense * lateral_speed(self);
    return nears > 0 && distance_to(self, sense) < self->par.trigger_distance + self->par.trigger_time * nears;
}

static void decide(emergency_lane_keeping *self) {
    double speed = self->in.motion.speed;
    bool works = speed >= self->par.min_speed && speed <= self->par.max_speed;
    bool to_the_right = works && is_due(self, -1), to_the_left = works && is_due(self, 1) && is_threatened(self);
    if (to_the_right || to_the_left) {
        self->sense = to_the_right ? -1 : 1;
        self->left = (int32_t)floor(self->par.hold / LANE_SUPPORT_STEP + 0.5);
    } else if (self->left > 0) {
        --self->left;
    }
    self->out.active = self->left > 0;
}

void emergency_lane_keeping_init(emergency_lane_keeping *self) {
    self->sense = self->acceleration = 0;
    self->left = 0;
    self->out.active = false;
    self->out.steering = self->in.wish;
}

void emergency_lane_keeping_step(emergency_lane_keeping *self) {
    decide(self);
    if (!self->out.active) {
        self->acceleration = 0;
        self->out.steering = self->in.wish;
        return;
    }
    double away = self->par.keep_distance - distance_to(self, self->sense), speed = fmax(self->in.motion.speed, SLOW);
    double wanted = -self->sense * self->par.offset_gain * away - self->par.speed_gain * lateral_speed(self);
    double change = limited(limited(wanted, self->par.max_acceleration) - self->acceleration, self->par.max_jerk * LANE_SUPPORT_STEP);
    self->acceleration += change;
    self->out.steering = atan(self->par.wheelbase * (self->acceleration / (speed * speed) + self->in.lane.curvature));
}
