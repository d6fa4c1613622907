#include "drive_control.h"

#include <math.h>

/* The part of a torque that a power can supply at a speed. */
static double within(double torque, double power, double speed) {
    return torque * speed > power ? power / speed : torque;
}

void drive_control_init(drive_control *self) {
    const drive_control_unit *front = &self->in.units.front, *rear = &self->in.units.rear;
    double share = self->par.front_share, braking = self->par.front_regeneration;
    double speed = fabs(share * self->in.wheel_speed.front + (1 - share) * self->in.wheel_speed.rear);
    double drive = fmax(self->in.torque_demand, 0), brake = fmax(self->in.regeneration_demand, 0);
    drive = within(drive, DRIVE_CONTROL_EFFICIENCY * self->in.supply.discharge_limit, speed);
    self->out.demands.front = share * drive - braking * brake;
    self->out.demands.rear = (1 - share) * drive - (1 - braking) * brake;

    /* The axle that can brake less relative to its share limits both. */
    double most = self->par.max_regeneration;
    if (braking > 0) most = fmin(most, front->regeneration / braking);
    if (braking < 1) most = fmin(most, rear->regeneration / (1 - braking));
    self->out.regeneration = within(most, self->in.supply.charge_limit / DRIVE_CONTROL_EFFICIENCY, speed);

    self->out.wheels = (drive_control_axles){front->torque, rear->torque};
    self->out.electric_power = front->electric_power + rear->electric_power;
    double shafts = front->mass + rear->mass > 0 ? front->mass / (front->mass + rear->mass) : share;
    self->out.load.front = front->mass + shafts * self->par.mass;
    self->out.load.rear = rear->mass + (1 - shafts) * self->par.mass;
    self->out.inertia = (drive_control_axles){front->inertia, rear->inertia};
}

void drive_control_step(drive_control *self) {
    drive_control_init(self);
}
