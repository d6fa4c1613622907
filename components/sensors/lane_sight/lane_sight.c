#include "lane_sight.h"

#include "../sensing/sensing.h"

#include <math.h>
#include <string.h>

#define POINTS LANE_SIGHT_POINTS

/* Range of sight along the lane. */
static double reach_of(const lane_sight *self) {
    double reach = self->par.max_range > 0 ? self->par.max_range : HUGE_VAL, dark = self->in.visibility.darkness;
    if (dark > 0 && self->par.night_range > 0 && self->par.night_range < reach) {
        reach += fmin(dark, 1) * (self->par.night_range - reach);
    }
    double lost = self->par.fog_share * self->in.visibility.fog_extinction +
                  sensing_attenuation(self->in.visibility.rain_rate, self->par.rain_loss, self->par.rain_exponent) +
                  sensing_attenuation(self->in.visibility.snow_rate, self->par.snow_loss, self->par.snow_exponent);
    double least = self->par.contrast * (1 + sensing_veil(self->in.sun.azimuth - self->in.motion.heading, self->in.sun.elevation, self->in.sun.glare));
    if (least >= 1) return 0;
    return least > 0 && lost > 0 ? fmin(reach, -log(least) / lost) : reach;
}

static int32_t count_of(const lane_sight_seen *seen) {
    int32_t n = 0;
    for (double last = 0; n < POINTS && seen->preview[n].distance > last; ++n) last = seen->preview[n].distance;
    return n;
}

/* Of *count* points those ahead and up to *reach* stay; all further ones are 0. */
static void keep(lane_sight_seen *seen, int32_t count, double reach) {
    lane_sight_point none = {0, 0, 0, 0, 0};
    int32_t kept = 0, from = 0;
    while (from < count && !(seen->preview[from].distance > 0)) ++from;
    for (; from < count && seen->preview[from].distance <= reach; ++from) seen->preview[kept++] = seen->preview[from];
    while (kept < POINTS) seen->preview[kept++] = none;
}

/* Moves all points, then turns them about the car. */
static void shift(lane_sight_seen *seen, int32_t count, double dx, double dy, double angle) {
    double c = cos(angle), s = sin(angle);
    for (int32_t i = 0; i < count; ++i) {
        lane_sight_point *point = &seen->preview[i];
        double x = point->x + dx, y = point->y + dy;
        point->x = c * x - s * y;
        point->y = s * x + c * y;
        point->heading += angle;
    }
}

static double curvature_at(const lane_sight_seen *seen, double distance) {
    double from = 0, before = seen->lane.curvature;
    for (int32_t i = 0; i < count_of(seen) && distance > from; ++i) {
        const lane_sight_point *next = &seen->preview[i];
        if (distance <= next->distance) {
            return before + (next->curvature - before) * (distance - from) / (next->distance - from);
        }
        from = next->distance;
        before = next->curvature;
    }
    return before;
}

/* The lane as seen from *along* further along it, with the same offset and heading error as before. */
static void move_along(lane_sight_seen *seen, double along) {
    const int32_t parts = 32; /* distance along the middle, where the heading turns by curvature */
    double ds = along / parts, x = 0, y = 0, angle = 0;
    for (int32_t i = 0; i < parts; ++i) {
        double curvature = curvature_at(seen, (i + 0.5) * ds), half = 0.5 * curvature * ds;
        x += ds * cos(angle + half);
        y += ds * sin(angle + half);
        angle += curvature * ds;
    }
    double turn = seen->lane.heading, offset = seen->lane.offset, curvature = curvature_at(seen, along);
    double c = cos(turn), s = sin(turn), foot_x = -offset * s, foot_y = -offset * c;
    int32_t count = count_of(seen);
    /* The foot further along goes to the foot beside the car, its direction to the direction there. */
    shift(seen, count, -foot_x - c * x - s * y, -foot_y + s * x - c * y, -angle);
    for (int32_t i = 0; i < count; ++i) {
        lane_sight_point *point = &seen->preview[i];
        point->x += foot_x;
        point->y += foot_y;
        point->distance -= along;
    }
    seen->lane.curvature = curvature;
    seen->lane.station += along;
    keep(seen, count, HUGE_VAL);
}

/* The lane as seen with errors of offset, heading (of the car relative to it) and curvature. */
static void disturb(lane_sight_seen *seen, double offset, double heading, double curvature) {
    double turn = seen->lane.heading, c = cos(turn), s = sin(turn);
    for (int32_t i = 0, count = count_of(seen); i < count; ++i) {
        lane_sight_point *point = &seen->preview[i];
        double distance = point->distance, aside = -offset - heading * distance + 0.5 * curvature * distance * distance;
        point->x += aside * s; /* to the left of the lane beside the car */
        point->y += aside * c;
        point->heading += curvature * distance - heading;
        point->curvature += curvature;
    }
    seen->lane.offset += offset;
    seen->lane.heading += heading;
    seen->lane.curvature += curvature;
}

