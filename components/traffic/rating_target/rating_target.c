#include "rating_target.h"

#include <math.h>

#define SAME 0 /* of approach */
#define OPPOSITE 1
#define NEARSIDE 2
#define SIDE 1          /* of contact */
#define BRAKES 1.0      /* m/s2 */
#define SLOWER (2 / 3.6) /* m/s */

typedef struct {
    int32_t class;
    double length, width, height;
    double reference; /* m ahead of the centre */
} target_kind;

static const target_kind KINDS[] = {
    {TRAFFIC_CAR, 4.023, 1.712, 1.427, 0.25 * 4.023},
    {TRAFFIC_MOTORCYCLE, 2.08, 0.79, 1.06, 0},
    {TRAFFIC_BICYCLE, 1.89, 0.5, 1.2, 0.015},
    {TRAFFIC_PEDESTRIAN, 0.6, 0.5, 1.8, -0.06},
    {TRAFFIC_PEDESTRIAN, 0.711, 0.298, 1.154, -0.0405},
};

/* Its way from the place of the contact: < 0 before it. */
static speed_profile_motion motion_of(const rating_target *self) {
    double speed = self->par.speed, run_up = self->par.acceleration_distance;
    if (self->par.headway > 0) {
        speed_profile braking = {speed, self->par.brake_time, self->par.deceleration, fmin(self->par.final_speed, speed)};
        return speed_profile_at(&braking, self->clock);
    }
    double steady = speed * (self->clock - self->meeting), begin = -self->par.steady_distance;
    if (!(run_up > 0 && speed > 0) || steady >= begin) return (speed_profile_motion){steady, speed, 0};
    double rate = speed * speed / (2 * run_up), since = (steady - begin) / speed + speed / rate;
    if (since <= 0) return (speed_profile_motion){begin - run_up, 0, 0};
    return (speed_profile_motion){begin - run_up + 0.5 * rate * since * since, rate * since, rate};
}

static lane_shift_pose pose_of(const rating_target *self, double speed) {
    double time = self->par.lane_change_time;
    if (!(time > 0)) return (lane_shift_pose){0, 0, 0, speed};
    double left = self->meeting - self->par.lane_change_end - self->clock;
    lane_shift change = {self->turn == 0 ? self->par.lane_width : -self->par.lane_width, 0, time, fmin(fmax(1 - left / time, 0), 1)};
    return lane_shift_at(&change, speed);
}

static void output(rating_target *self) {
    const target_kind *kind = &KINDS[self->par.kind];
    speed_profile_motion motion = motion_of(self);
    lane_shift_pose pose = pose_of(self, motion.speed);
    double pace = self->is_free || self->par.headway > 0 ? 1 : self->in.motion.speed / self->host_speed;
    double c = cos(self->turn), s = sin(self->turn);
    self->out.movers[0] = (traffic_mover){
        .id = 1,
        .class = kind->class,
        .length = kind->length,
        .width = kind->width,
        .height = kind->height,
        .station = self->station + self->x + c * motion.travelled - s * pose.offset,
        .offset = self->y + s * motion.travelled + c * pose.offset,
        .turn = self->turn + pose.turn,
        .speed = pose.speed * pace,
        .acceleration = motion.acceleration,
    };
}

/* Where the target's centre is at the contact. */
static void aim(rating_target *self) {
    const target_kind *kind = &KINDS[self->par.kind];
    double place = (self->par.impact_location - 0.5) * self->par.host_width;
    double way = self->par.approach == NEARSIDE ? 1 : -1; /* of a crossing target, to the left */
    if (self->par.approach == SAME || self->par.approach == OPPOSITE) {
        self->turn = self->par.approach == SAME ? 0 : 2 * TRAFFIC_QUARTER_TURN;
        self->x = 0.5 * kind->length;
        self->y = place;
    } else {
        self->turn = way * TRAFFIC_QUARTER_TURN;
        self->x = self->par.contact == SIDE ? -self->par.impact_depth * self->par.host_length : 0.5 * kind->width;
        self->y = self->par.contact == SIDE ? -way * 0.5 * (self->par.host_width + kind->length) : place - way * kind->reference;
    }
}

/* The place of the host's front at *across* m left of its middle when the rear axle has driven *along* the path. */
static turn_pose front_at(const rating_target *self, const turn_path *path, double along, double across) {
    turn_pose pose = turn_path_at(path, along);
    double c = cos(pose.heading), s = sin(pose.heading), ahead = self->par.host_rear_axle + self->par.host_front;
    pose.x += c * ahead - s * across;
    pose.y += s * ahead + c * across;
    return pose;
}

/* The time from the start to the end of a *way*. */
static double time_of(const rating_target *self, double way) {
    double rate = self->par.pull_away, speed = self->par.pull_away_speed;
    if (!(rate > 0)) return way / self->host_speed;
    double begin = 0.5 * speed * speed / rate;
    return self->par.pull_away_after + (way < begin ? sqrt(2 * way / rate) : speed / rate + (way - begin) / speed);
}

/* The start from standstill, straight on. */
static void aim_at_start(rating_target *self) {
    double sense = self->par.reverses ? -1 : 1, distance = self->par.pull_away_distance;
    double bumper = self->par.reverses ? self->par.host_length - self->par.host_front : self->par.host_front;
    aim(self);
    self->meeting = time_of(self, distance);
    self->station = self->in.lane.station + sense * (bumper + distance);
    self->x *= sense;
}

