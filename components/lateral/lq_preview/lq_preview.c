#include "lq_preview.h"

#include <math.h>

#include "../../controllers/riccati/riccati.h"
#include "../lateral/car_model.h"

static car_model car_of(const lq_preview_par *par) {
    car_model car = {
        par->mass, par->yaw_inertia, par->wheelbase, par->front_load_share, par->front_stiffness, par->rear_stiffness,
    };
    return car;
}

static int samples(const lq_preview_par *par) {
    return (int)lateral_clamp(floor(par->preview_time / LATERAL_STEP + 0.5), 0, LQ_SAMPLES);
}

/* Gains at one speed. */
static void design(lq_preview *self, int row) {
    const lq_preview_par *par = &self->par;
    double speed = LQ_SPEED_STEP * (row + 1);
    double weights[4] = {1 / (par->offset_error * par->offset_error), 0, 1 / (par->heading_error * par->heading_error), 0};
    double effort = 1 / (par->steering_effort * par->steering_effort);
    car_model car = car_of(par);
    car_motion motion = car_motion_over(&car, speed, LATERAL_STEP);
    regulator best = regulator_of((const double(*)[4])motion.transition, motion.steering, weights, effort);
    double heading = car_balance_on(&car, speed, 1, 0).heading; /* z* */
    double reached[4], stiffness = effort;
    for (int i = 0; i < 4; ++i) {
        self->gain[row][i] = best.gain[i];
        reached[i] = best.cost[i][2] * heading;
        for (int j = 0; j < 4; ++j) stiffness += motion.steering[i] * best.cost[i][j] * motion.steering[j];
    }
    for (int n = 0; n < LQ_SAMPLES; ++n) {
        double sum = 0, next[4] = {0, 0, 0, 0};
        for (int i = 0; i < 4; ++i) {
            sum += motion.steering[i] * reached[i];
            for (int j = 0; j < 4; ++j) next[i] += best.closed[j][i] * reached[j];
        }
        self->ahead[row][n] = sum / stiffness;
        for (int i = 0; i < 4; ++i) reached[i] = next[i];
    }
}

static double wanted(const lq_preview *self) {
    const lateral_in *in = &self->in;
    double speed = in->motion.speed, aside = in->motion.lateral_speed, sine = sin(in->lane.heading);
    double cosine = cos(in->lane.heading), k = in->lane.curvature;
    double along = (speed * cosine - aside * sine) / fmax(1 - k * in->lane.offset, 0.1); /* of the lane's middle */
    /* At walking pace the gains of the first speed apply. */
    double place = lateral_clamp(speed / LQ_SPEED_STEP - 1, 0, LQ_SPEEDS - 1);
    int row = (int)fmin(place, LQ_SPEEDS - 2);
    double part = place - row;

    car_model car = car_of(&self->par);
    car_balance balance = car_balance_on(&car, speed, k, in->lane.bank);
    double state[4] = {
        in->lane.offset, speed * sine + aside * cosine,
        in->lane.heading - balance.heading, in->motion.yaw_rate - k * along,
    };
    double steering = balance.steering;
    for (int i = 0; i < 4; ++i) {
        steering -= (self->gain[row][i] + part * (self->gain[row + 1][i] - self->gain[row][i])) * state[i];
    }
    int from = 0, count = samples(&self->par);
    double step = fmax(along, 0) * LATERAL_STEP, last = k;
    for (int n = 0; n < count; ++n) {
        double next = lateral_curvature(in, (n + 1) * step, &from);
        double gain = self->ahead[row][n] + part * (self->ahead[row + 1][n] - self->ahead[row][n]);
        steering += gain * (next - last);
        last = next;
    }
    return steering;
}

void lq_preview_init(lq_preview *self) {
    for (int row = 0; row < LQ_SPEEDS; ++row) design(self, row);
    self->out.steering = lateral_clamp(wanted(self), -self->par.max_steering, self->par.max_steering);
}

void lq_preview_step(lq_preview *self) {
    self->out.steering =
        lateral_steering(wanted(self), self->out.steering, self->par.max_steering, self->par.max_steering_rate);
}
