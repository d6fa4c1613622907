#include "longitudinal.h"

#include <math.h>

#include "../shared/plane.h"

static host_data data(const longitudinal *self, const chassis_inputs *in, const plane *p) {
    const double *torque = in->wheel_torque, *brake = in->wheel_brake;
    const chassis_ground *ground = in->ground;
    host_data host = {
        .mass = self->par.mass,
        .front_load_share = self->par.front_load_share,
        .cg_height = self->par.cg_height,
        .wheelbase = self->par.wheelbase,
        .wheel_radius = self->par.wheel_radius,
        .inertia_front = self->par.inertia_front,
        .inertia_rear = self->par.inertia_rear,
        .drag_area = self->par.drag_area,
        .air_density = in->air.density,
        .wind = in->air.wind_x * p->ahead[0] + in->air.wind_y * p->ahead[1],
        .rolling_resistance = self->par.rolling_resistance,
        .grade = p->ahead[2] / sqrt(1 - p->ahead[2] * p->ahead[2]),
        .friction_front = self->par.friction * 0.5 * (ground[0].friction + ground[1].friction),
        .friction_rear = self->par.friction * 0.5 * (ground[2].friction + ground[3].friction),
        .slip_stiffness = self->par.slip_stiffness,
        .drive_front = in->wheels.front + torque[0] + torque[1],
        .drive_rear = in->wheels.rear + torque[2] + torque[3],
        .brake_front = in->brake.front + brake[0] + brake[1],
        .brake_rear = in->brake.rear + brake[2] + brake[3],
    };
    return host;
}

static void output(longitudinal *self, const chassis_inputs *in, const host_data *host, const plane *p) {
    double front = (1 - self->par.front_load_share) * self->par.wheelbase, rear = self->par.wheelbase - front;
    double half = 0.5 * self->par.track, speed = self->host.speed, curvature = tan(in->steering) / self->par.wheelbase;
    double yaw_rate = speed * curvature;
    double ahead[4] = {front, front, -rear, -rear}, left[4] = {half, -half, half, -half};
    chassis_outputs *out = &self->out;
    out->motion.x = self->x;
    out->motion.y = self->y;
    out->motion.heading = self->heading;
    out->speed = out->motion.speed = speed;
    out->motion.lateral_speed = rear * yaw_rate;
    out->motion.yaw_rate = yaw_rate;
    out->acceleration = self->host.slope[0];
    out->motion.acceleration = self->host.slope[0] - rear * yaw_rate * yaw_rate;
    out->motion.lateral_acceleration = speed * yaw_rate + rear * curvature * self->host.slope[0];
    out->position = self->position;
    plane_attitude(p, &out->roll, &out->pitch);
    plane_contacts(p, self->x, self->y, ahead, left, out->contacts);
    out->wheel_speed.front = self->host.spin_front;
    out->wheel_speed.rear = self->host.spin_rear;
    double cosine = 1 / sqrt(1 + host->grade * host->grade), weight = host->mass * CHASSIS_GRAVITY * cosine;
    double air = speed - host->wind;
    double force = host->mass * self->host.slope[0] + 0.5 * host->air_density * host->drag_area * air * fabs(air) + weight * host->grade;
    double transfer = force * host->cg_height / host->wheelbase;
    for (int i = 0; i < 4; ++i) {
        out->wheel_speeds[i] = i < 2 ? self->host.spin_front : self->host.spin_rear;
        out->load[i] = 0.5 * (i < 2 ? host->front_load_share * weight - transfer : (1 - host->front_load_share) * weight + transfer);
    }
}

void longitudinal_init(longitudinal *self) {
    chassis_inputs in = chassis_within_reason(&self->in, self->par.steering_limit);
    self->x = in.start.x;
    self->y = in.start.y;
    self->heading = in.start.heading;
    self->position = 0;
    plane_slopes slopes = plane_slopes_of(in.ground, self->par.wheelbase);
    plane p = plane_below(self->heading, &slopes);
    host_data host = data(self, &in, &p);
    host_start(&self->host, &host, chassis_start_speed(&self->in, self->par.initial_speed));
    output(self, &in, &host, &p);
}

void longitudinal_step(longitudinal *self, double h) {
    chassis_inputs in = chassis_within_reason(&self->in, self->par.steering_limit);
    plane_slopes slopes = plane_slopes_of(in.ground, self->par.wheelbase);
    plane before = plane_below(self->heading, &slopes);
    host_data host = data(self, &in, &before);
    double from = self->host.position, curvature = tan(in.steering) / self->par.wheelbase;
    host_advance(&self->host, &host, h, self->par.substeps);
    double way = self->host.position - from, rear = self->par.front_load_share * self->par.wheelbase;
    /* Chord of an arc: arc length times sin(a) / a, with a half the turn, in the mean direction of both headings. */
    double half = 0.5 * curvature * way, chord = fabs(half) > 1e-4 ? way * sin(half) / half : way * (1 - half * half / 6);
    half = half * before.turn + 0.5 * way * before.drift;
    plane between = plane_below(self->heading + half, &slopes);
    self->heading += 2 * half;
    plane after = plane_below(self->heading, &slopes);
    self->x += chord * between.ahead[0] + rear * (after.ahead[0] - before.ahead[0]);
    self->y += chord * between.ahead[1] + rear * (after.ahead[1] - before.ahead[1]);
    self->position += way * sqrt(1 + rear * curvature * rear * curvature);
    output(self, &in, &host, &after);
}
