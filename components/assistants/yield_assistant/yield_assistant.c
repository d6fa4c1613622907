#include "yield_assistant.h"

#include <math.h>

#define STANDSTILL 0.1   /* m/s */
#define ALONG 0.8660254  /* cosine of 30 degrees */
#define NEAREST 0.01     /* m: lower bound of a remaining distance */

/* The action for the light. *room* is the distance available for stopping. */
static int32_t light_at(const yield_assistant *self, double room) {
    light_case is = {
        self->in.light.distance, self->light_distance, room, self->in.motion.speed, self->par.yellow_deceleration,
        self->par.front_length,
    };
    return light_choice(self->light, self->in.light.colour, &is);
}

typedef struct {
    double x, y;
} point;

/* The lane point at that distance ahead, in the car's axes. */
static point point_ahead(const yield_assistant_in *in, double distance) {
    double c = cos(in->lane.heading), s = sin(in->lane.heading);
    point last = {in->lane.offset * s * -1, -in->lane.offset * c}, ahead = {c, -s};
    double at = 0;
    for (int i = 0; i < YIELD_POINTS && in->preview[i].distance > at; ++i) {
        double part = (distance - at) / (in->preview[i].distance - at);
        point next = {in->preview[i].x, in->preview[i].y};
        if (part <= 1) {
            point there = {last.x + part * (next.x - last.x), last.y + part * (next.y - last.y)};
            return there;
        }
        last = next;
        at = in->preview[i].distance;
        ahead.x = cos(in->preview[i].heading);
        ahead.y = sin(in->preview[i].heading);
    }
    point there = {last.x + (distance - at) * ahead.x, last.y + (distance - at) * ahead.y};
    return there;
}

/* The interval in which it occupies a conflict; *since* greater than *until*: never. */
typedef struct {
    double since, until;
} span;

static span never(void) {
    span none = {HUGE_VAL, -HUGE_VAL};
    return none;
}

/* The time to cover a distance with constant acceleration. */
static double time_for(double way, double speed, double rate) {
    if (way <= 0) return 0;
    if (rate > 0) return (sqrt(speed * speed + 2 * rate * way) - speed) / rate;
    return speed > 0 ? way / speed : HUGE_VAL;
}

/* An object whose path through the *middle* of the conflict is *length* long. */
static span span_of(const yield_assistant *self, int index, point middle, double length) {
    const yield_assistant_in *in = &self->in;
    double vx = in->tracks[index].vx, vy = in->tracks[index].vy, speed = hypot(vx, vy);
    if (in->tracks[index].id == 0 || speed < self->par.min_speed) return never();
    double ux = vx / speed, uy = vy / speed, c = cos(in->lane.heading), s = -sin(in->lane.heading);
    double dx = middle.x - in->tracks[index].x, dy = middle.y - in->tracks[index].y;
    double along = dx * ux + dy * uy, aside = fabs(dx * uy - dy * ux);
    double with_host = ux * c + uy * s, from_side = fabs(ux * s - uy * c);
    double tolerance = self->par.aside_tolerance + self->par.bend_tolerance * fmax(along, 0) * from_side;
    double leaves = along + 0.5 * length + self->par.other_length;
    if (with_host > ALONG || leaves < 0 || aside > tolerance) return never();
    span found = {fmax(along - 0.5 * length, 0) / speed, leaves / speed};
    return found;
}

/* Whether the car has to wait for another road user before it enters. */
static bool has_to_wait(const yield_assistant *self, int index, double way) {
    const yield_assistant_in *in = &self->in;
    double length = in->conflicts[index].exit - in->conflicts[index].entry;
    point middle = point_ahead(in, way + self->par.front_length + 0.5 * length);
    double speed = fmax(in->motion.speed, 0), rate = self->waits[index] ? self->par.start_acceleration : 0;
    double margin = self->par.time_margin + (self->waits[index] ? self->par.release_margin : 0);
    double whole = way + length + self->par.front_length + self->par.rear_length;
    span own = {time_for(way, speed, rate), time_for(whole, speed, rate)};
    for (int i = 0; i < YIELD_TRACKS; ++i) {
        span other = span_of(self, i, middle, in->conflicts[index].other_exit - in->conflicts[index].other_entry);
        if (other.since < own.until + margin && own.since < other.until + margin) return true;
    }
    return false;
}

