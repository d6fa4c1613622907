/* Up to eight vehicles, each with its own place and driver, in traffic as in flow.h. */
#ifndef IDM_TRAFFIC_H
#define IDM_TRAFFIC_H

#include "../flow/flow.h"

typedef struct {
    traffic_in in;
    traffic_out out;
    struct {
        int32_t class[TRAFFIC_MOVERS], path[TRAFFIC_MOVERS], lane_number[TRAFFIC_MOVERS];
        double station[TRAFFIC_MOVERS], speed[TRAFFIC_MOVERS];
        double desired_speed[TRAFFIC_MOVERS], time_gap[TRAFFIC_MOVERS], standstill_gap[TRAFFIC_MOVERS];
        double max_acceleration[TRAFFIC_MOVERS], comfortable_deceleration[TRAFFIC_MOVERS];
        double length[TRAFFIC_MOVERS], width[TRAFFIC_MOVERS], height[TRAFFIC_MOVERS];
        int32_t model;
        double max_deceleration;
        int32_t right_lane, left_lane;
        double lane_width, change_duration;
        double politeness, change_threshold, keep_right, safe_deceleration;
        double reaction_time, critical_gap, together[TRAFFIC_CONFLICTS];
        bool minds_host;
        int32_t host_lane;
        double host_front, host_rear, host_width, lap_length;
    } par;
    flow_user users[TRAFFIC_MOVERS];
    flow_place order[TRAFFIC_MOVERS];
} idm_traffic;

void idm_traffic_init(idm_traffic *self);
void idm_traffic_step(idm_traffic *self, double h);

#endif
