#include "stream_traffic.h"

#include <math.h>

#include "attention.h"
#include "guests.h"
#include "population.h"
#include "walkers.h"

static flow flow_of(stream_traffic *self, int32_t deciding) {
    flow all = {.users = self->users, .order = self->order, .count = self->count + TRAFFIC_HOSTS, .steps = self->steps, .in = &self->in};
    flow_rules rules = {
        self->par.change_duration, self->par.politeness, self->par.change_threshold, self->par.keep_right,
        self->par.safe_deceleration, deciding, self->par.reaction_time, self->par.critical_gap, self->par.together,
        self->par.minds_host, self->par.host_lane, self->par.host_front, self->par.host_rear, self->par.host_width,
    };
    flow_path otherwise = {
        self->par.closed ? self->par.path_length : 0, self->par.path_length, self->par.lane_width,
        self->par.right_lane, self->par.left_lane, NULL,
    };
    all.rules = rules;
    flow_set_paths(&all, &otherwise);
    return all;
}

static void output(stream_traffic *self, const flow *all) {
    for (int32_t i = 0; i < self->count; ++i) {
        if (self->users[i].class == 0) {
            self->out.everyone[i] = (traffic_mover){0};
        } else {
            self->out.everyone[i] = self->users[i].walks ? walkers_mover(self, all, i) : flow_mover(all, i);
        }
    }
}

void stream_traffic_init(stream_traffic *self) {
    flow all = flow_of(self, 1);
    self->steps = 0;
    self->base_time = self->step = 0;
    for (int32_t i = 0; i < STREAM_USERS; ++i) self->out.everyone[i] = (traffic_mover){0};
    self->fits = population_begin(self, &all);
    if (!self->fits) all.count = self->count = 0;
    output(self, &all);
    attention_begin(self, &all);
    if (!self->fits) self->out.movers[0].station = NAN;
}

void stream_traffic_step(stream_traffic *self, double h) {
    if (!self->fits) return;
    if (h != self->step) {
        self->base_time += (double)self->steps * self->step;
        self->step = h;
        self->steps = 0;
    }
    self->steps += 1;
    flow all = flow_of(self, (int32_t)fmin(fmax(rint(self->par.decision_period / h), 1), 1e6));
    guests_step(self, &all);
    population_exchange(self, &all);
    walkers_step(self, &all, h);
    flow_step(&all, h);
    output(self, &all);
    attention_step(self, &all);
}
