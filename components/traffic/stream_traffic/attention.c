#include "attention.h"

#include <math.h>

#define KEPT 0.7       /* factor of the rank of a reported user */
#define BEHIND 2.0     /* factor of the distance of users behind, relative to those ahead */
#define UNRELATED 1e9  /* m: users unrelated to the host are last, in the order of numbers */
#define BESIDE 0       /* the lane of walkers that are not on the road */

/* A smaller rank matters more: the distance times the number of users as near or nearer on its lane. */
static void rank_along(const stream_traffic *self, const flow *all, double *ranks) {
    int32_t begin = 0, end, next, nearer[2][2 * FLOW_LANES + 2] = {{0}};
    double lap = all->paths[0].lap, here = self->in.lane.station;
    if (lap > 0) here -= lap * floor(here / lap);
    while (begin < all->count && all->order[begin].path < 0) ++begin;
    for (end = begin; end < all->count && all->order[end].path == 0;) ++end;
    for (next = begin; next < end && all->order[next].station < here;) ++next;
    int32_t count = end - begin;
    for (int32_t is_ahead = 0; is_ahead < 2; ++is_ahead) {
        for (int32_t n = 0; n < count; ++n) {
            int32_t k = is_ahead ? next + n : next - 1 - n;
            if (lap == 0 && (k < begin || k >= end)) break;
            k = k < begin ? k + count : k >= end ? k - count : k;
            const flow_user *user = &all->users[all->order[k].who];
            double way = is_ahead ? all->order[k].station - here : here - all->order[k].station;
            if (way < 0) way += lap;
            if (lap > 0 && way > 0.5 * lap) break;
            int32_t lane = user->low > user->high ? BESIDE : user->lane + FLOW_LANES + 1;
            if (lane < 0 || lane >= 2 * FLOW_LANES + 2) continue;
            double rank = way * ++nearer[is_ahead][lane] * (is_ahead ? 1 : BEHIND);
            ranks[all->order[k].who] = fmin(ranks[all->order[k].who], rank);
        }
    }
}

/* Users that approach a conflict with the host's path: the distances of both to it. */
static void rank_across(const stream_traffic *self, const flow *all, double *ranks) {
    for (int32_t n = 0; n < TRAFFIC_CONFLICTS; ++n) {
        double entry = self->in.conflicts[n].entry, exit = self->in.conflicts[n].exit;
        int32_t path = self->in.conflicts[n].other_path;
        if (self->in.conflicts[n].path != 0 || !(exit > entry) || path <= 0 || path >= TRAFFIC_PATHS) continue;
        double own = traffic_ahead(all->paths[0].lap, self->in.lane.station, entry);
        if (own < entry - exit - self->par.together[n]) continue;
        for (int32_t k = 0; k < all->count && all->order[k].path <= path; ++k) {
            if (all->order[k].path != path) continue;
            int32_t who = all->order[k].who;
            double way = traffic_ahead(all->paths[path].lap, all->users[who].station, self->in.conflicts[n].other_entry);
            bool are_both_in = own < 0 && way < 0;
            ranks[who] = fmin(ranks[who], are_both_in ? fabs(own - way) : fabs(own) + fabs(way));
        }
    }
}

static bool is_told(const stream_traffic *self, int32_t who) {
    for (int32_t place = 0; place < TRAFFIC_MOVERS; ++place) {
        if (self->told[place] == who) return true;
    }
    return false;
}

/* The eight most relevant users, the most relevant one first; FLOW_NOBODY where there are fewer. */
static void choose(const stream_traffic *self, const flow *all, int32_t *chosen) {
    double ranks[STREAM_PLACES], best[TRAFFIC_MOVERS];
    for (int32_t i = 0; i < STREAM_PLACES; ++i) ranks[i] = UNRELATED + i;
    for (int32_t n = 0; n < TRAFFIC_MOVERS; ++n) {
        best[n] = HUGE_VAL;
        chosen[n] = FLOW_NOBODY;
    }
    if (self->par.minds_host) {
        rank_along(self, all, ranks);
        rank_across(self, all, ranks);
    }
    for (int32_t place = 0; place < TRAFFIC_MOVERS; ++place) {
        if (self->told[place] != FLOW_NOBODY) ranks[self->told[place]] *= KEPT;
    }
    for (int32_t i = 0; i < self->count; ++i) {
        int32_t n = TRAFFIC_MOVERS;
        if (self->users[i].class == 0) continue;
        for (; n > 0 && ranks[i] < best[n - 1]; --n) {
            if (n == TRAFFIC_MOVERS) continue;
            best[n] = best[n - 1];
            chosen[n] = chosen[n - 1];
        }
        if (n == TRAFFIC_MOVERS) continue;
        best[n] = ranks[i];
        chosen[n] = i;
    }
}

static bool is_among(const int32_t *chosen, int32_t who) {
    for (int32_t n = 0; n < TRAFFIC_MOVERS; ++n) {
        if (chosen[n] == who) return true;
    }
    return false;
}

void attention_step(stream_traffic *self, const flow *all) {
    int32_t chosen[TRAFFIC_MOVERS], n = 0;
    choose(self, all, chosen);
    for (int32_t place = 0; place < TRAFFIC_MOVERS; ++place) {
        int32_t who = self->told[place];
        if (who != FLOW_NOBODY) {
            bool is_the_same = self->out.movers[place].id == self->users[who].id;
            if (!is_the_same || !is_among(chosen, who)) self->told[place] = FLOW_NOBODY;
        } else {
            while (n < TRAFFIC_MOVERS && (chosen[n] == FLOW_NOBODY || is_told(self, chosen[n]))) ++n;
            if (n < TRAFFIC_MOVERS) self->told[place] = chosen[n++];
        }
        who = self->told[place];
        self->out.movers[place] = who == FLOW_NOBODY ? (traffic_mover){0} : self->out.everyone[who];
    }
}

void attention_begin(stream_traffic *self, const flow *all) {
    for (int32_t place = 0; place < TRAFFIC_MOVERS; ++place) {
        self->told[place] = FLOW_NOBODY;
        self->out.movers[place] = (traffic_mover){0};
    }
    attention_step(self, all);
}