/* The station where the car's front stops before a conflict, so that the car blocks no other conflict. */
static double stopping_place(const yield_assistant *self, int index) {
    const yield_assistant_in *in = &self->in;
    double length = self->par.front_length + self->par.rear_length;
    double place = in->conflicts[index].entry - self->par.stop_gap;
    for (int round = 0; round < YIELD_CONFLICTS; ++round) {
        double before = place;
        for (int i = 0; i < YIELD_CONFLICTS; ++i) {
            double entry = in->conflicts[i].entry, exit = in->conflicts[i].exit;
            bool stands_in = in->conflicts[i].path == 0 && exit > place - length && entry < place && exit > entry;
            if (stands_in) place = entry - self->par.stop_gap;
        }
        if (place == before) break;
    }
    return place;
}

/* The deceleration for a stop after *room* m: 0 while there is still time; a car that *brakes* continues to brake. */
static double stop_in(const yield_assistant *self, double room, bool brakes) {
    double speed = fmax(self->in.motion.speed, 0), even = 0.5 * speed * speed / fmax(room, NEAREST);
    if (speed < STANDSTILL && room < self->par.stop_gap) return self->par.comfort_deceleration; /* held */
    if (even < self->par.comfort_deceleration && !brakes) return 0;
    return fmin(even, self->par.max_deceleration);
}

static void hear(double wanted, int32_t reason, double *most, int32_t *told) {
    if (wanted <= *most) return;
    *most = wanted;
    *told = reason;
}

void yield_assistant_init(yield_assistant *self) {
    self->light = LIGHT_FREE;
    self->light_distance = self->in.light.distance;
    for (int i = 0; i < YIELD_CONFLICTS; ++i) self->waits[i] = false;
    self->out.deceleration = 0;
    self->out.brake_torque = 0;
    self->out.reason = REASON_NONE;
}

void yield_assistant_step(yield_assistant *self) {
    const yield_assistant_in *in = &self->in;
    double wanted = 0, square = 0.5 * in->motion.speed * in->motion.speed;
    int32_t reason = REASON_NONE, before = self->out.reason;
    double room = in->light.distance - self->par.front_length - self->par.stop_gap;
    self->light = light_at(self, room);
    self->light_distance = in->light.distance;
    if (self->light == LIGHT_STOPS) hear(stop_in(self, room, before == REASON_LIGHT), REASON_LIGHT, &wanted, &reason);

    for (int i = 0; i < YIELD_CONFLICTS; ++i) {
        double way = in->conflicts[i].entry - in->lane.station - self->par.front_length;
        bool is_ahead = in->conflicts[i].exit > in->conflicts[i].entry && way > 0;
        bool is_meant = is_ahead && in->conflicts[i].path == 0 && in->conflicts[i].gives_way;
        if (!is_meant) {
            self->waits[i] = false;
            continue;
        }
        double left = stopping_place(self, i) - in->lane.station - self->par.front_length;
        bool may_stop = self->waits[i] || square <= self->par.max_deceleration * fmax(left, 0);
        bool waits = may_stop && has_to_wait(self, i, way);
        double needed = waits ? stop_in(self, left, self->waits[i]) : 0;
        self->waits[i] = waits && needed > 0;
        hear(needed, REASON_YIELD, &wanted, &reason);
    }
    double change = self->par.jerk * YIELD_STEP, last = self->out.deceleration;
    self->out.deceleration = fmax(fmin(wanted, last + change), fmax(last - change, 0));
    self->out.brake_torque = self->par.nominal_mass * self->out.deceleration * self->par.wheel_radius;
    self->out.reason = wanted > 0 ? reason : REASON_NONE;
}
