#include "torque_source.h"

#include <math.h>

/* Maximum torque of the source at a wheel speed: constant up to the corner, then constant power. */
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

/* Power drawn from the store; recovered power is reduced by the same efficiency. */
static double drawn(double mechanical, double efficiency, double auxiliary) {
    if (mechanical < 0) return auxiliary + mechanical * efficiency;
    return auxiliary + (efficiency > 0 ? mechanical / efficiency : 0);
}

static void powertrain_output(ideal_powertrain *self) {
    double front = self->par.front_share * self->torque, rear = self->torque - front;
    double mechanical = front * self->in.wheel_speed.front + rear * self->in.wheel_speed.rear;
    double power = drawn(mechanical, self->par.efficiency, self->par.auxiliary_power);
    self->out.wheels.front = front;
    self->out.wheels.rear = rear;
    self->out.fuel_power = self->par.fuel_share * power;
    self->out.battery_power = power - self->out.fuel_power;
    self->out.co2 = self->par.co2_per_energy * self->out.fuel_power;
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
