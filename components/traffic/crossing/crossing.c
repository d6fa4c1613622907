#include "crossing.h"

#include <math.h>

#define BY_TIME 1 /* of timing */
#define BICYCLE 1 /* of road_user */

/* Time from its start to *distance* on its path; NaN, which fails the run, if that is not on its path. */
static double duration_to(const crossing *self, double distance) {
    double rate = self->par.acceleration, ramp = 0.5 * self->peak * self->peak / rate, rest = self->way - distance;
    if (!(self->way > 0 && distance >= 0 && rest >= 0)) return NAN;
    double whole = 2 * self->peak / rate + (self->way - 2 * ramp) / self->peak;
    if (distance < ramp) return sqrt(2 * distance / rate);
    return rest < ramp ? whole - sqrt(2 * rest / rate) : self->peak / rate + (distance - ramp) / self->peak;
}

static speed_profile_motion motion_after(const crossing *self, double time) {
    double rate = self->par.acceleration, ramp = self->peak / rate;
    double whole = 2 * ramp + (self->way - self->peak * ramp) / self->peak, rest = whole - time;
    speed_profile_motion motion = {0, 0, 0};
    if (!(time > 0)) return motion;
    if (rest <= 0) {
        motion.travelled = self->way;
    } else if (rest < ramp) {
        speed_profile_motion slower = {self->way - 0.5 * rate * rest * rest, rate * rest, -rate};
        motion = slower;
    } else if (time < ramp) {
        speed_profile_motion faster = {0.5 * rate * time * time, rate * time, rate};
        motion = faster;
    } else {
        motion.travelled = self->peak * (time - 0.5 * ramp);
        motion.speed = self->peak;
    }
    return motion;
}

/* Its predicted start time; never for a host that is at rest or has passed. */
static double due(const crossing *self, double now) {
    if (self->par.timing == BY_TIME) return self->par.conflict_time - self->lead;
    double ahead = traffic_ahead(self->par.lap_length, self->in.lane.station + self->par.host_front, self->par.station);
    double speed = self->in.motion.speed;
    return speed > 0 && ahead >= 0 ? now + ahead / speed - self->lead : HUGE_VAL;
}

static void output(crossing *self, double earliest) {
    double now = counted_time_now(&self->time);
    if (!self->has_set_out) {
        double moment = due(self, now);
        self->has_set_out = !(moment > now);
        self->since = fmax(moment, earliest);
    }
    speed_profile_motion motion = motion_after(self, self->has_set_out ? now - self->since : 0);
    self->out.movers[0] = (traffic_mover){
        .id = 1,
        .class = self->par.road_user == BICYCLE ? TRAFFIC_BICYCLE : TRAFFIC_PEDESTRIAN,
        .length = self->par.length,
        .width = self->par.width,
        .height = self->par.height,
        .lane = self->par.lane_number,
        .station = self->par.station,
        .offset = isnan(self->lead) ? NAN : self->par.start_offset + self->sense * motion.travelled,
        .turn = self->sense * TRAFFIC_QUARTER_TURN,
        .speed = motion.speed,
        .acceleration = motion.acceleration,
    };
}

void crossing_init(crossing *self) {
    counted_time start = {0, 0, 0};
    double across = self->par.end_offset - self->par.start_offset;
    self->time = start;
    self->sense = across < 0 ? -1 : 1;
    self->way = fabs(across);
    self->peak = fmin(self->par.speed, sqrt(self->par.acceleration * self->way));
    self->lead = duration_to(self, self->sense * (self->par.conflict_offset - self->par.start_offset));
    self->has_set_out = false;
    output(self, -HUGE_VAL);
}

void crossing_step(crossing *self, double h) {
    double before = counted_time_now(&self->time);
    counted_time_advance(&self->time, h);
    output(self, before);
}
