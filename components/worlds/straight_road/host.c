#include "host.h"

#include <math.h>

#define GRAVITY 9.81
#define SLIP_SPEED 0.05  /* vs, m/s: below it slip is relative to this speed, not to the car's */
#define SPIN_SCALE 0.001 /* ws, rad/s: below it friction torques fade to zero */
#define GAMMA 0.29289321881345247560 /* 1 - 1/sqrt(2) */
#define SPEED 0
#define FRONT 1
#define REAR 2

/* The data in the form of the equations. */
typedef struct {
    double per_mass, per_inertia[2], radius, transfer, friction[2], stiffness, bend[2], weight[2];
    double drag, wind, downhill, rolling, drive[2], brake[2];
} model;

static model prepare(const host_data *data) {
    double cosine = 1 / sqrt(1 + data->grade * data->grade), weight = data->mass * GRAVITY * cosine;
    model m = {
        .per_mass = 1 / data->mass,
        .per_inertia = {1 / data->inertia_front, 1 / data->inertia_rear},
        .radius = data->wheel_radius,
        .transfer = data->cg_height / data->wheelbase,
        .friction = {data->friction_front, data->friction_rear},
        .stiffness = data->slip_stiffness,
        .bend = {data->slip_stiffness / data->friction_front, data->slip_stiffness / data->friction_rear},
        .weight = {data->front_load_share * weight, (1 - data->front_load_share) * weight},
        .drag = 0.5 * data->air_density * data->drag_area,
        .wind = data->wind,
        .downhill = weight * data->grade,
        .rolling = data->rolling_resistance * data->wheel_radius,
        .drive = {data->drive_front, data->drive_rear},
        .brake = {data->brake_front, data->brake_rear},
    };
    return m;
}

/* Time derivatives f of y = (speed, spins) and their Jacobian j. */
static void derivatives(const model *m, const double y[3], double f[3], double j[3][3]) {
    double v = y[SPEED], per_speed = 1 / sqrt(v * v + SLIP_SPEED * SLIP_SPEED);
    double grip[2], by_spin[2], by_speed[2]; /* force per load, and its derivatives */
    for (int i = 0; i < 2; ++i) {
        double slip = (m->radius * y[FRONT + i] - v) * per_speed;
        double x = m->bend[i] * slip, root = 1 / sqrt(1 + x * x);
        double stiffness = m->stiffness * root * root * root;
        grip[i] = m->friction[i] * x * root;
        by_spin[i] = stiffness * m->radius * per_speed;
        by_speed[i] = -stiffness * per_speed * (1 + slip * v * per_speed);
    }
    double per_total = 1 / (1 + m->transfer * (grip[0] - grip[1]));
    double total = (grip[0] * m->weight[0] + grip[1] * m->weight[1]) * per_total;
    double load[2] = {m->weight[0] - m->transfer * total, m->weight[1] + m->transfer * total};
    double total_by[3] = {
        (load[0] * by_speed[0] + load[1] * by_speed[1]) * per_total,
        load[0] * by_spin[0] * per_total,
        load[1] * by_spin[1] * per_total,
    };
    double air = v - m->wind;
    f[SPEED] = (total - m->drag * air * fabs(air) - m->downhill) * m->per_mass;
    j[SPEED][SPEED] = (total_by[SPEED] - 2 * m->drag * fabs(air)) * m->per_mass;
    j[SPEED][FRONT] = total_by[FRONT] * m->per_mass;
    j[SPEED][REAR] = total_by[REAR] * m->per_mass;
    for (int i = 0; i < 2; ++i) {
        double w = y[FRONT + i], root = 1 / sqrt(w * w + SPIN_SCALE * SPIN_SCALE), direction = w * root;
        double holding = m->brake[i] + m->rolling * load[i];
        double torque = m->drive[i] - holding * direction - m->radius * grip[i] * load[i];
        f[FRONT + i] = torque * m->per_inertia[i];
        double moved = i == 0 ? -m->transfer : m->transfer; /* load per total force */
        for (int k = 0; k < 3; ++k) {
            double grip_by = k == SPEED ? by_speed[i] : k == FRONT + i ? by_spin[i] : 0;
            double load_by = moved * total_by[k];
            double torque_by = -m->rolling * load_by * direction - m->radius * (grip_by * load[i] + grip[i] * load_by);
            if (k == FRONT + i) torque_by -= holding * SPIN_SCALE * SPIN_SCALE * root * root * root;
            j[FRONT + i][k] = torque_by * m->per_inertia[i];
        }
    }
}

