#include "right_of_way.h"

#include <math.h>

#define SLOW 3.0      /* m/s; a slower user is assumed to accelerate */
#define STANDS 0.5    /* m/s */
#define SETTING_OUT 1.5 /* m/s2 of a user that starts */
#define CLEARANCE 1.0 /* s between a leaving and an arriving user */
#define NEAR 30.0     /* m added to the comfortable stopping distance: conflicts within it are considered */
#define OTHERS 128    /* users near a conflict */
#define AHEAD 10.0    /* s longer than the critical gap: later users are ignored */

/* A user of the other path. */
typedef struct {
    double way; /* m from its front to the entry */
    double length, speed;
    bool is_held; /* it stops before the conflict */
    bool goes;    /* it must give way, but has decided to drive */
} coming;

typedef struct {
    double entry, way, other_way; /* m; length of the conflict on both paths */
    double together;              /* m for which they are one lane after it */
    int32_t path, other_path;
    coming others[OTHERS];
    int32_t count;
    bool gives_way;
    uint32_t bit, other_bit; /* of this conflict, and of the same conflict for the other path */
} meeting;

static double front_of(const flow_user *user) {
    return user->station + 0.5 * user->length;
}

static double comfortable_way(const flow_user *user) {
    return user->speed * user->speed / (2 * user->driver.comfortable_deceleration);
}

static bool is_obeyed(int32_t colour) {
    return colour == TRAFFIC_RED || colour == TRAFFIC_RED_YELLOW || colour == TRAFFIC_YELLOW;
}

static void see_light(flow *self, flow_user *user) {
    double nearest = HUGE_VAL, lap = self->paths[user->path].lap;
    int32_t head = 0;
    for (int32_t n = 0; n < TRAFFIC_HEADS; ++n) {
        if (self->in->light_heads[n].colour == 0 || self->in->light_heads[n].path != user->path) continue;
        double way = traffic_ahead(lap, front_of(user), self->in->light_heads[n].station);
        if (!(way >= 0 && way < nearest)) continue;
        nearest = way;
        head = n + 1;
    }
    int32_t colour = head ? self->in->light_heads[head - 1].colour : 0;
    if (!is_obeyed(colour)) {
        user->head = 0;
        return;
    }
    if (user->head != head) {
        double reaction = user->speed * self->rules.reaction_time;
        user->runs = colour == TRAFFIC_YELLOW && nearest < reaction + comfortable_way(user);
        user->head = head;
    }
    double least = user->speed * user->speed / (2 * user->driver.max_deceleration);
    if (colour != TRAFFIC_YELLOW) user->runs = nearest < least;
    if (!user->runs) user->stop = fmin(user->stop, nearest);
}

static double time_to(const coming *other, double way) {
    if (way <= 0) return 0;
    if (other->speed >= SLOW) return way / other->speed;
    return 2 * way / (other->speed + sqrt(other->speed * other->speed + 2 * SETTING_OUT * way));
}

/* The users that approach the conflict, or are in it. */
static void gather(const flow *self, double entry, meeting *met) {
    int32_t path = met->other_path;
    double lap = self->paths[path].lap, in = met->other_way + met->together;
    met->count = 0;
    for (int32_t k = 0; k < self->count && self->order[k].path <= path && met->count < OTHERS; ++k) {
        if (self->order[k].path != path) continue;
        const flow_user *user = &self->users[self->order[k].who];
        if (user->walks && !user->is_host) continue;
        double way = traffic_ahead(lap, front_of(user), entry);
        if (-way - user->length >= in || way > (self->rules.critical_gap + AHEAD) * (user->speed + 1)) continue;
        bool is_held = fmin(user->stop, user->stopped) <= way + 1 && user->goes == 0;
        if (user->is_host) is_held = user->speed < STANDS && way > 0;
        met->others[met->count++] = (coming){way, user->length, user->speed, is_held, (user->goes & met->other_bit) != 0};
    }
    if (!self->rules.minds_host || path != 0 || met->count == OTHERS) return;
    const flow_rules *rules = &self->rules;
    double way = traffic_ahead(lap, self->in->lane.station + rules->host_front, entry);
    double length = rules->host_front + rules->host_rear, speed = self->in->motion.speed;
    if (-way - length >= in) return;
    met->others[met->count++] = (coming){way, length, speed, speed < STANDS && way > 0, false};
}

/* Whether there is room for it after the conflict. */
static bool can_leave(const flow *self, const meeting *met, int32_t i, double way) {
    flow_neighbour ahead = flow_next(self, i, self->users[i].lane, true);
    if (ahead.who == FLOW_NOBODY) return true;
    double speed = ahead.who == FLOW_HOST ? self->in->motion.speed : self->users[ahead.who].speed;
    return speed > 1 || ahead.gap > way + met->way + self->users[i].length;
}

