#include "flow.h"

#include <math.h>

#include "right_of_way.h"

#define LEFT_ITS_LANE 0.6 /* of a change's time */
#define AWAY INT32_MAX    /* the path of an empty place: at the end of the order */

static bool is_changing(const flow_user *user) {
    return user->lane != user->old_lane && user->shift.progress < 1;
}

void flow_set_paths(flow *self, const flow_path *otherwise) {
    for (int32_t p = 0; p < TRAFFIC_PATHS; ++p) {
        flow_path *path = &self->paths[p];
        *path = *otherwise;
        if (!(self->in->paths[p].length > 0)) continue;
        path->length = self->in->paths[p].length;
        path->lap = self->in->paths[p].closed ? path->length : 0;
        path->right = self->in->paths[p].rightmost;
        path->left = self->in->paths[p].leftmost;
        path->lanes = self->in->paths[p].lanes;
        if (self->in->paths[p].lane_width > 0) path->lane_width = self->in->paths[p].lane_width;
    }
}

static bool comes_before(const flow_place *one, const flow_place *other) {
    if (one->path != other->path) return one->path < other->path;
    return one->station < other->station || (one->station == other->station && one->who > other->who);
}

/* Nearly sorted since the last time: users pass each other now and then. */
static void sort(flow *self) {
    flow_place *order = self->order;
    for (int32_t k = 0; k < self->count; ++k) {
        const flow_user *user = &self->users[order[k].who];
        double lap = user->class == 0 ? 0 : self->paths[user->path].lap, station = user->station;
        order[k].path = user->class == 0 ? AWAY : user->path;
        order[k].station = user->class == 0 ? 0 : lap > 0 ? station - lap * floor(station / lap) : station;
    }
    for (int32_t k = 1; k < self->count; ++k) {
        flow_place place = order[k];
        int32_t at = k;
        for (; at > 0 && comes_before(&place, &order[at - 1]); --at) order[at] = order[at - 1];
        order[at] = place;
    }
}

static void set_lanes(flow_user *user) {
    bool in_both = is_changing(user) && user->shift.progress < LEFT_ITS_LANE;
    int32_t other = in_both ? user->old_lane : user->lane;
    user->low = user->lane < other ? user->lane : other;
    user->high = user->lane < other ? other : user->lane;
}

/* The users of one path, from order[begin] to order[end - 1], from one end to the other. On a closed path twice, as the
   last user is next to the first one. */
static void look_along(flow *self, int32_t begin, int32_t end, bool is_ahead) {
    int32_t seen[2 * FLOW_LANES + 3];
    int32_t *of_lane = seen + FLOW_LANES + 1;
    bool is_closed = self->paths[self->order[begin].path].lap > 0;
    for (int32_t lane = -FLOW_LANES - 1; lane <= FLOW_LANES + 1; ++lane) of_lane[lane] = FLOW_NOBODY;
    for (int32_t round = is_closed ? 0 : 1; round < 2; ++round) {
        for (int32_t k = 0; k < end - begin; ++k) {
            int32_t who = self->order[is_ahead ? end - 1 - k : begin + k].who;
            flow_user *user = &self->users[who];
            if (user->lane < -FLOW_LANES || user->lane > FLOW_LANES) continue;
            if (round == 1) {
                int32_t *next = is_ahead ? user->ahead : user->behind;
                for (int32_t n = 0; n < 3; ++n) {
                    int32_t found = of_lane[user->lane + n - 1];
                    next[n] = found == who ? FLOW_NOBODY : found;
                }
            }
            for (int32_t lane = user->low; lane <= user->high; ++lane) of_lane[lane] = who;
        }
    }
}

/* The users of one path, after one of them has changed lanes, or all have moved. */
static void look_around(flow *self, int32_t path) {
    int32_t begin = 0, end = 0;
    while (begin < self->count && self->order[begin].path < path) ++begin;
    for (end = begin; end < self->count && self->order[end].path == path;) ++end;
    if (begin == end) return;
    look_along(self, begin, end, true);
    look_along(self, begin, end, false);
}

void flow_look(flow *self) {
    sort(self);
    for (int32_t i = 0; i < self->count; ++i) {
        if (!self->users[i].walks) set_lanes(&self->users[i]);
    }
    for (int32_t begin = 0, end; begin < self->count && self->order[begin].path != AWAY; begin = end) {
        for (end = begin; end < self->count && self->order[end].path == self->order[begin].path;) ++end;
        look_along(self, begin, end, true);
        look_along(self, begin, end, false);
    }
}

void flow_begin(flow *self) {
    for (int32_t i = 0; i < self->count; ++i) {
        self->order[i].who = i;
        self->users[i].stop = self->users[i].stopped = self->users[i].limit = HUGE_VAL;
        self->users[i].head = 0;
        self->users[i].goes = 0;
    }
    flow_look(self);
}

/* The acceleration of *who* behind *ahead* at that gap; the host is assumed to drive as *judge*. */
static double acceleration_of(const flow *self, int32_t who, int32_t judge, double gap, int32_t ahead) {
    bool is_host = who == FLOW_HOST || self->users[who].is_host;
    const following_driver *driver = &self->users[is_host ? judge : who].driver;
    return following_acceleration(driver, flow_speed_of(self, who), gap, ahead == FLOW_NOBODY ? 0 : flow_speed_of(self, ahead));
}

static double own_acceleration(const flow *self, int32_t i, int32_t lane) {
    flow_neighbour ahead = flow_next(self, i, lane, true);
    return acceleration_of(self, i, i, ahead.gap, ahead.who);
}

