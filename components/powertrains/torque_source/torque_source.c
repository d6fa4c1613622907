#include "torque_source.h"

#include <math.h>

/* Torque the source can hold at a wheel speed: constant up to the corner, then constant power. */
static double limit(double torque, double power, double speed) {
    double cornering = fabs(speed) * torque;
    return cornering > power ? torque * power / cornering : torque;
}

static double clamp(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

/* Exact solution of lag * x' = target - x over h, with the target held. */
static double lagged(double x, double target, double lag, double h) {
    return lag > 0 ? target + (x - target) * exp(-h / lag) : target;
}

/* Power drawn from the store; what comes back is reduced by the same efficiency. */
static double drawn(double mechanical, double efficiency, double auxiliary) {
    if (mechanical < 0) return auxiliary + mechanical * efficiency;
    return auxiliary + (efficiency > 0 ? mechanical / efficiency : 0);
}

static void powertrain_output(ideal_powertrain *self) {
    double front = self->par.front_share * self->torque, rear = self->torque - front;
    double mechanical = front * self->in.wheel_speed.front + rear * self->in.wheel_speed.rear;
    self->out.wheels.front = front;
    self->out.wheels.rear = rear;
    self->out.power = drawn(mechanical, self->par.efficiency, self->par.auxiliary_power);
}

void ideal_powertrain_init(ideal_powertrain *self) {
    self->torque = 0;
    powertrain_output(self);
}

void ideal_powertrain_step(ideal_powertrain *self, double h) {
    double share = self->par.front_share;
    double speed = share * self->in.wheel_speed.front + (1 - share) * self->in.wheel_speed.rear;
    double highest = limit(self->par.max_torque, self->par.max_power, speed);
    double target = clamp(self->in.torque_demand, 0, highest);
    self->torque = fmin(lagged(self->torque, target, self->par.lag, h), highest);
    powertrain_output(self);
}

static void unit_output(drive_unit *self, double speed) {
    self->out.torque = self->torque;
    self->out.power = drawn(self->torque * speed, self->par.efficiency, self->par.auxiliary_power);
}

/* Both axles carry the unit; in a hybrid the split decides how, so their mean stands for the shaft. */
static double shaft_speed(const drive_unit *self) {
    return 0.5 * (self->in.wheel_speed.front + self->in.wheel_speed.rear);
}

void drive_unit_init(drive_unit *self) {
    self->torque = 0;
    unit_output(self, shaft_speed(self));
}

void drive_unit_step(drive_unit *self, double h) {
    double speed = shaft_speed(self);
    double highest = limit(self->par.max_torque, self->par.max_power, speed);
    double lowest = -limit(self->par.max_recuperation, self->par.max_power, speed);
    double target = clamp(self->in.torque_demand, lowest, highest);
    self->torque = clamp(lagged(self->torque, target, self->par.lag, h), lowest, highest);
    unit_output(self, speed);
}
