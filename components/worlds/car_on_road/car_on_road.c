#include "car_on_road.h"

#include <math.h>

/* Sums over the parts. In the initialization parts may not have set their outputs yet: the sums must not be zero. */
static void assemble(car_on_road *self) {
    const straight_road_axles *loads[] = {
        &self->in.loads.body,  &self->in.loads.aero,    &self->in.loads.tyres,   &self->in.loads.wheels,
        &self->in.loads.discs, &self->in.loads.climate, &self->in.loads.battery, &self->in.loads.drive,
    };
    const straight_road_axles *inertias[] = {
        &self->in.inertias.tyres, &self->in.inertias.wheels, &self->in.inertias.discs, &self->in.inertias.drive,
    };
    double mass = self->par.payload, front = self->par.payload_front_share * mass;
    for (int i = 0; i < 8; ++i) {
        mass += loads[i]->front + loads[i]->rear;
        front += loads[i]->front;
    }
    straight_road_axles inertia = {0, 0};
    for (int i = 0; i < 4; ++i) {
        inertia.front += inertias[i]->front;
        inertia.rear += inertias[i]->rear;
    }
    self->out.mass = mass;
    self->out.front_share = mass > 0 ? front / mass : 0.5;
    straight_road *road = &self->road;
    road->par.mass = fmax(mass, 1);
    road->par.front_load_share = self->out.front_share;
    road->par.inertia_front = fmax(inertia.front, 0.01);
    road->par.inertia_rear = fmax(inertia.rear, 0.01);
    road->par.drag_area = self->in.drag_areas.aero + self->in.drag_areas.wheels;
    road->par.wheel_radius = fmax(self->in.tyre.radius, 0.01);
    road->par.friction = fmax(self->par.surface * self->in.tyre.grip, 0.01);
    road->par.slip_stiffness = fmax(self->in.tyre.stiffness, 0.1);
    road->par.rolling_resistance = self->in.tyre.rolling_resistance;
    road->par.cg_height = self->par.cg_height;
    road->par.wheelbase = fmax(self->par.wheelbase, 0.1);
    road->in.wheels = self->in.wheels;
    road->in.brake = self->in.brake;
}

static void scenario(car_on_road *self) {
    straight_road *road = &self->road;
    road->par.initial_speed = self->par.initial_speed;
    road->par.initial_gap = self->par.initial_gap;
    road->par.lead_speed = self->par.lead_speed;
    road->par.lead_change_time = self->par.lead_change_time;
    road->par.lead_change_rate = self->par.lead_change_rate;
    road->par.lead_final_speed = self->par.lead_final_speed;
    road->par.lead_width = 1.8;
    road->par.lead_length = 4.5;
    road->par.grade = self->par.grade;
    road->par.air_density = self->par.air_density;
    road->par.ray_angle = self->par.ray_angle;
    road->par.ray_reach = self->par.ray_reach;
    road->par.ray_count = self->par.ray_count;
    road->par.substeps = self->par.substeps;
}

static void output(car_on_road *self) {
    const straight_road *road = &self->road;
    self->out.wheel_speed = road->out.wheel_speed;
    self->out.speed = road->out.speed;
    self->out.position = road->out.position;
    self->out.acceleration = road->out.acceleration;
    self->out.jerk = (road->out.acceleration - self->smooth_acceleration) / CAR_ON_ROAD_SMOOTHING;
    self->out.gap = road->out.gap;
    self->out.closing_speed = road->out.closing_speed;
    self->out.lead.speed = road->out.lead.speed;
    self->out.scene.range = road->out.scene.range;
    self->out.scene.azimuth = road->out.scene.azimuth;
    self->out.scene.closing_speed = road->out.scene.closing_speed;
    self->out.scene.hit = road->out.scene.hit;
    self->out.collision = road->out.collision;
}

void car_on_road_init(car_on_road *self) {
    assemble(self);
    scenario(self);
    straight_road_init(&self->road);
    self->smooth_acceleration = self->road.out.acceleration;
    output(self);
}

void car_on_road_step(car_on_road *self, double h) {
    assemble(self);
    scenario(self);
    straight_road_step(&self->road, h);
    /* Exact for an acceleration held over h. */
    double rest = exp(-h / CAR_ON_ROAD_SMOOTHING);
    self->smooth_acceleration = self->road.out.acceleration + (self->smooth_acceleration - self->road.out.acceleration) * rest;
    output(self);
}
