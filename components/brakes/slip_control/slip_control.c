#include "slip_control.h"

#include <math.h>

enum { NONE, ANTI_LOCK, TRACTION };

#define GRAVITY 9.81
#define LEAST_LOAD 100.0 /* N, of a wheel */
#define LEAST_TORQUE 1.0 /* N.m, of a driven axle */
#define MOST_TORQUE 1e5
#define CRAWL 0.6 /* m/s: below it, slip is relative to this speed */

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

/* The torque to add so that the slip follows its target. Well below it, where the tyre force still rises with the slip,
 * more torque does not make the wheel much slower, and the torque is raised towards the force at the target. */
static double towards(const slip_control *self, double target, double slip, double inertia, double speed, double response, double load) {
    double radius = self->par.wheel_radius, below = fmax(target - 1.6 * slip, 0);
    return inertia * speed / (radius * response) * (target - slip) + SLIP_CONTROL_STEP / response * radius * self->par.stiffness * load * below;
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
    double carried = load(self, i), target = clamp(force / (self->par.stiffness * carried), self->par.lowest_slip, self->par.highest_slip);
    double rolling = radius * force - inertia * forwards(self) / radius; /* keeps the slip as it is */
    double wanted = rolling + towards(self, target, slip, inertia, speed, self->par.response, carried);
    double lowest = w->torque - self->par.release_rate * SLIP_CONTROL_STEP, highest = w->torque + self->par.apply_rate * SLIP_CONTROL_STEP;
    w->active = w->active || slip > target + self->par.entry_slip;
    w->torque = w->active ? clamp(clamp(wanted, lowest, highest), 0, demand) : demand;
    w->active = w->torque < demand;
}

/* The torque that keeps an axle at its slip, and whether it has too much of it now. */
static double usable(slip_control *self, int axle, double torque, double spin_rate, bool *slips) {
    const slip_control_wheel *w = &self->wheel[2 * axle];
    double radius = self->par.wheel_radius, inertia = 2 * self->par.wheel_inertia, slip = -1;
    double speed = fmax(clamp(self->in.motion.speed, 0, 150), CRAWL);
    for (int i = 0; i < 2; ++i) slip = fmax(slip, (w[i].spin * radius - hub_speed(self, 2 * axle + i)) / speed);
    double force = (torque - inertia * spin_rate) / radius;
    double carried = 2 * load(self, 2 * axle), target = clamp(force / (self->par.stiffness * carried), self->par.lowest_slip, self->par.highest_slip);
    double rolling = radius * force + inertia * forwards(self) / radius;
    *slips = slip > target + self->par.entry_slip;
    return rolling + towards(self, target, slip, inertia, speed, self->par.traction_response, carried);
}

static void traction(slip_control *self, const double spin_rate[4]) {
    double demand = clamp(self->in.drive_demand, -MOST_TORQUE, MOST_TORQUE), usable_torque = MOST_TORQUE;
    double torque[2] = {clamp(self->in.wheels.front, -MOST_TORQUE, MOST_TORQUE), clamp(self->in.wheels.rear, -MOST_TORQUE, MOST_TORQUE)};
    double lowest = self->torque - self->par.release_rate * SLIP_CONTROL_STEP, highest = self->torque + self->par.apply_rate * SLIP_CONTROL_STEP;
    for (int axle = 0; axle < 2 && self->par.functions >= TRACTION; ++axle) {
        if (!(torque[axle] > LEAST_TORQUE) || !(torque[1 - axle] >= 0)) continue;
        bool slips;
        double share = torque[axle] / (torque[0] + torque[1]);
        double most = usable(self, axle, torque[axle], 0.5 * (spin_rate[2 * axle] + spin_rate[2 * axle + 1]), &slips);
        usable_torque = fmin(usable_torque, most / share);
        self->out.traction = self->out.traction || slips;
    }
    self->torque = self->out.traction && demand > 0 ? clamp(clamp(usable_torque, lowest, highest), 0, demand) : demand;
    self->out.traction = self->torque < demand;
    self->out.drive_torque = self->torque;
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
    self->torque = self->out.drive_torque = self->in.drive_demand;
    self->out.traction = self->started = false;
    output(self);
}

void slip_control_step(slip_control *self) {
    double spin_rate[4];
    for (int i = 0; i < 4; ++i) {
        double spin = clamp(self->in.wheel_speeds[i], -1e4, 1e4), before = self->started ? self->wheel[i].spin : spin;
        double demand = 0.5 * clamp(i < 2 ? self->in.demand.front : self->in.demand.rear, 0, MOST_TORQUE);
        self->wheel[i].spin = spin;
        spin_rate[i] = (spin - before) / SLIP_CONTROL_STEP;
        anti_lock(self, i, spin_rate[i], demand);
    }
    self->started = true;
    traction(self, spin_rate);
    select_low(&self->wheel[2], &self->wheel[3]);
    output(self);
}
