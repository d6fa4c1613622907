#include "guests.h"

#include <math.h>

#define WIDE 2.5     /* m */
#define JOINING 60.0 /* m on either side of a car that joins */

static void set_lanes(flow_user *user, const flow *all, double offset) {
    const flow_path *path = &all->paths[0];
    double place = flow_middle(path, all->rules.host_lane) + offset;
    user->low = 1;
    user->high = 0;
    for (int32_t lane = path->right; lane <= path->left; ++lane) {
        double reach = 0.5 * fmax(flow_width(path, lane), user->width + WIDE);
        if (!(fabs(place - flow_middle(path, lane)) < reach)) continue;
        if (user->low > user->high) user->low = lane;
        user->high = user->lane = user->old_lane = lane;
    }
}

static void clear_around(stream_traffic *self, const flow *all, double station) {
    for (int32_t i = 0; i < self->count; ++i) {
        flow_user *user = &self->users[i];
        if (!flow_drives(user) || user->path != 0) continue;
        if (!(fabs(traffic_ahead(all->paths[0].lap, user->station, station)) < JOINING)) continue;
        user->class = 0;
        self->waiting[i] = user->path + 1;
    }
}

void guests_step(stream_traffic *self, const flow *all) {
    for (int32_t n = 0; n < TRAFFIC_HOSTS; ++n) {
        flow_user *user = &self->users[self->count + n];
        double length = self->in.hosts[n].length, station = self->in.hosts[n].station;
        bool joins = user->class == 0;
        *user = (flow_user){0};
        if (!(length > 0)) continue;
        user->class = TRAFFIC_CAR;
        user->walks = user->is_host = true;
        user->length = length;
        user->width = self->in.hosts[n].width;
        user->station = station;
        user->speed = self->in.hosts[n].speed;
        user->stop = user->stopped = user->limit = HUGE_VAL;
        set_lanes(user, all, self->in.hosts[n].offset);
        if (joins) clear_around(self, all, station);
    }
}
