/* A road user that waits beside the host's lane, crosses it and stops again: it accelerates, walks, and decelerates at
   the same rate. It starts so that it is at the conflict point when the host's front would be there at constant speed
   (the collision course of the pedestrian tests of Euro NCAP AEB VRU), or at a fixed time. Its motion after the start
   is independent of the host. The start time may be between two steps; if it is before the run, the road user moves at
   the start of the run. If the host jumps nearer, it starts late: it never jumps itself. */
#ifndef CROSSING_H
#define CROSSING_H

#include "../profile/speed_profile.h"
#include "../profile/traffic.h"

typedef struct {
    traffic_in in;
    traffic_out out;
    struct {
        int32_t road_user, lane_number, timing;
        double station, start_offset, end_offset, conflict_offset, conflict_time;
        double speed, acceleration, host_front, lap_length;
        double length, width, height;
    } par;
    double way, peak, lead;     /* m from start to end, m/s, s from its start to the conflict point */
    double sense;               /* 1 to the left, -1 to the right */
    double since;               /* its start time */
    bool has_set_out;
    counted_time time;
} crossing;

void crossing_init(crossing *self);
void crossing_step(crossing *self, double h);

#endif
