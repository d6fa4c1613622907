#include "population.h"

#include <math.h>

#include "guests.h"
#include "random_draw.h"
#include "walkers.h"

#define IDM_PLUS 1          /* of model */
#define SPREAD_OF_GAPS 0.8  /* share of the free gap between two vehicles at the start */
#define BEFORE_PLACE 10.0   /* m */
#define TRUCK_EFFORT 0.5    /* factor of the acceleration of others */

typedef struct {
    double length, width, height;
} size;

static const size SIZES[] = {{0, 0, 0}, {4.5, 1.8, 1.5}, {12, 2.5, 3.5}, {2.2, 0.8, 1.5}};

/* Mean 0, standard deviation 1, never beyond 3.5: the sum of four. */
static double normal(const stream_traffic *self, int32_t id, int32_t number) {
    double sum = 0;
    for (int32_t n = 0; n < 4; ++n) sum += random_draw(self, id, number + n);
    return (sum - 2) * sqrt(3);
}

/* On a lane that is not for the drawn class, the first that may use it. */
static int32_t class_of(const stream_traffic *self, int32_t id, const flow_path *path, int32_t lane) {
    double drawn = random_draw(self, id, 0), trucks = self->par.truck_share;
    int32_t other = drawn < trucks + self->par.motorcycle_share ? TRAFFIC_MOTORCYCLE : TRAFFIC_CAR;
    int32_t class = drawn < trucks ? TRAFFIC_TRUCK : other;
    for (int32_t n = TRAFFIC_CAR; n <= TRAFFIC_MOTORCYCLE && !flow_may_use(path, lane, class); ++n) class = n;
    return class;
}

static void set_lane(flow_user *user, const flow *all, int32_t lane) {
    double offset = flow_middle(&all->paths[user->path], lane);
    user->lane = user->old_lane = lane;
    user->shift = (lane_shift){offset, offset, all->rules.change_duration, 1};
}

static flow_user vehicle(stream_traffic *self, const flow *all, int32_t path, int32_t lane) {
    int32_t id = ++self->ids, class = class_of(self, id, &all->paths[path], lane);
    bool is_truck = class == TRAFFIC_TRUCK;
    double mean = is_truck ? self->par.truck_speed : self->par.desired_speed;
    flow_user user = {
        .id = id,
        .class = class,
        .path = path,
        .length = SIZES[class].length,
        .width = SIZES[class].width,
        .height = SIZES[class].height,
        .stop = HUGE_VAL,
        .stopped = HUGE_VAL,
        .limit = HUGE_VAL,
    };
    user.dry = (following_driver){
        fmax(1 + self->par.speed_spread * normal(self, id, 1), 0.1) * mean,
        self->par.time_gap,
        self->par.standstill_gap,
        self->par.max_acceleration * (is_truck ? TRUCK_EFFORT : 1),
        self->par.comfortable_deceleration,
        self->par.max_deceleration,
        self->par.model == IDM_PLUS,
    };
    user.driver = following_on(&user.dry, traffic_grip(&self->in));
    set_lane(&user, all, lane);
    return user;
}

static bool is_for_vehicles(const flow_path *path, int32_t lane) {
    bool any = false;
    for (int32_t class = TRAFFIC_CAR; class <= TRAFFIC_MOTORCYCLE; ++class) any = any || flow_may_use(path, lane, class);
    return any;
}

/* How many lanes are for vehicles. */
static int32_t lanes_of(const flow_path *path) {
    int32_t count = path->left < path->right ? 1 : 0;
    for (int32_t lane = path->right; lane <= path->left; ++lane) count += is_for_vehicles(path, lane);
    return count;
}

/* The one with that *number* of them, counted from 0 and from the right. */
static int32_t lane_of(const flow_path *path, int32_t number) {
    int32_t lane = path->right;
    while (lane < path->left && (!is_for_vehicles(path, lane) || number-- > 0)) ++lane;
    return lane;
}

