#include "slip_control.h"

#include <math.h>

enum { NONE, ANTI_LOCK };

#define GRAVITY 9.81
#define LEAST_LOAD 100.0 /* N */

static double clamp(double value, double low, double high) {
    return value > low ? value < high ? value : high : low; /* NaN: low */
}

static double forwards(const slip_control *self) {
    return clamp(self->in.motion.acceleration, -20, 20);
}

static double load(const slip_control *self, int i) {
    double share = i < 2 ? self->par.front_load_share : 1 - self->par.front_load_share, lever = self->par.cg_height / self->par.wheelbase;
    double shift = forwards(self) * lever;
    return fmax(0.5 * self->par.mass * (GRAVITY * share + (i < 2 ? -shift : shift)), LEAST_LOAD);
}

/* The speed of the hub of a wheel; the steering is small. */
static double hub_speed(const slip_control *self, int i) {
    double left = (i % 2 == 0 ? 0.5 : -0.5) * self->par.track;
    return clamp(self->in.motion.speed, 0, 150) - left * clamp(self->in.motion.yaw_rate, -10, 10);
}

static void anti_lock(slip_control *self, int i, double spin_rate, double demand) {
    slip_control_wheel *w = &self->wheel[i];
    double speed = hub_speed(self, i), radius = self->par.wheel_radius, inertia = self->par.wheel_inertia;
    if (self->par.functions < ANTI_LOCK || !(speed > self->par.lowest_speed)) {
        w->active = false;
        w->torque = demand;
        return;
    }
    double slip = 1 - w->spin * radius / speed, force = (w->torque + inertia * spin_rate) / radius;
    double target = clamp(force / (self->par.stiffness * load(self, i)), self->par.lowest_slip, self->par.highest_slip);
    double rolling = radius * force - inertia * forwards(self) / radius; /* keeps the slip as it is */
    double wanted = rolling + inertia * speed / (radius * self->par.response) * (target - slip);
    double lowest = w->torque - self->par.release_rate * SLIP_CONTROL_STEP, highest = w->torque + self->par.apply_rate * SLIP_CONTROL_STEP;
    w->active = w->active || slip > target + self->par.entry_slip;
    w->torque = w->active ? clamp(clamp(wanted, lowest, highest), 0, demand) : demand;
    w->active = w->torque < demand;
}

static void select_low(slip_control_wheel *left, slip_control_wheel *right) {
    left->active = right->active = left->active || right->active;
    left->torque = right->torque = fmin(left->torque, right->torque);
}

static double axle(const slip_control_wheel *w, double *single) {
    double both = fmin(w[0].torque, w[1].torque);
    single[0] = w[0].torque - both;
    single[1] = w[1].torque - both;
    return 2 * both;
}

static void output(slip_control *self) {
    self->out.brake.front = axle(&self->wheel[0], &self->out.wheel_brake[0]);
    self->out.brake.rear = axle(&self->wheel[2], &self->out.wheel_brake[2]);
    self->out.anti_lock = false;
    for (int i = 0; i < 4; ++i) self->out.anti_lock = self->out.anti_lock || self->wheel[i].active;
}

void slip_control_init(slip_control *self) {
    slip_control_wheel released = {0};
    for (int i = 0; i < 4; ++i) self->wheel[i] = released;
    self->started = false;
    output(self);
}

void slip_control_step(slip_control *self) {
    for (int i = 0; i < 4; ++i) {
        double spin = clamp(self->in.wheel_speeds[i], -1e4, 1e4), before = self->started ? self->wheel[i].spin : spin;
        double demand = 0.5 * clamp(i < 2 ? self->in.demand.front : self->in.demand.rear, 0, 1e5);
        self->wheel[i].spin = spin;
        anti_lock(self, i, (spin - before) / SLIP_CONTROL_STEP, demand);
    }
    self->started = true;
    select_low(&self->wheel[2], &self->wheel[3]);
    output(self);
}
