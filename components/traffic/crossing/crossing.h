/* Someone who stands beside the host's lane, crosses it and stands again: speeds up, walks, and slows down as fast.
   It sets out so early that it is at the conflict point when the host's front would be there if it kept its speed
   (the collision course of the pedestrian tests of Euro NCAP AEB VRU), or at a fixed time. What it does afterwards
   does not depend on the host. The moment it sets out lies between two steps; who would have had to set out before
   the run is under way at its start. A host that comes nearer by a jump finds it late: it never jumps itself. */
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
    double way, peak, lead;     /* m from start to end, m/s, s from setting out to the conflict point */
    double sense;               /* 1 to the left, -1 to the right */
    double since;               /* time when it set out */
    bool has_set_out;
    counted_time time;
} crossing;

void crossing_init(crossing *self);
void crossing_step(crossing *self, double h);

#endif
