#include "no_lane_support.h"

void no_lane_support_init(no_lane_support *self) {
    self->out.active = false;
    no_lane_support_step(self);
}

void no_lane_support_step(no_lane_support *self) {
    self->out.steering = self->in.wish;
}