/* Number of vehicles on each path at the start. */
static int32_t shared_out(const stream_traffic *self, const flow *all, int32_t *counts) {
    double sum = 0, before = 0;
    int32_t total = 0;
    for (int32_t p = 0; p < TRAFFIC_PATHS; ++p) sum += self->par.path_share[p];
    for (int32_t p = 0; p < TRAFFIC_PATHS; ++p) {
        double share = sum > 0 ? self->par.path_share[p] / sum : 0, wanted = self->par.count;
        if (self->par.density > 0) {
            wanted = self->par.density * all->paths[p].length * lanes_of(&all->paths[p]) * (share > 0 ? 1 : 0);
            counts[p] = (int32_t)fmin(rint(wanted), STREAM_USERS + 1);
        } else {
            counts[p] = (int32_t)(rint(wanted * (before + share)) - rint(wanted * before));
            before += share;
        }
        total += counts[p];
    }
    return total;
}

/* The vehicles of a path, row by row. */
static bool fill(stream_traffic *self, flow *all, int32_t path, int32_t count) {
    const flow_path *way = &all->paths[path];
    int32_t lanes = lanes_of(way), rows = lanes > 0 ? (count + lanes - 1) / lanes : 0;
    if (count > 0 && lanes == 0) return false;
    double from = self->par.start_from, to = self->par.start_to > 0 ? self->par.start_to : way->length;
    double longest = SIZES[self->par.truck_share > 0 ? TRAFFIC_TRUCK : TRAFFIC_CAR].length;
    double spacing = rows > 0 ? (to - from) / rows : HUGE_VAL, room = spacing - longest - self->par.standstill_gap;
    if (rows > 0 && !(room >= 0 && to <= way->length)) return false;
    double speed = (1 - SPREAD_OF_GAPS) * room / self->par.time_gap;
    for (int32_t n = 0; n < count; ++n) {
        flow_user user = vehicle(self, all, path, lane_of(way, n % lanes));
        double moved = SPREAD_OF_GAPS * (random_draw(self, user.id, 8) - 0.5);
        user.station = from + (n / lanes + 0.5) * spacing + moved * room;
        user.speed = fmin(speed, user.driver.desired_speed);
        self->users[self->count++] = user;
    }
    return true;
}

static bool has_room(const flow *all, int32_t i, double *speed) {
    const flow_user *user = &all->users[i];
    const following_driver *driver = &user->driver;
    flow_neighbour ahead = flow_next(all, i, user->lane, true), behind = flow_next(all, i, user->lane, false);
    *speed = driver->desired_speed;
    if (ahead.who != FLOW_NOBODY) {
        double its = ahead.who == FLOW_HOST ? all->in->motion.speed : all->users[ahead.who].speed;
        if (!(ahead.gap > 2 * driver->standstill_gap)) return false;
        *speed = fmin(*speed, (ahead.gap - driver->standstill_gap) / driver->time_gap);
        *speed = fmin(*speed, its + sqrt(driver->comfortable_deceleration * ahead.gap));
    }
    if (behind.who == FLOW_NOBODY) return true;
    double its = behind.who == FLOW_HOST ? all->in->motion.speed : all->users[behind.who].speed;
    double closing = fmax(its - *speed, 0);
    return behind.gap > driver->standstill_gap + its * driver->time_gap +
                            closing * closing / (2 * driver->comfortable_deceleration);
}

/* Whether it would start where its path meets one of a smaller number, or too close to stop before. */
static bool is_where_paths_meet(const stream_traffic *self, const flow *all, const flow_user *user) {
    double least = 0.5 * user->speed * user->speed / user->driver.comfortable_deceleration + BEFORE_PLACE;
    for (int32_t n = 0; n < TRAFFIC_CONFLICTS; ++n) {
        double entry = self->in.conflicts[n].entry, in = self->in.conflicts[n].exit - entry + self->par.together[n];
        if (self->in.conflicts[n].path != user->path || self->in.conflicts[n].other_path >= user->path) continue;
        double way = traffic_ahead(all->paths[user->path].lap, user->station + 0.5 * user->length, entry);
        if (in > 0 && way < least && -way - user->length < in) return true;
    }
    return false;
}