/* Gain of the user behind *i* on *lane* if *i* enters it (or, sign -1, leaves it); *with*: acceleration behind *i*. */
static double gain_behind(const flow *self, int32_t i, int32_t lane, double sign, double *with) {
    flow_neighbour behind = flow_next(self, i, lane, false), ahead = flow_next(self, i, lane, true);
    *with = 0;
    if (behind.who == FLOW_NOBODY) return 0;
    if (behind.who != FLOW_HOST && self->users[behind.who].walks && !self->users[behind.who].is_host) return 0;
    bool alone = ahead.who == FLOW_NOBODY || ahead.who == behind.who; /* then, on a closed path, it is ahead of itself */
    double whole = behind.gap + flow_length_of(self, i) + ahead.gap;
    double without = acceleration_of(self, behind.who, i, alone ? HUGE_VAL : whole, alone ? FLOW_NOBODY : ahead.who);
    *with = acceleration_of(self, behind.who, i, behind.gap, i);
    return sign * (*with - without);
}

/* MOBIL's advantage over its threshold of a change to *lane*; negative where a change is not allowed. */
static double incentive(const flow *self, int32_t i, int32_t lane) {
    const flow_user *user = &self->users[i];
    const flow_rules *rules = &self->rules;
    flow_neighbour ahead = flow_next(self, i, lane, true), behind = flow_next(self, i, lane, false);
    if (ahead.gap <= 0 || behind.gap <= 0) return -HUGE_VAL;
    double follows, followed, there = own_acceleration(self, i, lane), here = own_acceleration(self, i, user->lane);
    double gains = gain_behind(self, i, lane, 1, &follows) + gain_behind(self, i, user->lane, -1, &followed);
    double safe = rules->safe_deceleration * (user->driver.max_deceleration / user->dry.max_deceleration);
    if (follows < -safe || there < -safe) return -HUGE_VAL;
    double bias = lane > user->lane ? rules->keep_right : -rules->keep_right;
    return there - here + rules->politeness * gains - rules->change_threshold - bias;
}

/* One after the other, so that two users do not take the same gap. */
static void change_lanes(flow *self) {
    for (int32_t i = 0; i < self->count; ++i) {
        flow_user *user = &self->users[i];
        if (self->rules.deciding > 1 && (self->steps + i) % self->rules.deciding != 0) continue;
        if (!flow_drives(user) || is_changing(user) || user->speed == 0) continue;
        const flow_path *path = &self->paths[user->path];
        int32_t left = user->lane + 1, right = user->lane - 1;
        bool may_left = left <= path->left && left < FLOW_LANES && flow_may_use(path, left, user->class);
        bool may_right = right >= path->right && right > -FLOW_LANES && flow_may_use(path, right, user->class);
        double leftwards = may_left ? incentive(self, i, left) : -HUGE_VAL;
        double rightwards = may_right ? incentive(self, i, right) : -HUGE_VAL;
        if (!(leftwards > 0 || rightwards > 0)) continue;
        int32_t lane = leftwards >= rightwards ? left : right;
        double from = flow_middle(path, user->lane), to = flow_middle(path, lane);
        lane_shift shift = {from, to, self->rules.change_duration, 0};
        user->old_lane = user->lane;
        user->lane = lane;
        user->shift = shift;
        set_lanes(user);
        look_around(self, user->path);
    }
}

/* During a lane change the smaller one of both lanes. */
static double wanted_acceleration(const flow *self, int32_t i) {
    const flow_user *user = &self->users[i];
    double wanted = own_acceleration(self, i, user->lane);
    if (is_changing(user) && user->shift.progress < LEFT_ITS_LANE) {
        wanted = fmin(wanted, own_acceleration(self, i, user->old_lane));
    }
    if (user->stop < HUGE_VAL) wanted = fmin(wanted, following_acceleration(&user->driver, user->speed, user->stop, 0));
    return fmin(wanted, user->limit);
}

static void move(flow_user *user, double h) {
    double before = user->speed, after = before + user->acceleration * h;
    double travelled = after < 0 ? -0.5 * before * before / user->acceleration : 0.5 * (before + after) * h;
    user->speed = fmax(after, 0);
    user->station += travelled;
    user->acceleration = (user->speed - before) / h;
    lane_shift_advance(&user->shift, travelled, h);
}

void flow_step(flow *self, double h) {
    double grip = traffic_grip(self->in);
    for (int32_t i = 0; i < self->count; ++i) {
        if (flow_drives(&self->users[i])) self->users[i].driver = following_on(&self->users[i].dry, grip);
    }
    flow_look(self);
    change_lanes(self);
    right_of_way(self);
    for (int32_t i = 0; i < self->count; ++i) {
        if (flow_drives(&self->users[i])) self->users[i].acceleration = wanted_acceleration(self, i);
    }
    for (int32_t i = 0; i < self->count; ++i) {
        if (flow_drives(&self->users[i])) move(&self->users[i], h);
    }
}

traffic_mover flow_mover(const flow *self, int32_t i) {
    const flow_user *user = &self->users[i];
    const flow_path *path = &self->paths[user->path];
    bool is_on_road = flow_lane(path, user->lane) && flow_lane(path, user->old_lane);
    lane_shift_pose pose = lane_shift_at(&user->shift, user->speed);
    traffic_mover mover = {
        .id = user->id,
        .class = user->class,
        .length = user->length,
        .width = user->width,
        .height = user->height,
        .path = user->path,
        .station = user->station,
        .lane = is_on_road ? user->old_lane + (user->lane - user->old_lane) * pose.share : 0,
        .offset = is_on_road ? 0 : pose.offset,
        .turn = pose.turn,
        .speed = pose.speed,
        .acceleration = user->acceleration,
    };
    return mover;
}
