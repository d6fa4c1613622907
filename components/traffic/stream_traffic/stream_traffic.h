/* Many road users, made from a seed: vehicles in traffic as flow.h has it, cyclists and pedestrians along the side, and
   pedestrians who cross when nobody comes. At the start the vehicles of a lane are spread evenly but for a random part of
   the gaps; where two paths meet, only those of the path with the smaller number are. Who reaches the end of an open
   path leaves, and somebody new, with an id of its own, comes in at its start when there is room. What does not fit on
   the road at the start ends the run by name (a place that is no number).

   Of all of them, eight are told in *movers* (attention.c): who is near the host on its path, the next ones on each lane
   first, and who comes to a conflict with it. Who is told stays in its place while it is among the eight, or nearly so; a
   place is empty for a step before another one takes it. Sizes of the road users are assumed. */
#ifndef STREAM_TRAFFIC_H
#define STREAM_TRAFFIC_H

#include "../flow/flow.h"

#define STREAM_USERS 256

/* A cyclist or pedestrian. */
typedef struct {
    double offset, pace; /* m to the left of the middle of the path's own lane; m/s */
    double from, to;     /* who crosses: m between which it does */
    double waits_until;  /* s */
    int32_t sense;       /* 1: along the path, or to the left */
    bool crosses, is_crossing;
} stream_walker;

typedef struct {
    traffic_in in;
    struct {
        traffic_mover movers[TRAFFIC_MOVERS];
        traffic_mover everyone[STREAM_USERS];
    } out;
    struct {
        int32_t seed, count;
        double density, path_share[TRAFFIC_PATHS], truck_share, motorcycle_share;
        int32_t cyclists, pedestrians;
        double crossing_share, start_from, start_to;
        double desired_speed, truck_speed, speed_spread;
        double time_gap, standstill_gap, max_acceleration, comfortable_deceleration;
        int32_t model;
        double max_deceleration, change_duration, decision_period;
        double politeness, change_threshold, keep_right, safe_deceleration;
        double reaction_time, critical_gap, together[TRAFFIC_CONFLICTS];
        double path_length;
        bool closed;
        int32_t right_lane, left_lane;
        double lane_width;
        bool minds_host;
        int32_t host_lane;
        double host_front, host_rear, host_width;
    } par;
    flow_user users[STREAM_USERS];
    flow_place order[STREAM_USERS];
    stream_walker walkers[STREAM_USERS];
    int32_t waiting[STREAM_USERS]; /* for room on that path, counted from 1; 0: it is there, or there is nobody */
    int32_t count, ids;            /* users; ids that were given */
    bool fits;                     /* they do, on the road */
    int32_t told[TRAFFIC_MOVERS];  /* users, FLOW_NOBODY: an empty place */
    int64_t steps;
    double step, base_time;        /* time is base_time + steps * step */
} stream_traffic;

void stream_traffic_init(stream_traffic *self);
void stream_traffic_step(stream_traffic *self, double h);

#endif
