#include "single_track.h"

#include <math.h>

#include "../shared/plane.h"

enum { X, Y, HEADING, SPEED, LATERAL, YAW, WAY, STATES };

#define MOST_LOAD 5.0 /* limit of the load on the wheels, in weights of the car */

/* Inputs and parameters in the form of the equations. */
typedef struct {
    single_track *self;
    chassis_inputs in;
    tyre tyres[2];
    plane_slopes slopes;
    double friction[2], drive[2], brake[2];
    double front, rear, share[2], cosine, sine;
} car;

static car prepare(single_track *self) {
    car c = {.self = self, .in = chassis_within_reason(&self->in, self->par.steering_limit)};
    double wheelbase = self->par.wheelbase, share = self->par.front_load_share;
    const chassis_ground *ground = c.in.ground;
    c.slopes = plane_slopes_of(ground, wheelbase);
    for (int i = 0; i < 2; ++i) {
        tyre t = {
            .law = self->par.tyre == 1 ? TYRE_LIMITED : TYRE_LINEAR,
            .radius = self->par.wheel_radius,
            .inertia = i == 0 ? self->par.inertia_front : self->par.inertia_rear,
            .rolling_resistance = self->par.rolling_resistance,
            .slip_stiffness = self->par.slip_stiffness,
            .side_stiffness = i == 0 ? self->par.cornering_stiffness_front : self->par.cornering_stiffness_rear,
            .friction = self->par.friction,
            .slip_relaxation = self->par.slip_relaxation,
            .side_relaxation = self->par.side_relaxation,
        };
        const int left = 2 * i, right = left + 1;
        c.tyres[i] = t;
        c.friction[i] = 0.5 * (ground[left].friction + ground[right].friction);
        c.drive[i] = (i == 0 ? c.in.wheels.front : c.in.wheels.rear) + c.in.wheel_torque[left] + c.in.wheel_torque[right];
        c.brake[i] = (i == 0 ? c.in.brake.front : c.in.brake.rear) + c.in.wheel_brake[left] + c.in.wheel_brake[right];
    }
    c.front = (1 - share) * wheelbase;
    c.rear = share * wheelbase;
    c.share[0] = share;
    c.share[1] = 1 - share;
    c.cosine = cos(c.in.steering);
    c.sine = sin(c.in.steering);
    return c;
}

static double positive(double load) {
    return load > 0 ? load : 0;
}

static void stage(void *context, double gh, const wheel *base, const wheel *before, ars_state *at) {
    const car *c = context;
    single_track *self = c->self;
    double *y = at->body, u = y[SPEED], v = y[LATERAL], r = y[YAW], mass = self->par.mass;
    plane p = plane_below(y[HEADING], &c->slopes);
    double weight = mass * chassis_limited(CHASSIS_GRAVITY * p.up + u * u * p.bend, 0, MOST_LOAD * CHASSIS_GRAVITY);

    wheel_stage s[2];
    double pull[2]; /* along the car, per load */
    for (int i = 0; i < 2; ++i) {
        double side = v + (i == 0 ? c->front : -c->rear) * r;
        double along = i == 0 ? u * c->cosine + side * c->sine : u, across = i == 0 ? side * c->cosine - u * c->sine : side;
        s[i].tyre = tyre_under(&c->tyres[i], c->share[i] * weight, c->friction[i]);
        s[i].gh = gh;
        s[i].base = base[i];
        s[i].guess = at->wheel[i];
        s[i].before = before[i].spin;
        s[i].drive = c->drive[i];
        s[i].brake = c->brake[i];
        wheel_touch(&s[i], &c->tyres[i], along, across);
        tyre_grip grip = tyre_grip_at(&c->tyres[i], &s[i].tyre, s[i].slip + s[i].slip_by_spin * s[i].guess.spin, s[i].side);
        pull[i] = i == 0 ? grip.x * c->cosine - grip.y * c->sine : grip.x;
    }
    double per_length = self->par.cg_height / self->par.wheelbase;
    double total = (pull[0] * c->share[0] + pull[1] * c->share[1]) * weight / positive(1 + per_length * (pull[0] - pull[1]));
    s[0].load = positive(c->share[0] * weight - per_length * total);
    s[1].load = positive(c->share[1] * weight + per_length * total);

    wheel_result w[2];
    for (int i = 0; i < 2; ++i) {
        w[i] = wheel_turn(&s[i], &c->tyres[i]);
        at->wheel[i] = w[i].end;
        self->load[i] = s[i].load;
    }
    double front_x = w[0].x * c->cosine - w[0].y * c->sine, front_y = w[0].x * c->sine + w[0].y * c->cosine, wind;
    double drag = plane_air_force(&p, &c->in.air, u, v, self->par.drag_area, self->par.side_area, &wind);
    double ahead = (front_x + w[1].x + drag) / mass - CHASSIS_GRAVITY * p.ahead[2];
    double left = (front_y + w[1].y + wind) / mass - CHASSIS_GRAVITY * p.left[2];
    self->acceleration = ahead;
    self->lateral_acceleration = left;
    double *rates = at->rates;
    rates[X] = u * p.ahead[0] + v * p.left[0];
    rates[Y] = u * p.ahead[1] + v * p.left[1];
    rates[HEADING] = r * p.turn + u * p.drift;
    rates[SPEED] = ahead + v * r;
    rates[LATERAL] = left - u * r;
    rates[YAW] = (c->front * front_y - c->rear * w[1].y + self->par.side_lever * wind) / self->par.yaw_inertia;
    rates[WAY] = copysign(sqrt(u * u + v * v), u);
}

static void output(single_track *self, const car *c) {
    const double *y = self->state.body;
    chassis_outputs *out = &self->out;
    plane p = plane_below(y[HEADING], &c->slopes);
    double half = 0.5 * self->par.track;
    double ahead[4] = {c->front, c->front, -c->rear, -c->rear}, left[4] = {half, -half, half, -half};
    plane_contacts(&p, y[X], y[Y], ahead, left, out->contacts);
    plane_attitude(&p, &out->roll, &out->pitch);
    chassis_tell_motion(out, y, self->acceleration, self->lateral_acceleration);
    out->wheel_speed.front = self->state.wheel[0].spin;
    out->wheel_speed.rear = self->state.wheel[1].spin;
    for (int i = 0; i < 4; ++i) {
        out->wheel_speeds[i] = self->state.wheel[i / 2].spin;
        out->load[i] = 0.5 * self->load[i / 2];
    }
}

void single_track_init(single_track *self) {
    car c = prepare(self);
    double speed = chassis_start_speed(&c.in, self->par.initial_speed), spin = speed / self->par.wheel_radius;
    ars_state start = {
        .states = STATES,
        .wheels = 2,
        .body = {c.in.start.x, c.in.start.y, c.in.start.heading, speed},
        .wheel = {{spin, 0, 0}, {spin, 0, 0}},
    };
    self->state = start;
    ars_rates(&c, stage, &self->state);
    output(self, &c);
}

void single_track_step(single_track *self, double h) {
    car c = prepare(self);
    ars_advance(&c, stage, &self->state, h, self->par.substeps);
    output(self, &c);
}
