#include "no_aeb.h"

void no_aeb_init(no_aeb *self) {
    self->out = (emergency_out){STAGE_NONE, 0, 0};
}

void no_aeb_step(no_aeb *self) {
    (void)self;
}
