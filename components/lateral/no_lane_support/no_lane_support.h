/* The driver's steering, as it is. */
#ifndef NO_LANE_SUPPORT_H
#define NO_LANE_SUPPORT_H

#include "../lane_support/lane_support.h"

typedef struct {
    lane_support_in in;
    lane_support_out out;
} no_lane_support;

void no_lane_support_init(no_lane_support *self);
void no_lane_support_step(no_lane_support *self);

#endif
