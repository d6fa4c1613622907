#include "idm_traffic.h"

#include <math.h>

#define IDM_PLUS 1 /* of model */

static flow flow_of(idm_traffic *self) {
    flow all = {.users = self->users, .order = self->order, .count = TRAFFIC_MOVERS, .in = &self->in};
    flow_rules rules = {
        self->par.change_duration, self->par.politeness, self->par.change_threshold, self->par.keep_right,
        self->par.safe_deceleration, 1, self->par.reaction_time, self->par.critical_gap, self->par.together,
        self->par.minds_host, self->par.host_lane, self->par.host_front, self->par.host_rear, self->par.host_width,
    };
    flow_path otherwise = {
        self->par.lap_length, self->par.lap_length, self->par.lane_width, self->par.right_lane, self->par.left_lane,
        NULL,
    };
    all.rules = rules;
    flow_set_paths(&all, &otherwise);
    return all;
}

/* Parameters may have changed. */
static void set_driver(idm_traffic *self, int32_t i) {
    self->users[i].height = self->par.height[i];
    self->users[i].dry = (following_driver){
        self->par.desired_speed[i], self->par.time_gap[i], self->par.standstill_gap[i], self->par.max_acceleration[i],
        self->par.comfortable_deceleration[i], self->par.max_deceleration, self->par.model == IDM_PLUS,
    };
}

static void output(idm_traffic *self, const flow *all) {
    for (int32_t i = 0; i < TRAFFIC_MOVERS; ++i) {
        self->out.movers[i] = self->users[i].class == 0 ? (traffic_mover){0} : flow_mover(all, i);
    }
}

void idm_traffic_init(idm_traffic *self) {
    flow all = flow_of(self);
    for (int32_t i = 0; i < TRAFFIC_MOVERS; ++i) {
        int32_t lane = self->par.lane_number[i];
        double offset = flow_middle(&all.paths[self->par.path[i]], lane);
        self->users[i] = (flow_user){
            .id = i + 1,
            .class = self->par.class[i],
            .path = self->par.path[i],
            .lane = lane,
            .old_lane = lane,
            .length = self->par.length[i],
            .width = self->par.width[i],
            .station = self->par.station[i],
            .speed = self->par.speed[i],
            .shift = {offset, offset, self->par.change_duration, 1},
        };
        set_driver(self, i);
    }
    flow_begin(&all);
    output(self, &all);
}

void idm_traffic_step(idm_traffic *self, double h) {
    flow all = flow_of(self);
    for (int32_t i = 0; i < TRAFFIC_MOVERS; ++i) set_driver(self, i);
    flow_step(&all, h);
    output(self, &all);
}