static void aim_beside(rating_target *self) {
    const target_kind *kind = &KINDS[self->par.kind];
    self->station = self->in.lane.station - self->par.door_edge;
    self->turn = 0;
    self->x = -0.5 * kind->length;
    self->y = 0.5 * (self->par.host_width + kind->width) + self->par.passing_gap;
}

/* The same for a host that drifts to the left: where the corner of its front is over the side of a target on the lane to
 * the left. That target then meets its front, or is beside it, half a length behind. */
static void aim_at_drift(rating_target *self) {
    const target_kind *kind = &KINDS[self->par.kind];
    bool is_behind = self->par.approach == SAME;
    double axis = self->par.lane_width;
    double touched = axis - 0.5 * kind->width + self->par.overlap * self->par.host_width - self->in.lane.offset;
    turn_path path = turn_path_drifting(self->par.drift, self->host_speed, self->host_speed * self->par.turn_after);
    double along = path.length + (touched - front_at(self, &path, path.length, 0.5 * self->par.host_width).y) / sin(path.end.heading);
    double front = front_at(self, &path, along, 0.5 * self->par.host_width).x;
    self->meeting = along / self->host_speed;
    self->station = self->in.lane.station - self->par.host_rear_axle;
    self->turn = is_behind ? 0 : 2 * TRAFFIC_QUARTER_TURN;
    self->x = is_behind ? front - 0.5 * (self->par.host_length + kind->length) : front + 0.5 * kind->length;
    self->y = axis;
}

/* The same for a host that turns: where on its path the place of its front is as far aside as that of the target. */
static void aim_at_turn(rating_target *self) {
    const target_kind *kind = &KINDS[self->par.kind];
    double side = self->par.turn == TURN_FARSIDE ? 1 : -1, way = self->par.approach == SAME ? 1 : -1;
    bool is_vehicle = kind->class == TRAFFIC_CAR || kind->class == TRAFFIC_MOTORCYCLE;
    double across = is_vehicle ? 0 : (self->par.impact_location - 0.5) * self->par.host_width;
    double axis = side * self->par.path_offset + 0.5 * self->par.lane_width, touched = side * axis - 0.5 * kind->width;
    turn_path path = turn_path_of(self->par.turn, self->host_speed, self->host_speed * self->par.turn_after);
    double before = 0, after = path.length + fabs(axis);
    for (int32_t i = 0; i < 60; ++i) {
        double middle = 0.5 * (before + after);
        *(side * front_at(self, &path, middle, across).y < touched ? &before : &after) = middle;
    }
    self->meeting = time_of(self, after);
    self->station = self->in.lane.station - self->par.host_rear_axle;
    self->turn = way > 0 ? 0 : 2 * TRAFFIC_QUARTER_TURN;
    self->x = front_at(self, &path, after, across).x - way * (is_vehicle ? 0.5 * kind->length : kind->reference);
    self->y = axis;
}

static void park(rating_target *self) {
    bool is_free = fmax(self->host_speed, self->par.speed) > self->par.unobstructed_speed;
    for (int32_t i = 0; i < RATING_TARGET_PARKED; ++i) {
        if (is_free || i >= self->par.parked) continue;
        self->out.movers[i + 1] = (traffic_mover){
            .id = i + 2,
            .class = TRAFFIC_CAR,
            .length = self->par.parked_length[i],
            .width = self->par.parked_width[i],
            .height = self->par.parked_height[i],
            .station = self->station + self->par.parked_ahead[i],
            .offset = self->par.parked_offset[i],
            .turn = self->par.parked_turn[i],
        };
    }
}

void rating_target_init(rating_target *self) {
    for (int32_t i = 0; i < TRAFFIC_MOVERS; ++i) self->out.movers[i] = (traffic_mover){0};
    self->host_speed = self->in.motion.speed;
    self->clock = 0;
    self->is_free = !(self->host_speed > 0);
    double time = self->par.headway > 0 ? self->par.headway : self->par.approach_time;
    self->station = self->in.lane.station + self->par.host_front + self->host_speed * time;
    self->meeting = self->par.approach_time;
    if (self->par.drift > 0 && self->host_speed > 0) {
        aim_at_drift(self);
    } else if (self->par.turn != TURN_NONE) {
        aim_at_turn(self);
    } else if (self->par.pull_away > 0) {
        aim_at_start(self);
    } else if (self->par.passing_gap > 0) {
        aim_beside(self);
    } else {
        aim(self);
    }
    park(self);
    output(self);
}

void rating_target_step(rating_target *self, double h) {
    double speed = self->in.motion.speed;
    if (self->in.motion.acceleration < -BRAKES || speed < self->host_speed - SLOWER) self->is_free = true;
    if (self->is_free || self->par.headway > 0) {
        self->clock += h;
    } else if (self->par.turn != TURN_NONE || self->par.drift > 0) {
        self->clock += h * speed / self->host_speed;
    } else {
        double ahead = self->station - self->in.lane.station - self->par.host_front - h * speed; /* at the end of the step */
        self->clock = self->meeting - ahead / self->host_speed;
    }
    output(self);
}
