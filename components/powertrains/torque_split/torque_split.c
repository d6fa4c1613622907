#include "torque_split.h"

void torque_split_init(torque_split *self) {
    double torque = self->in.engine.torque + self->in.machine.torque;
    self->out.engine_demand = self->par.engine_share * self->in.torque_demand;
    self->out.machine_demand = self->in.torque_demand - self->in.engine.torque;
    self->out.wheels.front = self->par.front_share * torque;
    self->out.wheels.rear = torque - self->out.wheels.front;
    self->out.power = self->in.engine.power + self->in.machine.power;
}

void torque_split_step(torque_split *self, double h) {
    (void)h; /* it has no state: shafts and clutches are rigid and massless here */
    torque_split_init(self);
}
