#include "highest_brake.h"

#include <math.h>

void highest_brake_init(highest_brake *self) {
    self->cut = false;
    highest_brake_step(self);
}

void highest_brake_step(highest_brake *self) {
    double assistant = fmax(self->in.emergency_torque, self->in.yielding_torque);
    double demand = self->in.demand.drive_torque, back = self->out.drive_torque + self->par.drive_rate * HIGHEST_BRAKE_STEP;
    self->out.brake_torque = fmax(self->in.demand.brake_torque, assistant);
    if (assistant > self->par.drive_cut) {
        self->cut = true;
        self->out.drive_torque = 0;
        return;
    }
    self->cut = self->cut && demand > back;
    self->out.drive_torque = self->cut ? back : demand;
}
