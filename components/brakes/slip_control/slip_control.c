#include "slip_control.h"

#include <math.h>

enum { NONE, ANTI_LOCK, TRACTION, STABILITY };

#define GRAVITY 9.81
#define LEAST_LOAD 100.0 /* N, of a wheel */
#define LEAST_TORQUE 1.0 /* N.m, of a driven axle */
#define MOST_TORQUE 1e5
#define CRAWL 0.6 /* m/s: below it, slip is relative to this speed; chosen from starts on ice and snow */

static double clamp(double value, double low, double high) {
    if (isnan(value)) value = 0;
    return value < low ? low : value > high ? high : value;
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
 * more torque does not make the wheel much slower, and the torque is raised towards the force at the target. The factor 1.6 was chosen from starts on ice and snow. */
static double towards(const slip_control *self, double target, double slip, double inertia, double speed, double response, double steep) {
    double radius = self->par.wheel_radius, below = fmax(target - 1.6 * slip, 0);
    return inertia * speed / (radius * response) * (target - slip) + SLIP_CONTROL_STEP / response * radius * steep * below;
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
    double steep = self->par.stiffness * load(self, i), target = clamp(force / steep, self->par.lowest_slip, self->par.highest_slip);
    double rolling = radius * force - inertia * forwards(self) / radius; /* keeps the slip as it is */
    double wanted = rolling + towards(self, target, slip, inertia, speed, self->par.response, steep);
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
    double steep = self->par.traction_stiffness * 2 * load(self, 2 * axle);
    double target = clamp(force / steep, self->par.lowest_slip, self->par.highest_slip);
    double rolling = radius * force + inertia * forwards(self) / radius;
    *slips = slip > target + self->par.entry_slip;
    return rolling + towards(self, target, slip, inertia, speed, self->par.traction_response, steep);
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

static void stability(slip_control *self) {
    double speed = clamp(self->in.motion.speed, 0, 150), steering = clamp(self->in.steering, -1, 1), relative = speed / self->par.characteristic_speed;
    double rate = clamp(self->in.motion.yaw_rate, -10, 10), aside = fabs(clamp(self->in.motion.lateral_acceleration, -20, 20));
    bool acts = self->par.functions >= STABILITY && speed > self->par.lowest_speed;
    double most = (aside + self->par.yaw_margin) / fmax(speed, CRAWL), lag = self->par.yaw_lag + SLIP_CONTROL_STEP;
    double wanted = clamp(speed * tan(steering) / (self->par.wheelbase * (1 + relative * relative)), -most, most);
    self->yaw_rate += SLIP_CONTROL_STEP / lag * (wanted - self->yaw_rate);
    double excess = rate - self->yaw_rate, torque = self->par.yaw_gain * fmax(fabs(excess) - self->par.yaw_tolerance, 0);
    int axle = excess * rate > 0 ? 0 : 1, braked = 2 * axle + (excess > 0 ? 1 : 0);
    self->out.stability = acts && torque > 0;
    for (int i = 0; i < 4; ++i) {
        double target = self->out.stability && i == braked ? clamp(torque, 0, MOST_TORQUE) : 0;
        double change = target - self->yaw_brake[i];
        self->yaw_brake[i] += clamp(change, -self->par.release_rate * SLIP_CONTROL_STEP, self->par.apply_rate * SLIP_CONTROL_STEP);
    }
}

static void select_low(slip_control_wheel *left, slip_control_wheel *right) {
    if (!left->active && !right->active) return;
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
    self->yaw_rate = 0;
    for (int i = 0; i < 4; ++i) self->yaw_brake[i] = 0;
    self->torque = self->out.drive_torque = clamp(self->in.drive_demand, -MOST_TORQUE, MOST_TORQUE);
    self->out.traction = self->out.stability = self->started = false;
    output(self);
}

void slip_control_step(slip_control *self) {
    double spin_rate[4];
    stability(self);
    for (int i = 0; i < 4; ++i) {
        double spin = clamp(self->in.wheel_speeds[i], -1e4, 1e4), before = self->started ? self->wheel[i].spin : spin;
        double demand = 0.5 * clamp(i < 2 ? self->in.demand.front : self->in.demand.rear, 0, MOST_TORQUE) + self->yaw_brake[i];
        self->wheel[i].spin = spin;
        spin_rate[i] = (spin - before) / SLIP_CONTROL_STEP;
        anti_lock(self, i, spin_rate[i], demand);
    }
    self->started = true;
    traction(self, spin_rate);
    if (!self->out.stability) select_low(&self->wheel[2], &self->wheel[3]);
    output(self);
}
