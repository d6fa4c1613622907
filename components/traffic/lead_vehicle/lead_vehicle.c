#include "lead_vehicle.h"

static void output(lead_vehicle *self) {
    double now = counted_time_now(&self->time);
    if (now <= self->par.lead_change_time) self->grip = traffic_grip(&self->in);
    speed_profile profile = {
        self->par.lead_speed, self->par.lead_change_time, fmin(self->par.lead_change_rate, self->grip),
        self->par.lead_final_speed,
    };
    speed_profile_motion motion = speed_profile_at(&profile, now);
    self->out.movers[0] = (traffic_mover){
        .id = 1,
        .class = TRAFFIC_CAR,
        .length = self->par.lead_length,
        .width = self->par.lead_width,
        .height = self->par.lead_height,
        .lane = self->par.lead_lane,
        .station = self->start + motion.travelled,
        .offset = self->par.lead_offset,
        .speed = motion.speed,
        .acceleration = motion.acceleration,
    };
}

void lead_vehicle_init(lead_vehicle *self) {
    counted_time start = {0, 0, 0};
    self->time = start;
    self->start = self->in.lane.station + self->par.host_front + self->par.initial_gap + 0.5 * self->par.lead_length;
    output(self);
}

void lead_vehicle_step(lead_vehicle *self, double h) {
    counted_time_advance(&self->time, h);
    output(self);
}
