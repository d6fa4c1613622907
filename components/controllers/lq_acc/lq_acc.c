#include "lq_acc.h"

#include <math.h>

#include "../riccati/riccati.h"

#define STANDSTILL 0.1       /* m/s: below it the speed does not show the forces */
#define NEW_LEAD 1.5         /* m/s: the speed of one vehicle changes less from one sample to the next */
#define MOST_DISTURBANCE 3.0 /* m/s2: a grade of 30 % */

/* The effect of an acceleration and a demand on it, on the speed and on the distance within one sample. */
typedef struct {
    double stays, faster, further;       /* by the acceleration */
    double comes, faster_by, further_by; /* by the demand */
} lagging;

static lagging lagging_of(double lag) {
    lagging car;
    car.comes = -expm1(-ACC_STEP / lag);
    car.stays = 1 - car.comes;
    car.faster = lag * car.comes;
    car.faster_by = ACC_STEP - car.faster;
    car.further = lag * car.faster_by;
    car.further_by = 0.5 * ACC_STEP * ACC_STEP - car.further;
    return car;
}

static void design(lq_acc *self) {
    const lq_acc_par *par = &self->par;
    self->designed_for = par->gap_setting;
    lagging car = lagging_of(par->lag);
    double h = acc_time_gap(par->gap_setting), effort = 1 / (par->effort * par->effort);
    double speed_weight = 1 / (par->speed_error * par->speed_error);
    const double gap[4][4] = {
        {1, ACC_STEP, -car.further - h * car.faster, 0},
        {0, 1, -car.faster, 0},
        {0, 0, car.stays, 0},
        {0, 0, 0, 0},
    };
    const double to_gap[4] = {-car.further_by - h * car.faster_by, -car.faster_by, car.comes, 0};
    const double speed[4][4] = {{1, car.faster, 0, 0}, {0, car.stays, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}};
    const double to_speed[4] = {car.faster_by, car.comes, 0, 0};
    const double of_gap[4] = {1 / (par->gap_error * par->gap_error), speed_weight, 0, 0};
    const double of_speed[4] = {speed_weight, 0, 0, 0};
    regulator following = regulator_of(gap, to_gap, of_gap, effort);
    regulator free_road = regulator_of(speed, to_speed, of_speed, effort);
    for (int i = 0; i < 3; ++i) self->following[i] = following.gain[i];
    for (int i = 0; i < 2; ++i) self->free[i] = free_road.gain[i];
}

static void observe_lead(lq_acc *self) {
    const acc_in *in = &self->in;
    double lead = in->speed - in->target.closing_speed;
    if (in->target.detected && (!self->has_lead || fabs(lead - self->lead_speed) > NEW_LEAD)) self->slow_speed = lead;
    self->has_lead = in->target.detected;
    self->lead_speed = lead;
    double part = -expm1(-ACC_STEP / self->par.lead_lag);
    self->slow_speed += part * (lead - self->slow_speed);
    /* As the sensor reports a vehicle that accelerates steadily. */
    self->lead_acceleration = (lead - self->slow_speed) * part / ((1 - part) * ACC_STEP);
}

static void observe_car(lq_acc *self) {
    lagging car = lagging_of(self->par.lag);
    double predicted = self->speed + ACC_STEP * self->disturbance + car.faster * self->acceleration +
                       car.faster_by * self->demanded;
    self->acceleration = car.stays * self->acceleration + car.comes * self->demanded;
    if (self->in.speed < STANDSTILL) {
        self->speed = self->in.speed;
        self->acceleration = fmax(self->acceleration, 0);
        return;
    }
    double pole = exp(-ACC_STEP / self->par.observer_lag), surprise = self->in.speed - predicted;
    self->speed = predicted + (1 - pole * pole) * surprise;
    self->disturbance = acc_limit(self->disturbance + (1 - pole) * (1 - pole) / ACC_STEP * surprise, -MOST_DISTURBANCE,
                                  MOST_DISTURBANCE);
}

static void control(lq_acc *self, double change) {
    const acc_in *in = &self->in;
    const lq_acc_par *par = &self->par;
    const acc_car car = {par->nominal_mass, par->wheel_radius, par->drag_area, par->rolling_resistance};
    double low = -par->max_deceleration, high = par->max_acceleration;
    double own = self->acceleration + self->disturbance;
    double wanted_gap = acc_wanted_gap(par->gap_setting, par->standstill_gap, in);
    double wanted = acc_limit(self->free[0] * (in->set_speed - in->speed) - self->free[1] * own, low, high);
    int32_t mode = ACC_MODE_SPEED;
    if (in->target.detected) {
        double ahead = par->feed_forward * self->lead_acceleration;
        double following = ahead - self->following[0] * (in->target.gap - wanted_gap) +
                           self->following[1] * (in->target.closing_speed + acc_time_gap(par->gap_setting) * ahead) -
                           self->following[2] * (own - ahead);
        following = acc_limit(following, low, high);
        if (following < wanted) {
            wanted = following;
            mode = ACC_MODE_DISTANCE;
        }
    }
    self->wanted = acc_limit(wanted, self->wanted - change, self->wanted + change);
    self->demanded = self->wanted - self->disturbance;
    acc_demand(&car, self->demanded, in, &self->out);
    acc_report(mode, wanted_gap, in, &self->out);
}

void lq_acc_init(lq_acc *self) {
    design(self);
    self->wanted = self->demanded = self->acceleration = self->disturbance = 0;
    self->speed = self->in.speed;
    self->has_lead = false;
    observe_lead(self);
    control(self, HUGE_VAL);
}

void lq_acc_step(lq_acc *self) {
    if (self->par.gap_setting != self->designed_for) design(self);
    observe_car(self);
    observe_lead(self);
    control(self, self->par.max_jerk * ACC_STEP);
}
