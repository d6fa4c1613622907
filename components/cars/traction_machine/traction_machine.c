#include "traction_machine.h"

#include <math.h>

static double clamp(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

/* Maximum torque at the present speed, at the machine. Above its maximum speed it is zero. */
static double limit(const traction_machine *self) {
    double speed = fabs(self->in.gear.ratio * self->in.wheel_speed), voltage = fmax(self->in.voltage, 0);
    double current = self->in.inverter.max_current;
    double torque = fmin(self->par.max_torque, self->par.torque_per_current * current);
    double rated = self->par.rated_voltage > 0 ? fmin(1, voltage / self->par.rated_voltage) : 1;
    double power = fmin(self->par.max_power * rated, sqrt(1.5) * voltage * current * self->par.power_factor);
    if (speed > self->par.max_speed) return 0;
    return torque * speed > power ? power / speed : torque;
}

/* Torque at the wheels for one at the machine: the gear loses its share of the power in either direction. */
static double at_wheels(const traction_machine *self, double torque) {
    double efficiency = self->in.gear.efficiency > 0 ? self->in.gear.efficiency : 1;
    return self->in.gear.ratio * (torque > 0 ? torque * efficiency : torque / efficiency);
}

static double at_machine(const traction_machine *self, double torque) {
    double efficiency = self->in.gear.efficiency > 0 ? self->in.gear.efficiency : 1;
    if (!(self->in.gear.ratio > 0)) return 0;
    return (torque > 0 ? torque / efficiency : torque * efficiency) / self->in.gear.ratio;
}

static void output(traction_machine *self) {
    double ratio = self->in.gear.ratio, speed = ratio * self->in.wheel_speed, turning = fabs(speed);
    double losses = self->par.copper * self->torque * self->torque + self->par.iron * turning +
                    self->par.windage * turning * turning * turning + self->par.idle;
    double phases = self->torque * speed + losses;
    self->out.unit.torque = at_wheels(self, self->torque);
    self->out.unit.regeneration = -at_wheels(self, -limit(self));
    self->out.unit.electric_power = phases + self->in.inverter.loss * fabs(phases) + self->in.inverter.standby_power;
    self->out.unit.inertia = ratio * ratio * self->par.rotor_inertia;
    self->out.unit.mass = self->par.mass + self->in.gear.mass + self->in.inverter.mass;
}

void traction_machine_init(traction_machine *self) {
    self->torque = 0;
    output(self);
}

void traction_machine_step(traction_machine *self, double h) {
    double highest = limit(self);
    double target = clamp(at_machine(self, self->in.torque_demand), -highest, highest);
    double rest = self->par.lag > 0 ? exp(-h / self->par.lag) : 0; /* exact for a target held over h */
    self->torque = clamp(target + (self->torque - target) * rest, -highest, highest);
    output(self);
}
