/* Many road users, generated from a seed: vehicles in traffic as in flow.h, cyclists and pedestrians along the side,
   and pedestrians that cross when no vehicle comes. At the start the vehicles of a lane are spread evenly except for a
   random part of the gaps. Where two paths meet, only the vehicles of the path with the smaller number are placed. A
   user that reaches the end of an open path leaves, and a new one, with its own id, enters at its start when there is
   room. If the users do not fit on the road at the start, the run fails (a place that is not a number).

   Eight of them are reported in *movers* (attention.c): users near the host on its path, the next ones on each lane
   first, and users that approach a conflict with it. A reported user keeps its place while it is among the eight, or
   nearly so. A place is empty for one step before it is reused. Sizes of the road users are assumed.

   Traffic of a shared world reacts to all of its cars (*hosts*, guests.c). */
#ifndef STREAM_TRAFFIC_H
#define STREAM_TRAFFIC_H

#include "../flow/flow.h"

#define STREAM_USERS 256
#define STREAM_PLACES (STREAM_USERS + TRAFFIC_HOSTS)

/* A cyclist or pedestrian. */
typedef struct {
    double offset, pace; /* m to the left of the middle of the path's own lane; m/s */
    double from, to;     /* m: range in which a crossing pedestrian crosses */
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
    flow_user users[STREAM_PLACES]; /* its own, then the cars of a shared world */
    flow_place order[STREAM_PLACES];
    stream_walker walkers[STREAM_USERS];
    int32_t waiting[STREAM_USERS]; /* path on which it waits for room, counted from 1; 0: it does not wait */
    int32_t count, ids;            /* users; assigned ids */
    bool fits;                     /* the users fit on the road */
    int32_t told[TRAFFIC_MOVERS];  /* users, FLOW_NOBODY: an empty place */
    int64_t steps;
    double step, base_time;        /* time is base_time + steps * step */
} stream_traffic;

void stream_traffic_init(stream_traffic *self);
void stream_traffic_step(stream_traffic *self, double h);

#endif
