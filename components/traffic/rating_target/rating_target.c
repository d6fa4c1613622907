#include "rating_target.h"

#include <math.h>

#define SAME 0 /* of approach */
#define ONCOMING 1
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
    double steady = speed * (self->clock - self->par.approach_time), begin = -self->par.steady_distance;
    if (!(run_up > 0 && speed > 0) || steady >= begin) return (speed_profile_motion){steady, speed, 0};
    double rate = speed * speed / (2 * run_up), since = (steady - begin) / speed + speed / rate;
    if (since <= 0) return (speed_profile_motion){begin - run_up, 0, 0};
    return (speed_profile_motion){begin - run_up + 0.5 * rate * since * since, rate * since, rate};
}

static lane_shift_pose pose_of(const rating_target *self, double speed) {
    double time = self->par.lane_change_time;
    if (!(time > 0)) return (lane_shift_pose){0, 0, speed};
    double left = self->par.approach_time - self->par.lane_change_end - self->clock;
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
    if (self->par.approach == SAME || self->par.approach == ONCOMING) {
        self->turn = self->par.approach == SAME ? 0 : 2 * TRAFFIC_QUARTER_TURN;
        self->x = 0.5 * kind->length;
        self->y = place;
    } else {
        self->turn = way * TRAFFIC_QUARTER_TURN;
        self->x = self->par.contact == SIDE ? -self->par.impact_depth * self->par.host_length : 0.5 * kind->width;
        self->y = self->par.contact == SIDE ? -way * 0.5 * (self->par.host_width + kind->length) : place - way * kind->reference;
    }
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
    aim(self);
    park(self);
    output(self);
}

void rating_target_step(rating_target *self, double h) {
    double speed = self->in.motion.speed;
    if (self->in.motion.acceleration < -BRAKES || speed < self->host_speed - SLOWER) self->is_free = true;
    if (self->is_free || self->par.headway > 0) {
        self->clock += h;
    } else {
        double ahead = self->station - self->in.lane.station - self->par.host_front;
        self->clock = self->par.approach_time - ahead / self->host_speed;
    }
    output(self);
}
