#include "traction_pack.h"

#include <math.h>

static double open_circuit(const traction_pack *self) {
    return self->par.voltage + self->par.voltage_rise * (self->soc - 0.5);
}

static void output(traction_pack *self) {
    double open = open_circuit(self), resistance = self->par.resistance;
    double power = self->in.drive_power + self->in.climate_power + self->par.auxiliary_power;
    double root = sqrt(fmax(open * open - 4 * resistance * power, 0));
    /* The same as (open - root) / (2 resistance), without the difference of two near numbers. */
    self->current = 2 * fmin(power, resistance > 0 ? open * open / (4 * resistance) : power) / (open + root);
    double greatest = resistance > 0 ? open * open / (4 * resistance) : self->par.max_discharge;
    self->out.supply.voltage = open - resistance * self->current;
    self->out.supply.discharge_limit = self->soc > 0 ? fmin(self->par.max_discharge, greatest) : 0;
    self->out.supply.charge_limit = self->soc < 1 ? self->par.max_charge : 0;
    self->out.soc = self->soc;
    self->out.battery_power = open * self->current;
    self->out.load.front = self->par.front_share * self->par.mass;
    self->out.load.rear = self->par.mass - self->out.load.front;
}

void traction_pack_init(traction_pack *self) {
    self->soc = self->par.initial_soc;
    output(self);
}

void traction_pack_step(traction_pack *self, double h) {
    if (self->par.capacity > 0) self->soc -= self->current * h / self->par.capacity;
    output(self);
}
