#include "idm_traffic.h"

#include <math.h>

#include "following.h"

#define IDM_PLUS 1                  /* of model */
#define LEFT_ITS_LANE 0.6           /* of a change's time */
#define HOST TRAFFIC_MOVERS         /* its number among the others */
#define NOBODY (-1)

/* Who is next on a lane: how far from bumper to bumper; infinite: nobody. */
typedef struct {
    int32_t who;
    double gap;
} neighbour;

static bool is_changing(const idm_traffic_vehicle *vehicle) {
    return vehicle->lane != vehicle->old_lane && vehicle->shift.progress < 1;
}

static bool is_there(const idm_traffic *self, int32_t who) {
    return who == HOST ? self->par.minds_host : self->par.class[who] != 0;
}

/* Whether vehicle *i* would have to mind *who* on that lane. */
static bool shares(const idm_traffic *self, int32_t i, int32_t who, int32_t lane) {
    if (who == HOST) {
        double aside = self->in.lane.offset + (self->par.host_lane - lane) * self->par.lane_width;
        return fabs(aside) < 0.5 * fmax(self->par.lane_width, self->par.host_width + self->par.width[i]);
    }
    const idm_traffic_vehicle *other = &self->vehicles[who];
    return other->lane == lane ||
           (is_changing(other) && other->shift.progress < LEFT_ITS_LANE && other->old_lane == lane);
}

/* Of its centre. */
static double station_of(const idm_traffic *self, int32_t who) {
    return who == HOST ? self->in.lane.station + 0.5 * (self->par.host_front - self->par.host_rear)
                       : self->vehicles[who].station;
}

static double speed_of(const idm_traffic *self, int32_t who) {
    return who == HOST ? self->in.motion.speed : self->vehicles[who].speed;
}

static double length_of(const idm_traffic *self, int32_t who) {
    return who == HOST ? self->par.host_front + self->par.host_rear : self->par.length[who];
}

/* From the centre of who is behind to that of who is ahead, in the direction of travel; on a closed path less than a lap. */
static double way_between(const idm_traffic *self, int32_t behind, int32_t ahead) {
    double way = station_of(self, ahead) - station_of(self, behind), lap = self->par.lap_length;
    return lap > 0 ? way - lap * floor(way / lap) : way;
}

/* The next one on *lane* ahead of vehicle *i*, or behind it; of two at one station the one with the smaller number
   is ahead. */
static neighbour next_on(const idm_traffic *self, int32_t i, int32_t lane, bool is_ahead) {
    neighbour next = {NOBODY, HUGE_VAL};
    double nearest = HUGE_VAL;
    for (int32_t who = 0; who <= HOST; ++who) {
        if (who == i || !is_there(self, who) || !shares(self, i, who, lane)) continue;
        int32_t behind = is_ahead ? i : who, ahead = is_ahead ? who : i;
        double way = way_between(self, behind, ahead);
        if (way < 0 || (way == 0 && ahead > behind) || way >= nearest) continue;
        nearest = way;
        next.who = who;
        next.gap = way - 0.5 * (length_of(self, i) + length_of(self, who));
    }
    return next;
}

/* The acceleration of *who* behind *ahead* at that gap; of the host as *judge* would drive. */
static double acceleration_of(const idm_traffic *self, int32_t who, int32_t judge, double gap, int32_t ahead) {
    int32_t d = who == HOST ? judge : who;
    following_driver driver = {
        self->par.desired_speed[d], self->par.time_gap[d], self->par.standstill_gap[d], self->par.max_acceleration[d],
        self->par.comfortable_deceleration[d], self->par.max_deceleration, self->par.model == IDM_PLUS,
    };
    return following_acceleration(&driver, speed_of(self, who), gap, ahead == NOBODY ? 0 : speed_of(self, ahead));
}

static double own_acceleration(const idm_traffic *self, int32_t i, int32_t lane) {
    neighbour ahead = next_on(self, i, lane, true);
    return acceleration_of(self, i, i, ahead.gap, ahead.who);
}

/* What who is behind *i* on *lane* gains if *i* comes (or, sign -1, goes), and its acceleration with *i* ahead. */
static double gain_behind(const idm_traffic *self, int32_t i, int32_t lane, double sign, double *with) {
    neighbour behind = next_on(self, i, lane, false), ahead = next_on(self, i, lane, true);
    *with = 0;
    if (behind.who == NOBODY) return 0;
    bool alone = ahead.who == NOBODY || ahead.who == behind.who; /* then, on a closed path, it is ahead of itself */
    double whole = behind.gap + length_of(self, i) + ahead.gap;
    double without = acceleration_of(self, behind.who, i, alone ? HUGE_VAL : whole, alone ? NOBODY : ahead.who);
    *with = acceleration_of(self, behind.who, i, behind.gap, i);
    return sign * (*with - without);
}

