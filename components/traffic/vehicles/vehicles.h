/* Up to eight road users, each on its own path and lane with a speed that changes once, at most as the surface at the
 * beginning of the change allows. A stationary object that is not
 * in the way is an obstacle of speed 0: a post beside the lane, a manhole cover 20 mm high, a bridge with a clearance. */
#ifndef VEHICLES_H
#define VEHICLES_H

#include "../profile/speed_profile.h"
#include "../profile/traffic.h"

typedef struct {
    traffic_in in;
    traffic_out out;
    struct {
        int32_t class[TRAFFIC_MOVERS], path[TRAFFIC_MOVERS], lane_number[TRAFFIC_MOVERS];
        double station[TRAFFIC_MOVERS], offset[TRAFFIC_MOVERS], turn[TRAFFIC_MOVERS];
        double speed[TRAFFIC_MOVERS], change_time[TRAFFIC_MOVERS], change_rate[TRAFFIC_MOVERS];
        double final_speed[TRAFFIC_MOVERS];
        double length[TRAFFIC_MOVERS], width[TRAFFIC_MOVERS], height[TRAFFIC_MOVERS];
        double clearance[TRAFFIC_MOVERS];
    } par;
    double ahead[TRAFFIC_MOVERS], aside[TRAFFIC_MOVERS]; /* of its heading in its lane */
    double grip[TRAFFIC_MOVERS];                         /* m/s2, at the last step before the change */
    counted_time time;
} vehicles;

void vehicles_init(vehicles *self);
void vehicles_step(vehicles *self, double h);

#endif
