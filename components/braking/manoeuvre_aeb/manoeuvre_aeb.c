#include "manoeuvre_aeb.h"

#include <math.h>

#define STANDSTILL 0.1 /* m/s */
#define MOVES 0.5      /* m/s: above it the velocity gives the direction of the body */
#define RUNS 3.0       /* m/s: an object without a class that is faster is a car */

typedef struct {
    double from, to;
} span;

/* The times at which a point at *place* with *speed* is between two places; from > to: never. */
static span inside(double place, double speed, double low, double high) {
    if (speed == 0) return low <= place && place <= high ? (span){-HUGE_VAL, HUGE_VAL} : (span){HUGE_VAL, -HUGE_VAL};
    double a = (low - place) / speed, b = (high - place) / speed;
    return (span){fmin(a, b), fmax(a, b)};
}

static bool is_danger(const manoeuvre_aeb *self, int32_t i) {
    double vx = self->in.tracks[i].vx, vy = self->in.tracks[i].vy, pace = hypot(vx, vy), speed = self->in.motion.speed;
    double sense = speed < 0 ? -1 : 1, bumper = sense > 0 ? self->par.front_length : self->par.length - self->par.front_length;
    double lost = self->par.lost_time, gains = fmax(sense * self->in.motion.acceleration, 0) * lost, last = fabs(speed) + gains;
    double reach = (fabs(speed) + 0.5 * gains) * lost + last * last / (2 * self->par.full_deceleration) + self->par.standing_gap;
    int32_t class = self->in.tracks[i].class;
    if (class == CLASS_NONE && pace > RUNS) class = CLASS_CAR;
    double width = class == CLASS_NONE ? self->par.unknown_width : emergency_width_of(class);
    double c = pace > MOVES ? fabs(vx) / pace : 1, s = pace > MOVES ? fabs(vy) / pace : 0;
    double length = pace > MOVES ? emergency_length_of(class) : 0;
    double along = 0.5 * (c * length + s * width), across = 0.5 * (s * length + c * width);
    double side = 0.5 * self->par.width + self->par.margin + across;
    span ahead = inside(sense * self->in.tracks[i].x - bumper, sense * vx, -along, reach + along);
    span beside = inside(self->in.tracks[i].y, vy, -side, side);
    return fmax(fmax(ahead.from, beside.from), 0) <= fmin(fmin(ahead.to, beside.to), self->par.horizon);
}

static bool in_danger(const manoeuvre_aeb *self) {
    for (int32_t i = 0; i < EMERGENCY_TRACKS; ++i) {
        bool is_sure = self->in.tracks[i].id != 0 && self->in.tracks[i].age >= self->par.min_age &&
                       self->in.tracks[i].existence >= self->par.least_existence;
        if (is_sure && is_danger(self, i)) return true;
    }
    return false;
}

void manoeuvre_aeb_init(manoeuvre_aeb *self) {
    self->calm = 0;
    self->out.stage = STAGE_NONE;
    self->out.deceleration = 0;
    self->out.brake_torque = 0;
}

void manoeuvre_aeb_step(manoeuvre_aeb *self) {
    double pace = fabs(self->in.motion.speed);
    bool brakes = self->out.stage != STAGE_NONE;
    bool works = brakes || (pace > self->par.min_speed && pace < self->par.max_speed);
    if (works && in_danger(self)) {
        self->out.stage = STAGE_FULL;
        self->calm = 0;
    } else if (brakes) {
        double patience = pace < STANDSTILL ? self->par.holding_time : self->par.release_time;
        if (++self->calm * EMERGENCY_STEP >= patience) self->out.stage = STAGE_NONE;
    }
    double wanted = self->out.stage == STAGE_FULL ? self->par.full_deceleration : 0;
    self->out.deceleration =
        emergency_build_up(wanted, self->out.deceleration, self->par.build_up_jerk, self->par.release_jerk);
    self->out.brake_torque = self->par.nominal_mass * self->out.deceleration * self->par.wheel_radius;
}
