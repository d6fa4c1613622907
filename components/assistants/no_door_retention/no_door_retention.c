#include "no_door_retention.h"

void no_door_retention_init(no_door_retention *self) {
    self->out.retained = false;
}

void no_door_retention_step(no_door_retention *self) {
    (void)self;
}
