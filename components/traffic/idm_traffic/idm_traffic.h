/* Vehicles that follow each other and the host by the IDM (following.h) and change lanes by MOBIL: A. Kesting,
   M. Treiber, D. Helbing: Transportation Research Record 1999, 86 (2007), the symmetric rule, with a bias to the right
   if one is set. All see the state at the beginning of a step, then move by the ballistic update: M. Treiber,
   A. Kesting: Traffic Flow Dynamics, 2013, 10.2; who would drive backwards stands. Who changes lanes is in both until
   it has done 0.6 of the change's time, and is placed from the middle of the path's own lane by lanes of one width:
   nobody jumps, whatever the road's lanes do. The host is in every lane that its body, or that of a vehicle of that
   lane, would share; a vehicle judges the host behind it as if it drove like itself. */
#ifndef IDM_TRAFFIC_H
#define IDM_TRAFFIC_H

#include "../profile/lane_shift.h"
#include "../profile/traffic.h"

typedef struct {
    double station, speed; /* m along the path, of its centre */
    int32_t lane, old_lane; /* where it is or goes, where it came from */
    lane_shift shift;
} idm_traffic_vehicle;

typedef struct {
    traffic_in in;
    traffic_out out;
    struct {
        int32_t class[TRAFFIC_MOVERS], lane_number[TRAFFIC_MOVERS];
        double station[TRAFFIC_MOVERS], speed[TRAFFIC_MOVERS];
        double desired_speed[TRAFFIC_MOVERS], time_gap[TRAFFIC_MOVERS], standstill_gap[TRAFFIC_MOVERS];
        double max_acceleration[TRAFFIC_MOVERS], comfortable_deceleration[TRAFFIC_MOVERS];
        double length[TRAFFIC_MOVERS], width[TRAFFIC_MOVERS], height[TRAFFIC_MOVERS];
        int32_t model;
        double max_deceleration;
        int32_t right_lane, left_lane;
        double lane_width, change_duration;
        double politeness, change_threshold, keep_right, safe_deceleration;
        bool minds_host;
        int32_t host_lane;
        double host_front, host_rear, host_width, lap_length;
    } par;
    idm_traffic_vehicle vehicles[TRAFFIC_MOVERS];
} idm_traffic;

void idm_traffic_init(idm_traffic *self);
void idm_traffic_step(idm_traffic *self, double h);

#endif