/* MOBIL's advantage over its threshold of a change to *lane*; negative where it may not be. */
static double incentive(const idm_traffic *self, int32_t i, int32_t lane) {
    const idm_traffic_vehicle *vehicle = &self->vehicles[i];
    neighbour ahead = next_on(self, i, lane, true), behind = next_on(self, i, lane, false);
    if (ahead.gap <= 0 || behind.gap <= 0) return -HUGE_VAL;
    double follows, followed, there = own_acceleration(self, i, lane), here = own_acceleration(self, i, vehicle->lane);
    double gains = gain_behind(self, i, lane, 1, &follows) + gain_behind(self, i, vehicle->lane, -1, &followed);
    if (follows < -self->par.safe_deceleration || there < -self->par.safe_deceleration) return -HUGE_VAL;
    double bias = lane > vehicle->lane ? self->par.keep_right : -self->par.keep_right;
    return there - here + self->par.politeness * gains - self->par.change_threshold - bias;
}

/* One after the other, so that two do not take one gap. */
static void change_lanes(idm_traffic *self) {
    for (int32_t i = 0; i < TRAFFIC_MOVERS; ++i) {
        idm_traffic_vehicle *vehicle = &self->vehicles[i];
        if (!is_there(self, i) || is_changing(vehicle) || vehicle->speed == 0) continue;
        int32_t left = vehicle->lane + 1, right = vehicle->lane - 1;
        double leftwards = left <= self->par.left_lane ? incentive(self, i, left) : -HUGE_VAL;
        double rightwards = right >= self->par.right_lane ? incentive(self, i, right) : -HUGE_VAL;
        if (!(leftwards > 0 || rightwards > 0)) continue;
        int32_t lane = leftwards >= rightwards ? left : right;
        lane_shift shift = {vehicle->lane * self->par.lane_width, lane * self->par.lane_width,
                            self->par.change_duration, 0};
        vehicle->old_lane = vehicle->lane;
        vehicle->lane = lane;
        vehicle->shift = shift;
    }
}

/* Of who changes lanes the smaller one of both. */
static double wanted_acceleration(const idm_traffic *self, int32_t i) {
    const idm_traffic_vehicle *vehicle = &self->vehicles[i];
    double wanted = own_acceleration(self, i, vehicle->lane);
    if (!is_changing(vehicle) || vehicle->shift.progress >= LEFT_ITS_LANE) return wanted;
    return fmin(wanted, own_acceleration(self, i, vehicle->old_lane));
}

static void move(idm_traffic_vehicle *vehicle, double acceleration, double h) {
    double before = vehicle->speed, after = before + acceleration * h;
    double travelled = after < 0 ? -0.5 * before * before / acceleration : 0.5 * (before + after) * h;
    vehicle->speed = fmax(after, 0);
    vehicle->station += travelled;
    lane_shift_advance(&vehicle->shift, travelled, h);
}

static void output(idm_traffic *self, int32_t i, double acceleration) {
    const idm_traffic_vehicle *vehicle = &self->vehicles[i];
    lane_shift_pose pose = lane_shift_at(&vehicle->shift, vehicle->speed);
    self->out.movers[i] = (traffic_mover){
        .id = i + 1,
        .class = self->par.class[i],
        .length = self->par.length[i],
        .width = self->par.width[i],
        .height = self->par.height[i],
        .station = vehicle->station,
        .offset = pose.offset,
        .turn = pose.turn,
        .speed = pose.speed,
        .acceleration = acceleration,
    };
}

void idm_traffic_init(idm_traffic *self) {
    for (int32_t i = 0; i < TRAFFIC_MOVERS; ++i) {
        int32_t lane = self->par.lane_number[i];
        double offset = lane * self->par.lane_width;
        self->vehicles[i] = (idm_traffic_vehicle){
            self->par.station[i], self->par.speed[i], lane, lane, {offset, offset, self->par.change_duration, 1},
        };
        self->out.movers[i] = (traffic_mover){0};
        if (is_there(self, i)) output(self, i, 0);
    }
}

void idm_traffic_step(idm_traffic *self, double h) {
    double accelerations[TRAFFIC_MOVERS];
    change_lanes(self);
    for (int32_t i = 0; i < TRAFFIC_MOVERS; ++i) {
        accelerations[i] = is_there(self, i) ? wanted_acceleration(self, i) : 0;
    }
    for (int32_t i = 0; i < TRAFFIC_MOVERS; ++i) {
        if (!is_there(self, i)) continue;
        double before = self->vehicles[i].speed;
        move(&self->vehicles[i], accelerations[i], h);
        output(self, i, (self->vehicles[i].speed - before) / h);
    }
}