static void keep_places_free(stream_traffic *self, const flow *all) {
    for (int32_t i = 0; i < self->count; ++i) {
        flow_user *user = &self->users[i];
        if (!flow_drives(user) || !is_where_paths_meet(self, all, user)) continue;
        self->waiting[i] = user->path + 1;
        user->class = 0;
    }
}

/* Users too close to the host at the start wait for room. False: there are none. */
static bool make_room_for_host(stream_traffic *self, const flow *all) {
    double speed = self->in.motion.speed;
    bool is_changed = false;
    for (int32_t i = 0; i < self->count; ++i) {
        flow_user *user = &self->users[i];
        if (!flow_drives(user)) continue;
        for (int32_t side = 0; side < 2; ++side) {
            flow_neighbour next = flow_next(all, i, user->lane, side == 1);
            double closing = fmax(side == 1 ? user->speed - speed : speed - user->speed, 0);
            double least = self->par.standstill_gap + fmax(user->speed, speed) * self->par.time_gap +
                           closing * closing / (2 * self->par.comfortable_deceleration);
            if (next.who != FLOW_HOST || !(next.gap < least)) continue;
            self->waiting[i] = user->path + 1;
            is_changed = true;
        }
    }
    for (int32_t i = 0; i < self->count; ++i) {
        if (self->waiting[i]) self->users[i].class = 0;
    }
    return is_changed;
}

bool population_begin(stream_traffic *self, flow *all) {
    int32_t counts[TRAFFIC_PATHS];
    self->count = self->ids = 0;
    for (int32_t i = 0; i < STREAM_PLACES; ++i) self->users[i] = (flow_user){0};
    for (int32_t i = 0; i < STREAM_USERS; ++i) {
        self->walkers[i] = (stream_walker){0};
        self->waiting[i] = 0;
    }
    if (shared_out(self, all, counts) + self->par.cyclists + self->par.pedestrians > STREAM_USERS) return false;
    for (int32_t p = 0; p < TRAFFIC_PATHS; ++p) {
        if (!fill(self, all, p, counts[p])) return false;
    }
    for (int32_t n = 0; n < self->par.cyclists; ++n) walkers_add(self, all, TRAFFIC_BICYCLE, false);
    int32_t crossing = (int32_t)rint(self->par.pedestrians * self->par.crossing_share);
    for (int32_t n = 0; n < self->par.pedestrians; ++n) walkers_add(self, all, TRAFFIC_PEDESTRIAN, n < crossing);
    all->count = self->count + TRAFFIC_HOSTS;
    guests_step(self, all);
    keep_places_free(self, all);
    do {
        flow_begin(all);
    } while (make_room_for_host(self, all));
    return true;
}

/* The first user that waits for room on a path tries its lanes in turn. */
static void come_in(stream_traffic *self, flow *all, int32_t i) {
    const flow_path *path = &all->paths[self->waiting[i] - 1];
    double speed;
    int32_t ids = self->ids;
    int32_t lane = lane_of(path, (int32_t)(self->steps % lanes_of(path)));
    self->users[i] = vehicle(self, all, self->waiting[i] - 1, lane);
    self->users[i].station = 0.5 * self->users[i].length;
    flow_look(all);
    if (has_room(all, i, &speed)) {
        self->users[i].speed = speed;
        self->waiting[i] = 0;
    } else {
        self->users[i].class = 0;
        self->ids = ids;
    }
}

void population_exchange(stream_traffic *self, flow *all) {
    bool has_tried[TRAFFIC_PATHS] = {false};
    for (int32_t i = 0; i < self->count; ++i) {
        flow_user *user = &self->users[i];
        const flow_path *path = &all->paths[user->path];
        bool is_out = flow_drives(user) && path->lap == 0 && user->station + 0.5 * user->length >= path->length;
        if (!is_out) continue;
        user->class = 0;
        self->waiting[i] = user->path + 1;
    }
    for (int32_t i = 0; i < self->count; ++i) {
        int32_t path = self->waiting[i] - 1;
        if (path < 0 || has_tried[path]) continue;
        has_tried[path] = true;
        come_in(self, all, i);
    }
}