static lane_sight_seen measured(lane_sight *self, bool is_first) {
    sensing_pair shape = sensing_normal(&self->random), bend = sensing_normal(&self->random);
    sensing_pair place = sensing_normal(&self->random);
    double missed = sensing_uniform(&self->random), reach = reach_of(self);
    double fade = is_first || !(self->par.correlation_time > 0) ? 0 : exp(-self->par.period / self->par.correlation_time);
    self->along = sensing_drifted(self->along, self->par.along_error, fade, place.first);
    self->across = sensing_drifted(self->across, self->par.across_error, fade, place.second);
    self->turn = sensing_drifted(self->turn, self->par.turn_error, fade, bend.second);
    lane_sight_seen seen = {.valid = reach >= self->par.least_range && missed > self->par.dropout, .lane = self->in.lane};
    if (!seen.valid) return seen;
    memcpy(seen.preview, self->in.preview, sizeof seen.preview);
    if (!self->par.knows_station) seen.lane.station = 0;
    if (!self->par.knows_height) seen.lane.grade = seen.lane.bank = 0;
    if (!self->par.knows_limit) seen.lane.speed_limit = 0;
    if (self->along != 0) move_along(&seen, self->along);
    double offset = self->par.offset_noise * shape.first + self->across;
    double heading = self->par.heading_noise * shape.second + self->turn, curvature = self->par.curvature_noise * bend.first;
    if (offset != 0 || heading != 0 || curvature != 0) disturb(&seen, offset, heading, curvature);
    keep(&seen, count_of(&seen), reach);
    return seen;
}

/* The last seen lane, from the car's place one step later. */
static void carry(lane_sight_seen *seen, const lane_sight_motion *from, const lane_sight_motion *to) {
    double angle = 0.5 * (from->yaw_rate + to->yaw_rate) * LANE_SIGHT_STEP, c = cos(0.5 * angle), s = sin(0.5 * angle);
    double ahead = 0.5 * (from->speed + to->speed) * LANE_SIGHT_STEP;
    double aside = 0.5 * (from->lateral_speed + to->lateral_speed) * LANE_SIGHT_STEP;
    double dx = c * ahead - s * aside, dy = s * ahead + c * aside;
    double curvature = seen->lane.curvature, stretch = fmax(1 - curvature * seen->lane.offset, 0.1);
    double turn = seen->lane.heading, ds = (dx * cos(turn) - dy * sin(turn)) / stretch;
    double middle = turn + 0.5 * (angle - curvature * ds); /* halfway */
    ds = (ahead * cos(middle) - aside * sin(middle)) / stretch;
    seen->lane.offset += ahead * sin(middle) + aside * cos(middle);
    seen->lane.curvature = curvature_at(seen, ds);
    seen->lane.heading += angle - 0.5 * (curvature + seen->lane.curvature) * ds;
    if (seen->lane.station != 0) seen->lane.station += ds;
    int32_t count = count_of(seen);
    shift(seen, count, -dx, -dy, -angle);
    for (int32_t i = 0; i < count; ++i) seen->preview[i].distance -= ds;
    keep(seen, count, HUGE_VAL);
}

static int32_t steps_of(double seconds, int32_t least) {
    int32_t steps = (int32_t)(seconds / LANE_SIGHT_STEP + 0.5);
    return steps > least ? steps : least;
}

static void restart(lane_sight *self) {
    self->random = (uint64_t)self->par.seed;
    self->along = self->across = self->turn = 0;
    self->tick = -1;
    self->told = 0;
}

void lane_sight_step(lane_sight *self) {
    int32_t every = steps_of(self->par.period, 1), late = steps_of(self->par.latency, 0), tick = ++self->tick;
    if (tick % every == 0) self->made[(tick / every + 1) % LANE_SIGHT_KEPT] = measured(self, tick == 0);
    int32_t number = tick < late ? 0 : (tick - late) / every + 1;
    const lane_sight_seen *scan = &self->made[number % LANE_SIGHT_KEPT];
    if (number != self->told) {
        self->told = number;
        if (scan->valid) {
            self->out.seen = *scan;
        } else {
            self->out.seen.valid = false;
        }
    }
    if (!self->out.seen.valid && tick > 0) carry(&self->out.seen, &self->last, &self->in.motion);
    self->last = self->in.motion;
}

void lane_sight_init(lane_sight *self) {
    memset(&self->out, 0, sizeof self->out);
    restart(self);
    lane_sight_step(self);
    restart(self); /* the first step is at time 0, too */
}
