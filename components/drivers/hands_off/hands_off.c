#include "hands_off.h"

void hands_off_init(hands_off *self) { hands_off_step(self); }

void hands_off_step(hands_off *self) {
    self->out.accelerator = self->par.pedal;
    self->out.brake = self->par.brake_pedal;
    self->out.steering = self->par.wheel;
    self->out.hands_on = self->par.holds_wheel;
    self->out.cruise = self->par.wants_cruise;
    self->out.set_speed = self->par.wish;
    self->out.gap_setting = self->par.gap_wish;
}