/* Residual r of the stage equation y = base + gh f(y); returns its size, with spins weighted as tread speeds. */
static double residual(const model *m, const double base[3], double gh, const double y[3], double r[3], double j[3][3]) {
    double f[3];
    derivatives(m, y, f, j);
    for (int i = 0; i < 3; ++i) r[i] = y[i] - base[i] - gh * f[i];
    return r[0] * r[0] + m->radius * m->radius * (r[1] * r[1] + r[2] * r[2]);
}

/* Newton step d from (1 - gh j) d = -r by elimination; the diagonal dominates. */
static void newton_step(double gh, const double j[3][3], const double r[3], double d[3]) {
    double a00 = 1 - gh * j[0][0], a01 = -gh * j[0][1], a02 = -gh * j[0][2];
    double a10 = -gh * j[1][0], a11 = 1 - gh * j[1][1], a12 = -gh * j[1][2];
    double a20 = -gh * j[2][0], a21 = -gh * j[2][1], a22 = 1 - gh * j[2][2];
    /* Eliminate the spins: they are stiff, the speed is not. */
    double per2 = 1 / a22;
    double m12 = a12 * per2, b10 = a10 - m12 * a20, b11 = a11 - m12 * a21, s1 = r[1] - m12 * r[2];
    double m02 = a02 * per2, b00 = a00 - m02 * a20, b01 = a01 - m02 * a21, s0 = r[0] - m02 * r[2];
    double per1 = 1 / b11, m01 = b01 * per1;
    d[0] = -(s0 - m01 * s1) / (b00 - m01 * b10);
    d[1] = (-s1 - b10 * d[0]) * per1;
    d[2] = (-r[2] - a20 * d[0] - a21 * d[1]) * per2;
}

/* Solve y = base + gh f(y) by Newton's method with halving: friction near standstill is strongly nonlinear. */
static void solve_stage(const model *m, const double base[3], double gh, double y[3]) {
    double r[3], j[3][3], d[3], trial[3], trial_r[3], trial_j[3][3];
    double size = residual(m, base, gh, y, r, j);
    for (int iteration = 0; iteration < 50; ++iteration) {
        newton_step(gh, (const double(*)[3])j, r, d);
        double moved = fabs(d[0]) + m->radius * (fabs(d[1]) + fabs(d[2]));
        if (!(moved >= 1e-7 * (1 + fabs(y[0])))) {
            /* The next step would be of the size of this one squared. NaN also ends here. */
            for (int i = 0; i < 3; ++i) y[i] += d[i];
            return;
        }
        double part = 1, trial_size = size;
        for (int halving = 0; halving < 30; ++halving, part *= 0.5) {
            for (int i = 0; i < 3; ++i) trial[i] = y[i] + part * d[i];
            trial_size = residual(m, base, gh, trial, trial_r, trial_j);
            if (trial_size < (1 - 1e-4 * part) * size) break;
        }
        for (int i = 0; i < 3; ++i) {
            y[i] = trial[i];
            r[i] = trial_r[i];
            for (int k = 0; k < 3; ++k) j[i][k] = trial_j[i][k];
        }
        size = trial_size;
    }
}

void host_start(host_state *state, const host_data *data, double speed) {
    model m = prepare(data);
    double y[3] = {speed, speed / data->wheel_radius, speed / data->wheel_radius}, jacobian[3][3];
    state->position = 0;
    state->speed = y[SPEED];
    state->spin_front = y[FRONT];
    state->spin_rear = y[REAR];
    derivatives(&m, y, state->slope, jacobian);
}

/* SDIRK2 (Alexander 1977): L-stable and stiffly accurate, so that locked wheels and standstill need no small step. */
void host_advance(host_state *state, const host_data *data, double h, int substeps) {
    model m = prepare(data);
    if (substeps < 1) substeps = 1;
    double dt = h / substeps, gh = GAMMA * dt;
    double y[3] = {state->speed, state->spin_front, state->spin_rear};
    for (int n = 0; n < substeps; ++n) {
        double base[3], stage[3];
        for (int i = 0; i < 3; ++i) {
            base[i] = y[i];
            stage[i] = y[i] + gh * state->slope[i];
        }
        solve_stage(&m, base, gh, stage);
        double first_speed = stage[SPEED];
        for (int i = 0; i < 3; ++i) {
            double slope = (stage[i] - base[i]) / gh;
            base[i] = y[i] + (1 - GAMMA) * dt * slope;
            stage[i] = base[i] + gh * slope;
        }
        solve_stage(&m, base, gh, stage);
        for (int i = 0; i < 3; ++i) {
            state->slope[i] = (stage[i] - base[i]) / gh;
            y[i] = stage[i];
        }
        state->position += dt * ((1 - GAMMA) * first_speed + GAMMA * y[SPEED]);
    }
    state->speed = y[SPEED];
    state->spin_front = y[FRONT];
    state->spin_rear = y[REAR];
}
