#include "walkers.h"

#include <math.h>

#include "random_draw.h"

#define START_UP 3.0      /* s */
#define STANDS 0.5        /* m/s */
#define BEFORE 1.0        /* m between a vehicle at rest and a crossing pedestrian */
#define BODY 0.25         /* m from its middle to its side */
#define LOOKING 10        /* steps between two checks of approaching vehicles */
#define KERB 1.5          /* m from the edge of the lanes */

static double now(const stream_traffic *self) {
    return self->base_time + (double)self->steps * self->step;
}

/* Edge of the lanes: -1 on the right, 1 on the left. */
static double edge(const flow_path *path, int32_t side) {
    int32_t lane = side < 0 ? path->right : path->left;
    return flow_middle(path, lane) + side * 0.5 * flow_width(path, lane);
}

/* Where cyclists ride: in the rightmost lane that is for them alone, else beside the lanes. */
static double riding(const flow_path *path) {
    for (int32_t lane = path->right; lane <= path->left; ++lane) {
        bool is_theirs = flow_lane(path, lane) && flow_may_use(path, lane, TRAFFIC_BICYCLE);
        if (is_theirs && !flow_may_use(path, lane, TRAFFIC_CAR)) return flow_middle(path, lane);
    }
    return edge(path, -1) - 0.8;
}

void walkers_add(stream_traffic *self, const flow *all, int32_t class, bool crosses) {
    const flow_path *path = &all->paths[0];
    int32_t i = self->count++, id = ++self->ids;
    bool rides = class == TRAFFIC_BICYCLE;
    double from = self->par.start_from, to = self->par.start_to > 0 ? self->par.start_to : path->length;
    stream_walker *walker = &self->walkers[i];
    flow_user user = {
        .id = id, .class = class, .walks = true, .length = rides ? 1.8 : 0.5, .width = rides ? 0.6 : 0.5,
        .height = 1.75, .station = from + random_draw(self, id, 0) * (to - from), .low = 1,
    };
    self->users[i] = user;
    walker->crosses = crosses;
    walker->pace = rides ? 4 + 2 * random_draw(self, id, 1) : 1 + 0.5 * random_draw(self, id, 1);
    walker->sense = rides || random_draw(self, id, 2) < 0.5 ? 1 : -1;
    if (crosses) {
        walker->from = edge(path, -walker->sense) - walker->sense * KERB;
        walker->to = edge(path, walker->sense) + walker->sense * KERB;
        walker->offset = walker->from;
        walker->waits_until = 20 * random_draw(self, id, 3);
    } else {
        walker->offset = rides ? riding(path) : edge(path, -1) - (1.5 + random_draw(self, id, 3));
    }
}

/* Whether it can cross in *time* before a vehicle whose front is *way* before it, or past it. */
static bool lets_cross(double way, double length, double speed, double time) {
    if (way < 0) return -way > length + BEFORE;
    return speed < STANDS ? way > BEFORE : way / speed > time;
}

static bool may_cross(const stream_traffic *self, const flow *all, int32_t i) {
    const stream_walker *walker = &self->walkers[i];
    double time = fabs(walker->to - walker->from) / walker->pace + START_UP, station = self->users[i].station;
    double lap = all->paths[0].lap;
    for (int32_t n = 0; n < all->count; ++n) {
        const flow_user *user = &self->users[n];
        if (!(flow_drives(user) || user->is_host) || user->path != 0) continue;
        double way = traffic_ahead(lap, user->station + 0.5 * user->length, station);
        if (!lets_cross(way, user->length, user->speed, time)) return false;
    }
    if (!self->par.minds_host) return true;
    double front = traffic_ahead(lap, self->in.lane.station + self->par.host_front, station);
    return lets_cross(front, self->par.host_front + self->par.host_rear, self->in.motion.speed, time);
}

/* It is in all lanes that it has not left yet. */
static void set_lanes(flow_user *user, const stream_walker *walker, const flow_path *path) {
    user->low = 1;
    user->high = 0;
    if (!walker->is_crossing) return;
    double behind = walker->offset - walker->sense * BODY, half = 0.5 * walker->sense;
    int32_t lane = walker->sense > 0 ? path->right : path->left, last = walker->sense > 0 ? path->left : path->right;
    while (walker->sense * (last - lane) >= 0 &&
           walker->sense * (flow_middle(path, lane) + half * flow_width(path, lane) - behind) <= 0) {
        lane += walker->sense;
    }
    user->low = walker->sense > 0 ? lane : path->right;
    user->high = walker->sense > 0 ? path->left : lane;
    user->lane = user->old_lane = path->right;
}

static void cross(stream_traffic *self, const flow *all, int32_t i, double h) {
    stream_walker *walker = &self->walkers[i];
    if (walker->is_crossing) {
        double rest = fabs(walker->to - walker->offset);
        walker->offset += walker->sense * fmin(walker->pace * h, rest);
        if (rest <= walker->pace * h) {
            double kerb = walker->from;
            walker->from = walker->offset = walker->to;
            walker->to = kerb;
            walker->sense = -walker->sense;
            walker->is_crossing = false;
            walker->waits_until = now(self) + 5 + 20 * random_draw(self, self->users[i].id, 3);
        }
    } else if ((self->steps + i) % LOOKING == 0 && now(self) >= walker->waits_until) {
        walker->is_crossing = may_cross(self, all, i);
    }
    set_lanes(&self->users[i], walker, &all->paths[0]);
}

static void walk(stream_traffic *self, const flow_path *path, int32_t i, double h) {
    flow_user *user = &self->users[i];
    const stream_walker *walker = &self->walkers[i];
    bool is_out = walker->sense > 0 ? user->station >= path->length : user->station <= 0;
    if (path->lap == 0 && is_out) {
        user->id = ++self->ids;
        user->station = walker->sense > 0 ? 0 : path->length;
    } else {
        user->station += walker->sense * walker->pace * h;
    }
}

void walkers_step(stream_traffic *self, const flow *all, double h) {
    for (int32_t i = 0; i < self->count; ++i) {
        if (!self->users[i].walks) continue;
        if (self->walkers[i].crosses) {
            cross(self, all, i, h);
        } else {
            walk(self, &all->paths[0], i, h);
        }
    }
}

/* Along the road its place is relative to the rightmost lane, wherever that is. */
traffic_mover walkers_mover(const stream_traffic *self, const flow *all, int32_t i) {
    const flow_user *user = &self->users[i];
    const stream_walker *walker = &self->walkers[i];
    const flow_path *path = &all->paths[0];
    bool is_beside = !walker->crosses && flow_lane(path, path->right);
    double along = walker->sense > 0 ? 0 : 2 * TRAFFIC_QUARTER_TURN;
    traffic_mover mover = {
        .id = user->id,
        .class = user->class,
        .length = user->length,
        .width = user->width,
        .height = user->height,
        .station = user->station,
        .lane = is_beside ? path->right : 0,
        .offset = walker->offset - (is_beside ? flow_middle(path, path->right) : 0),
        .turn = walker->crosses ? walker->sense * TRAFFIC_QUARTER_TURN : along,
        .speed = walker->crosses && !walker->is_crossing ? 0 : walker->pace,
    };
    return mover;
}
