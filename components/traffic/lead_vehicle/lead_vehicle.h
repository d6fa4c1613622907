/* One vehicle ahead of the host on its path: that of straight_road, along any road. Its speed changes at most as the surface
   at the beginning of the change allows. */
#ifndef LEAD_VEHICLE_H
#define LEAD_VEHICLE_H

#include "../profile/speed_profile.h"
#include "../profile/traffic.h"

typedef struct {
    traffic_in in;
    traffic_out out;
    struct {
        double initial_gap, host_front;
        double lead_speed, lead_change_time, lead_change_rate, lead_final_speed;
        double lead_offset, lead_width, lead_length, lead_height;
        int32_t lead_lane;
    } par;
    double start; /* station of its centre */
    double grip;  /* m/s2, at the last step before the change */
    counted_time time;
} lead_vehicle;

void lead_vehicle_init(lead_vehicle *self);
void lead_vehicle_step(lead_vehicle *self, double h);

#endif
