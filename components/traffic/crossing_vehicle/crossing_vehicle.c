#include "crossing_vehicle.h"

#include <math.h>

#define OBEYS 1 /* of manners */
#define MOST_USED 0.5 /* share of the grip: a vehicle brakes with twice its deceleration at most */

/* The first conflict of its path with the host's path. */
static void look_up(crossing_vehicle *self) {
    for (int32_t i = 0; i < TRAFFIC_CONFLICTS && !self->is_known; ++i) {
        bool is_there = self->in.conflicts[i].exit > self->in.conflicts[i].entry;
        if (!is_there || self->in.conflicts[i].path != self->par.path || self->in.conflicts[i].other_path != 0) continue;
        self->is_known = true;
        self->entry = self->in.conflicts[i].entry;
        self->middle = 0.5 * (self->in.conflicts[i].entry + self->in.conflicts[i].exit);
        self->host_middle = 0.5 * (self->in.conflicts[i].other_entry + self->in.conflicts[i].other_exit);
        self->host_exit = self->in.conflicts[i].other_exit;
        self->gives_way = self->in.conflicts[i].gives_way;
    }
}

static speed_profile_motion motion_at(const crossing_phase *phase, double now) {
    double time = fmax(now - phase->since, 0), change = phase->final_speed - phase->speed;
    double ramp = phase->rate > 0 ? fabs(change) / phase->rate : 0, sense = change < 0 ? -1 : 1;
    speed_profile_motion motion = {phase->from, phase->final_speed, 0};
    if (time < ramp) {
        motion.speed = phase->speed + sense * phase->rate * time;
        motion.acceleration = sense * phase->rate;
        motion.travelled += 0.5 * (phase->speed + motion.speed) * time;
    } else {
        motion.travelled += 0.5 * (phase->speed + phase->final_speed) * ramp + phase->final_speed * (time - ramp);
    }
    return motion;
}

static void begin(crossing_vehicle *self, double moment, speed_profile_motion from, double rate, double final_speed) {
    crossing_phase phase = {moment, from.travelled, from.speed, rate, final_speed};
    self->phase = phase;
}

static double acceleration_of(const crossing_vehicle *self) {
    return fmin(self->par.acceleration, traffic_grip(&self->in));
}

/* Its predicted start time; never for a host that is at rest or has passed. */
static double due(const crossing_vehicle *self, double now) {
    double way = self->middle - 0.5 * self->par.length - self->par.station;
    double v = self->par.speed, a = acceleration_of(self);
    if (!(way >= 0)) return NAN; /* its initial place is beyond the conflict: fails the run */
    double lead = way < 0.5 * v * v / a ? sqrt(2 * way / a) : way / v + 0.5 * v / a;
    double ahead = self->host_middle - self->in.lane.station - self->par.host_front, speed = self->in.motion.speed;
    return speed > 0 && ahead >= 0 ? now + ahead / speed + self->par.delay - lead : HUGE_VAL;
}

/* Distance from the front of the vehicle to the nearest stop position; infinite if there is none. */
static double room(const crossing_vehicle *self, double station) {
    double front = station + 0.5 * self->par.length, least = HUGE_VAL;
    bool host_is_past = self->in.lane.station - self->par.host_rear > self->host_exit;
    if (self->par.manners != OBEYS) return least;
    if (self->gives_way && !host_is_past && front <= self->entry) least = self->entry - self->par.stop_gap - front;
    for (int32_t i = 0; i < TRAFFIC_HEADS; ++i) {
        int32_t colour = self->in.light_heads[i].colour;
        double to = self->in.light_heads[i].station - front;
        bool stops = colour == TRAFFIC_RED || colour == TRAFFIC_RED_YELLOW || colour == TRAFFIC_YELLOW;
        if (stops && self->in.light_heads[i].path == self->par.path && to >= 0) {
            least = fmin(least, to - self->par.stop_gap);
        }
    }
    return least;
}

/* Brakes, waits and continues. */
static void mind(crossing_vehicle *self, double now) {
    speed_profile_motion motion = motion_at(&self->phase, now);
    double left = room(self, motion.travelled), square = 0.5 * motion.speed * motion.speed;
    double grip = traffic_grip(&self->in), rate = fmin(self->par.deceleration, MOST_USED * grip);
    bool goes = self->phase.final_speed > 0;
    if (goes && square >= rate * left && square <= 2 * rate * fmax(left, 0)) {
        begin(self, now, motion, fmin(left > 0 && square > 0 ? square / left : rate, grip), 0);
    } else if (!goes && isinf(left)) {
        begin(self, now, motion, acceleration_of(self), self->par.speed);
    }
}

static void output(crossing_vehicle *self, double earliest) {
    double now = counted_time_now(&self->time), nowhere = 0;
    look_up(self);
    if (self->is_known && !self->has_set_out) {
        double moment = due(self, now);
        self->has_set_out = !(moment > now);
        if (self->has_set_out) {
            speed_profile_motion standing = {self->par.station, 0, 0};
            begin(self, fmax(moment, earliest), standing, acceleration_of(self), self->par.speed);
            nowhere = moment - moment; /* not a number: it cannot start */
        }
    }
    if (self->has_set_out) mind(self, now);
    speed_profile_motion motion = motion_at(&self->phase, now);
    self->out.movers[0] = (traffic_mover){
        .id = 1,
        .class = self->par.vehicle + TRAFFIC_CAR,
        .length = self->par.length,
        .width = self->par.width,
        .height = self->par.height,
        .path = self->par.path,
        .station = isnan(nowhere) || (!self->is_known && now > 0) ? NAN : motion.travelled,
        .speed = motion.speed,
        .acceleration = motion.acceleration,
    };
}

void crossing_vehicle_init(crossing_vehicle *self) {
    counted_time start = {0, 0, 0};
    speed_profile_motion standing = {self->par.station, 0, 0};
    self->time = start;
    self->has_set_out = self->is_known = self->gives_way = false;
    begin(self, 0, standing, 0, 0);
    output(self, -HUGE_VAL);
}

void crossing_vehicle_step(crossing_vehicle *self, double h) {
    double before = counted_time_now(&self->time);
    counted_time_advance(&self->time, h);
    output(self, before);
}
