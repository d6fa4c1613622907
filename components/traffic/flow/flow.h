/* Any number of road users along paths, in the order of their stations. Two passes, front to back and back to front,
   find the neighbours of all on their lanes. Vehicles follow each other and the host by the IDM (following.h), stop
   where they have to (right_of_way.h) and change lanes by MOBIL: A. Kesting, M. Treiber, D. Helbing: Transportation
   Research Record 1999, 86 (2007), the symmetric rule, with a bias to the right if one is set. All use the state at the
   beginning of a step, then move by the ballistic update: M. Treiber, A. Kesting: Traffic Flow Dynamics, 2013, 10.2; a
   speed below zero becomes zero. A user that changes lanes is in both until 0.6 of the change's time. Its place is a
   number of lanes, with a fraction during a change: the road, which has the geometry, puts it in the middle of its lane
   or between both, wherever they are. Its turn during a change is that of the lanes where the path begins. A user changes to no lane that its class may not use (in_the_way.h).
   The host is in every lane that its body, or that of a vehicle of that lane, would share, if all lanes are wider than at
   the start of the path by as much as its own. A vehicle assumes that the
   host behind it drives like itself. */
#ifndef FLOW_H
#define FLOW_H

#include <stddef.h>

#include "../../road_users/in_the_way.h"
#include "../profile/lane_shift.h"
#include "../profile/traffic.h"
#include "following.h"

#define FLOW_NOBODY (-1)
#define FLOW_HOST INT32_MAX /* its number among the others */
#define FLOW_LANES 10       /* lanes are -10 ... 10 */

typedef struct {
    following_driver dry, driver;    /* on a dry road, on the present surface */
    int32_t id, class;               /* class 0: empty place */
    bool walks;                      /* a walker is moved elsewhere, and is in the lanes from low to high */
    bool is_host;                    /* a walker that is a car of a shared world: it is assumed to drive as the host */
    int32_t path, lane, old_lane;    /* present or new lane, former lane */
    double length, width, height;
    double station, speed, acceleration; /* of its centre, m along the path; m/s, m/s2 along the lane */
    lane_shift shift;
    int32_t low, high;               /* the lanes it is in; none if low > high */
    int32_t behind[3], ahead[3];     /* the next users on the lanes to the right of its own, its own, to the left */
    double stop, stopped;            /* m from its front to its stopping point, now and a step before; infinite: none */
    double limit;                    /* m/s2: upper bound of its acceleration because of the right of way */
    int32_t head;                    /* the light of its decision, counted from 1 */
    bool runs;                       /* it has decided to pass the light */
    uint32_t goes;                   /* bits of the conflicts that it has decided to pass */
} flow_user;

/* A user's place in the order: by paths, then from the back to the front. */
typedef struct {
    double station; /* on a closed path less than a lap */
    int32_t path, who;
} flow_place;

typedef struct {
    double lap; /* m; 0: it is open */
    double length, lane_width; /* length 0: unknown */
    int32_t right, left; /* range of lanes for lane changes */
    const traffic_lane *lanes; /* of the road, from *right* on; NULL: all are lane_width wide, and for everyone */
} flow_path;

typedef struct {
    double change_duration, politeness, change_threshold, keep_right, safe_deceleration;
    int32_t deciding; /* steps between two decisions on a lane change */
    double reaction_time, critical_gap; /* s */
    const double *together; /* m for which the paths of each conflict are one lane after it; 0: they cross */
    bool minds_host;
    int32_t host_lane;
    double host_front, host_rear, host_width;
} flow_rules;

typedef struct {
    flow_user *users;
    flow_place *order;
    int32_t count;
    int64_t steps; /* done */
    const traffic_in *in;
    flow_rules rules;
    flow_path paths[TRAFFIC_PATHS];
} flow;

/* The next user on a lane, and the gap from bumper to bumper; infinite: none. */
typedef struct {
    int32_t who;
    double gap;
} flow_neighbour;

/* Path data of the road replaces *otherwise*. */
void flow_set_paths(flow *self, const flow_path *otherwise);

/* At the start: sorts all users; no decisions yet. */
void flow_begin(flow *self);

/* Finds the neighbours; needed after users were added, removed or moved. */
void flow_look(flow *self);

/* The next one on *lane*, which is the user's own or one beside it, ahead of user *i* or behind it; of two at one station
   the one with the smaller number is ahead. */
flow_neighbour flow_next(const flow *self, int32_t i, int32_t lane, bool is_ahead);

void flow_step(flow *self, double h);

traffic_mover flow_mover(const flow *self, int32_t i);

static inline double flow_speed_of(const flow *self, int32_t who) {
    return who == FLOW_HOST ? self->in->motion.speed : self->users[who].speed;
}

static inline double flow_length_of(const flow *self, int32_t who) {
    return who == FLOW_HOST ? self->rules.host_front + self->rules.host_rear : self->users[who].length;
}

/* The lane as the road has it; NULL: all that is known of it is the path's lane_width. */
static inline const traffic_lane *flow_lane(const flow_path *path, int32_t lane) {
    int32_t i = lane - path->right;
    return path->lanes && i >= 0 && i < TRAFFIC_LANES && path->lanes[i].width > 0 ? &path->lanes[i] : NULL;
}

/* m to the left of the middle of the path's own lane. */
static inline double flow_middle(const flow_path *path, int32_t lane) {
    const traffic_lane *found = flow_lane(path, lane);
    return found ? found->middle : lane * path->lane_width;
}

static inline double flow_width(const flow_path *path, int32_t lane) {
    const traffic_lane *found = flow_lane(path, lane);
    return found ? found->width : path->lane_width;
}

static inline bool flow_may_use(const flow_path *path, int32_t lane, int32_t class) {
    const traffic_lane *found = flow_lane(path, lane);
    return !found || may_drive(found->users, class);
}

static inline bool flow_drives(const flow_user *user) {
    return user->class != 0 && !user->walks;
}

#endif
