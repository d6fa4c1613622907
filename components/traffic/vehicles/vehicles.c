#include "vehicles.h"

#include <math.h>

static void output(vehicles *self) {
    double now = counted_time_now(&self->time);
    for (int32_t i = 0; i < TRAFFIC_MOVERS; ++i) {
        if (self->par.class[i] == 0) continue;
        if (now <= self->par.change_time[i]) self->grip[i] = traffic_grip(&self->in);
        speed_profile profile = {
            self->par.speed[i], self->par.change_time[i], fmin(self->par.change_rate[i], self->grip[i]),
            self->par.final_speed[i],
        };
        speed_profile_motion motion = speed_profile_at(&profile, now);
        self->out.movers[i] = (traffic_mover){
            .id = i + 1,
            .class = self->par.class[i],
            .length = self->par.length[i],
            .width = self->par.width[i],
            .height = self->par.height[i],
            .clearance = self->par.clearance[i],
            .path = self->par.path[i],
            .lane = self->par.lane_number[i],
            .station = self->par.station[i] + self->ahead[i] * motion.travelled,
            .offset = self->par.offset[i] + self->aside[i] * motion.travelled,
            .turn = self->par.turn[i],
            .speed = motion.speed,
            .acceleration = motion.acceleration,
        };
    }
}

void vehicles_init(vehicles *self) {
    counted_time start = {0, 0, 0};
    self->time = start;
    for (int32_t i = 0; i < TRAFFIC_MOVERS; ++i) {
        self->out.movers[i] = (traffic_mover){0};
        self->ahead[i] = cos(self->par.turn[i]);
        self->aside[i] = sin(self->par.turn[i]);
    }
    output(self);
}

void vehicles_step(vehicles *self, double h) {
    counted_time_advance(&self->time, h);
    output(self);
}
