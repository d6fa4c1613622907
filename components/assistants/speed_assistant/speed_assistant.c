#include "speed_assistant.h"

#include <math.h>

/* Square of the speed here that the curvature at that distance ahead allows. */
static double allowed(const speed_assistant_par *par, double curvature, double distance) {
    double there = curvature != 0 ? par->lateral_acceleration / fabs(curvature) : HUGE_VAL;
    return there + 2 * par->deceleration * fmax(distance, 0);
}

/* The minimum of it on a piece of the path whose curvature is linear. */
static double allowed_on(const speed_assistant_par *par, double k0, double k1, double from, double to) {
    double least = fmin(allowed(par, k0, from), allowed(par, k1, to));
    if (from < 0 && to > 0) { /* up to 0 the largest curvature counts, at any place */
        k0 += (k1 - k0) * -from / (to - from);
        from = 0;
        least = fmin(least, allowed(par, k0, 0));
    }
    double slope = fabs(k1 - k0) / (to - from);
    double worst = sqrt(par->lateral_acceleration * slope / (2 * par->deceleration));
    bool is_rising = fabs(k1) > worst && (fabs(k0) < worst || k0 * k1 < 0);
    if (to > 0 && slope > 0 && is_rising) least = fmin(least, allowed(par, worst, to - (fabs(k1) - worst) / slope));
    return least;
}

static double curve_speed(const speed_assistant *self, double lead) {
    const speed_assistant_in *in = &self->in;
    double least = allowed(&self->par, in->lane.curvature, 0), last = 0, curvature = in->lane.curvature;
    for (int i = 0; i < ASSISTANT_POINTS && in->preview[i].distance > last; ++i) {
        double next = in->preview[i].distance;
        least = fmin(least, allowed_on(&self->par, curvature, in->preview[i].curvature, last - lead, next - lead));
        curvature = in->preview[i].curvature;
        last = next;
    }
    return sqrt(least);
}

/* The action for the light. *room* is the distance available for stopping. */
static int32_t light_at(const speed_assistant *self, double room) {
    light_case is = {
        self->in.light.distance, self->light_distance, room, self->in.motion.speed, self->par.yellow_deceleration,
        self->par.front_length,
    };
    return light_choice(self->light, self->in.light.colour, &is);
}

static void bound(speed_assistant_out *out, double speed, int32_t reason) {
    if (speed >= out->set_speed) return;
    out->set_speed = speed;
    out->reason = reason;
}

static void choose(speed_assistant *self) {
    const speed_assistant_in *in = &self->in;
    double lead = fmax(in->motion.speed, 0) * self->par.lead_time;
    double room = in->light.distance - self->par.front_length - self->par.stop_gap - lead;
    self->light = light_at(self, room);
    self->light_distance = in->light.distance;

    self->out.set_speed = fmax(in->wish, 0);
    self->out.reason = REASON_WISH;
    bound(&self->out, self->limited, REASON_LIMIT);
    bound(&self->out, curve_speed(self, lead), REASON_CURVE);
    if (self->light == LIGHT_STOPS) bound(&self->out, sqrt(2 * self->par.deceleration * fmax(room, 0)), REASON_LIGHT);
}

void speed_assistant_init(speed_assistant *self) {
    self->limited = self->in.lane.speed_limit > 0 ? self->in.lane.speed_limit : HUGE_VAL;
    self->light = LIGHT_FREE;
    self->light_distance = self->in.light.distance;
    choose(self);
}

void speed_assistant_step(speed_assistant *self) {
    double limit = self->in.lane.speed_limit > 0 ? self->in.lane.speed_limit : HUGE_VAL;
    /* Ramp down to a new limit from the set speed or the present speed, whichever is higher. */
    double from = fmin(self->limited, fmax(self->out.set_speed, self->in.motion.speed));
    self->limited = fmax(limit, from - self->par.deceleration * ASSISTANT_STEP);
    choose(self);
}
