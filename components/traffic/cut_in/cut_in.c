#include "cut_in.h"

#include <math.h>

enum { BY_TIME, BY_GAP, BY_STANDING_GAP }; /* begin */
#define OVER_HOST 1                        /* of speed_over */

static speed_profile profile_of(cut_in *self, double now) {
    bool changes = self->has_begun;
    double change_time = changes ? self->begun_at + self->par.change_delay : 0;
    if (!changes || now <= change_time) self->grip = traffic_grip(&self->in);
    speed_profile profile = {
        self->speed, change_time, changes ? fmin(self->par.change_rate, self->grip) : 0, self->par.final_speed,
    };
    return profile;
}

static bool is_due(const cut_in *self, double now) {
    double station = self->start + self->travelled, half = 0.5 * self->par.length;
    if (self->par.begin == BY_TIME) return now >= self->par.begin_time;
    if (self->par.begin == BY_STANDING_GAP) {
        return self->standing_at - 0.5 * self->par.standing_length - station - half <= self->par.begin_gap;
    }
    double front = self->in.lane.station + self->par.host_front;
    return self->sense * (traffic_ahead(self->par.lap_length, front, station - half) - self->par.begin_gap) <= 0;
}

static void output(cut_in *self, double before) {
    double now = counted_time_now(&self->time);
    speed_profile profile = profile_of(self, now);
    speed_profile_motion motion = speed_profile_at(&profile, now);
    double passed = now - before, travelled = motion.travelled - self->travelled;
    self->travelled = motion.travelled;
    if (!self->has_begun && is_due(self, now)) {
        self->has_begun = true;
        self->begun_at = self->par.begin == BY_TIME ? fmax(self->par.begin_time, before) : now;
        profile = profile_of(self, now);
        motion = speed_profile_at(&profile, now);
        self->travelled = motion.travelled;
        passed = now - self->begun_at;
        travelled = motion.travelled - self->speed * self->begun_at;
    }
    if (self->has_begun) lane_shift_advance(&self->shift, travelled, passed);
    lane_shift_pose pose = lane_shift_at(&self->shift, motion.speed);
    self->out.movers[0] = (traffic_mover){
        .id = 1,
        .class = self->par.vehicle + TRAFFIC_CAR,
        .length = self->par.length,
        .width = self->par.width,
        .height = self->par.height,
        .lane = self->par.host_lane,
        .station = self->start + motion.travelled,
        .offset = pose.offset,
        .turn = pose.turn,
        .speed = pose.speed,
        .acceleration = motion.acceleration,
    };
}

void cut_in_init(cut_in *self) {
    counted_time start = {0, 0, 0};
    double front = self->in.lane.station + self->par.host_front;
    double from = (self->par.from_lane - self->par.host_lane) * self->par.lane_width;
    double to = (self->par.to_lane - self->par.host_lane) * self->par.lane_width;
    lane_shift shift = {from, to, LANE_SHIFT_PEAK * fabs(to - from) / self->par.lateral_speed, 0};
    self->time = start;
    self->start = front + self->par.initial_gap + 0.5 * self->par.length;
    self->standing_at = front + self->par.standing_gap + 0.5 * self->par.standing_length;
    self->speed = self->par.speed + (self->par.speed_over == OVER_HOST ? self->in.motion.speed : 0);
    self->travelled = 0;
    self->sense = self->par.initial_gap < self->par.begin_gap ? -1 : 1;
    self->has_begun = false;
    self->begun_at = 0;
    self->shift = shift;
    output(self, 0);
    self->out.movers[1] = (traffic_mover){0};
    if (!self->par.standing) return;
    self->out.movers[1] = (traffic_mover){
        .id = 2,
        .class = TRAFFIC_CAR,
        .length = self->par.standing_length,
        .width = self->par.standing_width,
        .height = self->par.standing_height,
        .lane = self->par.host_lane,
        .station = self->standing_at,
    };
}

void cut_in_step(cut_in *self, double h) {
    double before = counted_time_now(&self->time);
    counted_time_advance(&self->time, h);
    output(self, before);
}
