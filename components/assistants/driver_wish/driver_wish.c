#include "driver_wish.h"

void driver_wish_init(driver_wish *self) { driver_wish_step(self); }

void driver_wish_step(driver_wish *self) {
    self->out.set_speed = self->in.wish;
    self->out.reason = REASON_WISH;
}
