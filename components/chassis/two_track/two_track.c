#include "two_track.h"

#include <math.h>

#include "../shared/plane.h"

enum { X, Y, HEADING, SPEED, LATERAL, YAW, WAY, HEIGHT, ROLL, PITCH, HEAVE, ROLL_RATE, PITCH_RATE, STATES };

#define MOST_LOAD 3.0 /* limit of a wheel load, in weights of the car */

/* Inputs and parameters in the form of the equations. */
typedef struct {
    two_track *self;
    chassis_inputs in;
    tyre tyres[2];
    plane_slopes slopes;
    double ahead[4], left[4], cosine[4], sine[4], drive[4], brake[4];
    double rest[2], spring[2], damper[2], anti_roll[2], lock[2];
    chassis_contact from[4]; /* where the ground was given */
} car;

static tyre tyre_of(const two_track *self, double inertia) {
    tyre t = {
        .law = TYRE_MAGIC,
        .radius = self->par.wheel_radius,
        .inertia = inertia,
        .rolling_resistance = self->par.rolling_resistance,
        .slip_stiffness = self->par.tyre.pkx1,
        .side_stiffness = self->par.tyre.pky1,
        .friction = self->par.tyre.grip,
        .slip_relaxation = self->par.tyre.slip_relaxation,
        .side_relaxation = self->par.tyre.side_relaxation,
        .nominal_load = self->par.tyre.nominal_load,
        .slip_stiffness_load = self->par.tyre.pkx2,
        .slip_stiffness_exponent = self->par.tyre.pkx3,
        .side_stiffness_peak = self->par.tyre.pky2,
        .along = {
            self->par.tyre.pcx1, self->par.tyre.pdx1, self->par.tyre.pdx2, self->par.tyre.pex1,
            self->par.tyre.rbx1, self->par.tyre.rbx2, self->par.tyre.rcx1, self->par.tyre.rex1,
        },
        .across = {
            self->par.tyre.pcy1, self->par.tyre.pdy1, self->par.tyre.pdy2, self->par.tyre.pey1,
            self->par.tyre.rby1, self->par.tyre.rby2, self->par.tyre.rcy1, self->par.tyre.rey1,
        },
    };
    return t;
}

static car prepare(two_track *self) {
    car c = {.self = self, .in = chassis_within_reason(&self->in, self->par.steering_limit)};
    double wheelbase = self->par.wheelbase, share = self->par.front_load_share, steering = tan(c.in.steering);
    double weight = self->par.mass * CHASSIS_GRAVITY;
    c.slopes = plane_slopes_of(c.in.ground, wheelbase);
    for (int axle = 0; axle < 2; ++axle) {
        int is_front = axle == 0;
        double torque = is_front ? c.in.wheels.front : c.in.wheels.rear, brake = is_front ? c.in.brake.front : c.in.brake.rear;
        double half = 0.5 * (is_front ? self->par.track_front : self->par.track_rear);
        c.tyres[axle] = tyre_of(self, 0.5 * (is_front ? self->par.inertia_front : self->par.inertia_rear));
        c.rest[axle] = 0.5 * weight * (is_front ? share : 1 - share);
        c.spring[axle] = is_front ? self->par.spring_front : self->par.spring_rear;
        c.damper[axle] = is_front ? self->par.damper_front : self->par.damper_rear;
        c.anti_roll[axle] = (is_front ? self->par.anti_roll_front : self->par.anti_roll_rear) / (4 * half * half);
        c.lock[axle] = is_front ? self->par.preload_front + self->par.lock_front * fabs(torque)
                                : self->par.preload_rear + self->par.lock_rear * fabs(torque);
        for (int i = 2 * axle; i < 2 * axle + 2; ++i) {
            c.ahead[i] = is_front ? (1 - share) * wheelbase : -share * wheelbase;
            c.left[i] = i % 2 == 0 ? half : -half;
            double turned = is_front ? steering / (1 - c.left[i] / wheelbase * steering) : 0;
            c.cosine[i] = 1 / sqrt(1 + turned * turned);
            c.sine[i] = turned * c.cosine[i];
            c.drive[i] = 0.5 * torque + c.in.wheel_torque[i];
            c.brake[i] = 0.5 * brake + c.in.wheel_brake[i];
            c.from[i] = self->out.contacts[i];
        }
    }
    return c;
}

/* The loads that the springs of each wheel support. */
static void loads(const car *c, const plane *p, const double *y, double load[4]) {
    double most = MOST_LOAD * c->self->par.mass * CHASSIS_GRAVITY, gap[4], opening[4];
    for (int i = 0; i < 4; ++i) {
        const chassis_ground *ground = &c->in.ground[i];
        double ahead = c->ahead[i], left = c->left[i];
        double dx = y[X] + ahead * p->ahead[0] + left * p->left[0] - c->from[i].x;
        double dy = y[Y] + ahead * p->ahead[1] + left * p->left[1] - c->from[i].y;
        double along = y[SPEED] - left * y[YAW], across = y[LATERAL] + ahead * y[YAW];
        double climb = ground->slope_x * (along * p->ahead[0] + across * p->left[0]) + ground->slope_y * (along * p->ahead[1] + across * p->left[1]);
        gap[i] = y[HEIGHT] - ahead * y[PITCH] + left * y[ROLL] - ground->height - ground->slope_x * dx - ground->slope_y * dy;
        opening[i] = y[HEAVE] - ahead * y[PITCH_RATE] + left * y[ROLL_RATE] - climb;
    }
    for (int i = 0; i < 4; ++i) {
        int axle = i / 2, other = i ^ 1;
        double force = c->rest[axle] - c->spring[axle] * gap[i] - c->damper[axle] * opening[i] - c->anti_roll[axle] * (gap[i] - gap[other]);
        load[i] = chassis_limited(force, 0, most);
    }
}