/* Whether it may drive, *way* before the conflict, considering approaching users. */
static bool accepts(const flow *self, const meeting *met, int32_t i, double way) {
    const flow_user *user = &self->users[i];
    double arrives = user->speed > 1 ? way / user->speed : 0;
    double speed = user->speed, effort = user->driver.max_acceleration;
    double soonest = 2 * way / (speed + sqrt(speed * speed + 2 * effort * way));
    if (!can_leave(self, met, i, way)) return false;
    for (int32_t k = 0; k < met->count; ++k) {
        const coming *other = &met->others[k];
        if (other->way < 0 || other->is_held) continue;
        bool comes_later = time_to(other, other->way) >= arrives + self->rules.critical_gap;
        bool is_past = time_to(other, other->way + other->length + met->other_way) + CLEARANCE <= soonest;
        if (!comes_later && !is_past) return false;
    }
    return true;
}

/* Whether a user in the conflict, or about to enter, is still in it when the one *way* before it arrives. */
static bool is_taken(const meeting *met, const flow_user *user, double way) {
    double arrives = way / fmax(user->speed, 1), leaves = (way + met->way + user->length) / fmax(user->speed, 1);
    for (int32_t k = 0; k < met->count; ++k) {
        const coming *other = &met->others[k];
        double rest = other->way + other->length + met->other_way;
        if (rest <= 0 || (other->way > 0 && !(other->goes && time_to(other, other->way) < leaves))) continue;
        if (!(rest / fmax(other->speed, 0.1) + CLEARANCE <= arrives)) return true;
    }
    return false;
}

/* How far in it is, scaled as if the conflict had the same length on both paths. */
static double depth(const meeting *met, const coming *other) {
    double in = -other->way;
    return in > met->other_way ? met->way + in - met->other_way : in * met->way / met->other_way;
}

/* A user that is *in* follows those farther in; one that is about to join follows those that are in. */
static void follow(const meeting *met, flow_user *user, double in) {
    for (int32_t k = 0; k < met->count; ++k) {
        const coming *other = &met->others[k];
        double other_in = depth(met, other);
        if (other->way > 0 || !(other_in > in || (other_in == in && met->path > met->other_path))) continue;
        double gap = other_in - other->length - in;
        if (in < 0) gap = fmax(gap, -in);
        user->limit = fmin(user->limit, following_acceleration(&user->driver, user->speed, gap, other->speed));
    }
}

static void approach(const flow *self, const meeting *met, int32_t i) {
    flow_user *user = &self->users[i];
    double way = traffic_ahead(self->paths[user->path].lap, front_of(user), met->entry);
    double comfortable = comfortable_way(user);
    if (way > comfortable + NEAR || -way - user->length >= met->way + met->together) {
        user->goes &= ~met->bit;
        return;
    }
    if (way <= 0) {
        follow(met, user, -way);
        return;
    }
    if (met->together > 0) follow(met, user, -way);
    if (met->together == 0 && is_taken(met, user, way)) {
        user->goes &= ~met->bit;
        user->stop = fmin(user->stop, way);
    } else if (met->gives_way && !(user->goes & met->bit)) {
        if (!accepts(self, met, i, way)) {
            user->stop = fmin(user->stop, way);
        } else if (way <= comfortable + user->driver.standstill_gap + 1) {
            user->goes |= met->bit;
        }
    }
}

static void meet(flow *self, int32_t number) {
    int32_t path = self->in->conflicts[number].path;
    double entry = self->in->conflicts[number].entry, exit = self->in->conflicts[number].exit;
    double other_entry = self->in->conflicts[number].other_entry, other_exit = self->in->conflicts[number].other_exit;
    int32_t other_path = self->in->conflicts[number].other_path;
    if (!(exit > entry && other_exit > other_entry) || path < 0 || path >= TRAFFIC_PATHS || other_path < 0 ||
        other_path >= TRAFFIC_PATHS) {
        return;
    }
    meeting met = {.entry = entry, .way = exit - entry, .other_way = other_exit - other_entry};
    met.together = self->rules.together[number];
    met.path = path;
    met.other_path = other_path;
    met.gives_way = self->in->conflicts[number].gives_way;
    met.bit = (uint32_t)1 << number;
    met.other_bit = 0;
    for (int32_t n = 0; n < TRAFFIC_CONFLICTS; ++n) {
        bool is_the_same = self->in->conflicts[n].path == other_path && self->in->conflicts[n].other_path == path;
        if (is_the_same && self->in->conflicts[n].entry == other_entry) met.other_bit |= (uint32_t)1 << n;
    }
    gather(self, other_entry, &met);
    for (int32_t k = 0; k < self->count && self->order[k].path <= path; ++k) {
        int32_t who = self->order[k].who;
        if (self->order[k].path == path && !self->users[who].walks) approach(self, &met, who);
    }
}

void right_of_way(flow *self) {
    for (int32_t i = 0; i < self->count; ++i) {
        flow_user *user = &self->users[i];
        user->stopped = user->stop;
        user->stop = user->limit = HUGE_VAL;
        if (flow_drives(user)) see_light(self, user);
    }
    for (int32_t n = 0; n < TRAFFIC_CONFLICTS; ++n) meet(self, n);
}
