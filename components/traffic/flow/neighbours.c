#include "flow.h"

#include <math.h>

#define BESIDE 1e-9       /* m: tolerance between the order and distances, for rounding */

/* Width of the host's lane where the host is, per width where its path begins: as far as known, all lanes widen alike. */
static double widened(const flow *self) {
    double start = flow_width(&self->paths[0], self->rules.host_lane), now = self->in->lane.width;
    return start > 0 && now > 0 ? now / start : 1;
}

/* Whether user *i* would share that lane with the host. */
static bool shares_with_host(const flow *self, int32_t i, int32_t lane) {
    const flow_rules *rules = &self->rules;
    const flow_user *user = &self->users[i];
    if (!rules->minds_host || user->path != 0) return false;
    const flow_path *path = &self->paths[0];
    double wide = widened(self), apart = wide * (flow_middle(path, rules->host_lane) - flow_middle(path, lane));
    double width = wide * flow_width(path, lane), aside = self->in->lane.offset + apart;
    return fabs(aside) < 0.5 * fmax(width, rules->host_width + user->width);
}

/* Of its centre. */
static double station_of(const flow *self, int32_t who) {
    return who == FLOW_HOST ? self->in->lane.station + 0.5 * (self->rules.host_front - self->rules.host_rear)
                            : self->users[who].station;
}

/* From the centre of the user behind to that of the user ahead, in travel direction; less than a lap if closed. */
static double way_between(const flow *self, int32_t path, int32_t behind, int32_t ahead) {
    double way = station_of(self, ahead) - station_of(self, behind), lap = self->paths[path].lap;
    return lap > 0 ? way - lap * floor(way / lap) : way;
}

flow_neighbour flow_next(const flow *self, int32_t i, int32_t lane, bool is_ahead) {
    const flow_user *user = &self->users[i];
    flow_neighbour next = {FLOW_NOBODY, HUGE_VAL};
    double nearest = HUGE_VAL, lap = self->paths[user->path].lap;
    int32_t who = (is_ahead ? user->ahead : user->behind)[lane - user->lane + 1];
    if (who != FLOW_NOBODY) {
        int32_t behind = is_ahead ? i : who, ahead = is_ahead ? who : i;
        double way = way_between(self, user->path, behind, ahead);
        if (lap > 0 && way > lap - BESIDE) way -= lap;
        if (!(way == 0 && ahead > behind)) {
            nearest = way;
            next.who = who;
        }
    }
    if (shares_with_host(self, i, lane)) {
        double way = is_ahead ? way_between(self, 0, i, FLOW_HOST) : way_between(self, 0, FLOW_HOST, i);
        if (!(way < 0 || (way == 0 && is_ahead) || way >= nearest)) {
            nearest = way;
            next.who = FLOW_HOST;
        }
    }
    if (next.who != FLOW_NOBODY) next.gap = nearest - 0.5 * (flow_length_of(self, i) + flow_length_of(self, next.who));
    return next;
}
