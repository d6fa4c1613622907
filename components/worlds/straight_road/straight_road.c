#include "straight_road.h"

#include <math.h>

/* The lead keeps its speed, changes it once at a constant rate, and keeps the new one. */
static speed_profile_motion lead_motion(const straight_road *self) {
    speed_profile profile = {
        self->par.lead_speed, self->par.lead_change_time, self->par.lead_change_rate, self->par.lead_final_speed,
    };
    return speed_profile_at(&profile, counted_time_now(&self->time));
}

static host_data data(const straight_road *self) {
    host_data host = {
        .mass = self->par.mass,
        .front_load_share = self->par.front_load_share,
        .cg_height = self->par.cg_height,
        .wheelbase = self->par.wheelbase,
        .wheel_radius = self->par.wheel_radius,
        .inertia_front = self->par.inertia_front,
        .inertia_rear = self->par.inertia_rear,
        .drag_area = self->par.drag_area,
        .air_density = self->par.air_density,
        .rolling_resistance = self->par.rolling_resistance,
        .grade = self->par.grade,
        .friction_front = self->par.friction,
        .friction_rear = self->par.friction,
        .slip_stiffness = self->par.slip_stiffness,
        .drive_front = self->in.wheels.front,
        .drive_rear = self->in.wheels.rear,
        .brake_front = self->in.brake.front,
        .brake_rear = self->in.brake.rear,
    };
    return host;
}

static void output(straight_road *self) {
    speed_profile_motion lead = lead_motion(self);
    double gap = self->par.initial_gap + lead.travelled - self->host.position;
    double closing_speed = self->host.speed - lead.speed;
    ray_fan_box box = {
        gap, gap + self->par.lead_length,
        self->par.lead_offset - 0.5 * self->par.lead_width, self->par.lead_offset + 0.5 * self->par.lead_width,
    };
    ray_fan_echo echo = ray_fan_cast(&self->rays, &box, self->par.ray_reach);
    self->out.wheel_speed.front = self->host.spin_front;
    self->out.wheel_speed.rear = self->host.spin_rear;
    self->out.speed = self->host.speed;
    self->out.position = self->host.position;
    self->out.acceleration = self->host.slope[0];
    self->out.gap = gap;
    self->out.closing_speed = closing_speed;
    self->out.lead.speed = lead.speed;
    self->out.scene.range = echo.range;
    self->out.scene.azimuth = echo.azimuth;
    self->out.scene.closing_speed = echo.hit ? closing_speed * cos(echo.azimuth) : 0;
    self->out.scene.hit = echo.hit;
    /* Contact has no mechanics here: the gap continues below zero, and the flag reports the contact. */
    bool beside = box.right > 0.5 * self->par.lead_width || box.left < -0.5 * self->par.lead_width;
    if (gap <= 0 && !beside) self->out.collision = true;
}

void straight_road_init(straight_road *self) {
    host_data host = data(self);
    host_start(&self->host, &host, self->par.initial_speed);
    ray_fan_aim(&self->rays, self->par.ray_count, self->par.ray_angle);
    counted_time start = {0, 0, 0};
    self->time = start;
    self->out.collision = false;
    output(self);
}

void straight_road_step(straight_road *self, double h) {
    host_data host = data(self);
    host_advance(&self->host, &host, h, self->par.substeps);
    counted_time_advance(&self->time, h);
    output(self);
}