static void stage(void *context, double gh, const wheel *base, const wheel *before, ars_state *at) {
    const car *c = context;
    two_track *self = c->self;
    double *y = at->body, u = y[SPEED], v = y[LATERAL], r = y[YAW], mass = self->par.mass;
    plane p = plane_below(y[HEADING], &c->slopes);
    wheel_result w[4];
    loads(c, &p, y, self->load);
    for (int i = 0; i < 4; ++i) {
        const tyre *t = &c->tyres[i / 2];
        double hub_ahead = u - r * c->left[i], hub_left = v + r * c->ahead[i];
        wheel_stage s = {
            .tyre = tyre_under(t, self->load[i], c->in.ground[i].friction),
            .load = self->load[i],
            .gh = gh,
            .base = base[i],
            .guess = at->wheel[i],
            .before = before[i].spin,
            .drive = c->drive[i],
            .brake = c->brake[i],
        };
        wheel_touch(&s, t, hub_ahead * c->cosine[i] + hub_left * c->sine[i], hub_left * c->cosine[i] - hub_ahead * c->sine[i]);
        w[i] = wheel_turn(&s, t);
    }
    wheel_lock(&w[0], &w[1], c->lock[0]);
    wheel_lock(&w[2], &w[3], c->lock[1]);

    double ahead = 0, left = 0, about = 0, load = 0, nose = 0, side = 0, wind;
    for (int i = 0; i < 4; ++i) {
        double x = w[i].x * c->cosine[i] - w[i].y * c->sine[i], across = w[i].x * c->sine[i] + w[i].y * c->cosine[i];
        ahead += x;
        left += across;
        about += c->ahead[i] * across - c->left[i] * x;
        load += self->load[i];
        nose -= c->ahead[i] * self->load[i];
        side += c->left[i] * self->load[i];
        at->wheel[i] = w[i].end;
    }
    double height = self->par.cg_height, *rates = at->rates;
    double lean = chassis_limited(y[ROLL] - p.left[2], -1, 1), dive = chassis_limited(y[PITCH] + p.ahead[2], -1, 1);
    double drag = plane_air_force(&p, &c->in.air, u, v, self->par.drag_area, self->par.side_area, &wind);
    self->acceleration = (ahead + drag) / mass - CHASSIS_GRAVITY * p.ahead[2];
    self->lateral_acceleration = (left + wind) / mass - CHASSIS_GRAVITY * p.left[2];
    rates[X] = u * p.ahead[0] + v * p.left[0];
    rates[Y] = u * p.ahead[1] + v * p.left[1];
    rates[HEADING] = r * p.turn + u * p.drift;
    rates[SPEED] = self->acceleration + v * r;
    rates[LATERAL] = self->lateral_acceleration - u * r;
    rates[YAW] = (about + self->par.side_lever * wind) / self->par.yaw_inertia;
    rates[WAY] = copysign(sqrt(u * u + v * v), u);
    rates[HEIGHT] = y[HEAVE];
    rates[ROLL] = y[ROLL_RATE];
    rates[PITCH] = y[PITCH_RATE];
    rates[HEAVE] = (p.up * load + p.ahead[2] * (ahead + drag) + p.left[2] * (left + wind)) / mass - CHASSIS_GRAVITY;
    rates[ROLL_RATE] = (side + height * (left + lean * load)) / self->par.roll_inertia;
    rates[PITCH_RATE] = (nose - height * (ahead - dive * load)) / self->par.pitch_inertia;
}

static void output(two_track *self, const car *c) {
    const double *y = self->state.body;
    const wheel *w = self->state.wheel;
    chassis_outputs *out = &self->out;
    plane p = plane_below(y[HEADING], &c->slopes);
    plane_contacts(&p, y[X], y[Y], c->ahead, c->left, out->contacts);
    out->roll = asin(chassis_limited(y[ROLL], -1, 1));
    out->pitch = asin(chassis_limited(y[PITCH], -1, 1));
    chassis_tell_motion(out, y, self->acceleration, self->lateral_acceleration);
    out->wheel_speed.front = 0.5 * (w[0].spin + w[1].spin);
    out->wheel_speed.rear = 0.5 * (w[2].spin + w[3].spin);
    for (int i = 0; i < 4; ++i) {
        out->wheel_speeds[i] = w[i].spin;
        out->load[i] = self->load[i];
    }
}

/* Upright on a plane through the ground below the wheels, rolling freely. */
void two_track_init(two_track *self) {
    car c = prepare(self);
    double speed = chassis_start_speed(&c.in, self->par.initial_speed), spin = speed / self->par.wheel_radius;
    plane p = plane_below(c.in.start.heading, &c.slopes);
    ars_state start = {
        .states = STATES,
        .wheels = 4,
        .body = {c.in.start.x, c.in.start.y, c.in.start.heading, speed},
        .wheel = {{spin, 0, 0}, {spin, 0, 0}, {spin, 0, 0}, {spin, 0, 0}},
    };
    double *y = start.body;
    y[ROLL] = p.left[2];
    y[PITCH] = -p.ahead[2];
    y[HEAVE] = speed * p.ahead[2];
    for (int i = 0; i < 4; ++i) y[HEIGHT] += 0.25 * (c.in.ground[i].height + c.ahead[i] * y[PITCH] - c.left[i] * y[ROLL]);
    plane_contacts(&p, y[X], y[Y], c.ahead, c.left, c.from);
    self->state = start;
    ars_rates(&c, stage, &self->state);
    output(self, &c);
}

void two_track_step(two_track *self, double h) {
    car c = prepare(self);
    ars_advance(&c, stage, &self->state, h, self->par.substeps);
    output(self, &c);
}
