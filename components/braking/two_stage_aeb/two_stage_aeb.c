#include "two_stage_aeb.h"

#include <math.h>

#define STANDSTILL 0.1 /* m/s */

/* The gap at which a stage begins, and its derivative by the closing speed. */
typedef struct {
    double gap, slope;
} beginning;

/* Of an object that brakes to standstill: the way that it loses in *time*. *stops* is when it stands. */
static beginning lost_by(double braking, double stops, double time) {
    double brakes = fmin(time, stops);
    return (beginning){braking * brakes * (time - 0.5 * brakes), -fmax(time - stops, 0)};
}

/* The approach ends while the object brakes, or where it stands. */
static beginning stopping(double closing, double speed, double braking, double stops, double lost, double required) {
    double later = closing + braking * lost, rate = required - braking, time = lost + later / rate;
    if (rate > 0 && time <= stops) {
        return (beginning){closing * lost + 0.5 * braking * lost * lost + later * later / (2 * rate), time};
    }
    double own = closing + speed;
    return (beginning){own * lost + own * own / (2 * required) - 0.5 * speed * stops, stops};
}

static beginning beginning_of(const two_stage_aeb_par *par, const emergency_meeting *meeting, double ttc, double required,
                              double deviations) {
    double closing = meeting->closing, speed = meeting->speed;
    double sure = meeting->braking - deviations * meeting->braking_deviation;
    bool brakes = par->object_brakes && speed > 0 && sure > 0;
    double braking = brakes ? sure : 0, stops = brakes ? speed / sure : HUGE_VAL;
    beginning lost = lost_by(braking, stops, ttc), by_time = {ttc * closing + lost.gap, ttc + lost.slope};
    beginning by_required = stopping(closing, speed, braking, stops, par->lost_time, required);
    by_required.gap += par->standing_gap;
    return by_time.gap > by_required.gap ? by_time : by_required;
}

/* The gap is short enough, by *deviations* standard deviations. */
static bool is_due(const emergency_meeting *meeting, beginning at, double deviations) {
    double variance = meeting->gap_variance - 2 * at.slope * meeting->gap_closing + at.slope * at.slope * meeting->closing_variance;
    return meeting->gap + deviations * sqrt(fmax(variance, 0)) <= at.gap;
}

/* The stage required for an object in the path; the start of the warning is stretched by *stretch*. */
static int32_t stage_for(const two_stage_aeb_par *par, const emergency_meeting *meeting, double stretch, double deviations) {
    beginning partial = beginning_of(par, meeting, par->partial_ttc, par->partial_required, deviations);
    beginning full = beginning_of(par, meeting, par->full_ttc, par->full_required, deviations);
    if (is_due(meeting, full, deviations)) return STAGE_FULL;
    if (is_due(meeting, partial, deviations)) return STAGE_PARTIAL;
    beginning warning = partial.gap > full.gap ? partial : full;
    warning.gap = (warning.gap + par->warning_lead * meeting->closing) * stretch;
    warning.slope = (warning.slope + par->warning_lead) * stretch;
    return is_due(meeting, warning, deviations) ? STAGE_WARNING : STAGE_NONE;
}

/* The stage that begins for an object, by so many standard deviations of its place beside the path and of the gap. */
static int32_t beginning_stage(const two_stage_aeb_par *par, const emergency_meeting *meeting, double margin, double deviations) {
    bool is_in_path = meeting->clearance + deviations * meeting->clearance_deviation < margin;
    return is_in_path ? stage_for(par, meeting, 1, deviations) : STAGE_NONE;
}

typedef struct {
    int32_t begins, stays; /* the highest stage that begins now; the highest that may continue if it has begun */
} demand;

static demand demand_of(const two_stage_aeb *self) {
    const two_stage_aeb_par *par = &self->par;
    emergency_car car = {par->front_length, par->width, par->length, par->unknown_width};
    demand all = {STAGE_NONE, STAGE_NONE};
    for (int i = 0; i < EMERGENCY_TRACKS; ++i) {
        emergency_meeting meeting = emergency_meet(&self->in, i, &car);
        if (!meeting.is_ahead || self->in.tracks[i].age < par->min_age) continue;
        int32_t class = self->in.tracks[i].class;
        bool is_vulnerable = class == CLASS_PEDESTRIAN || class == CLASS_BICYCLE;
        double margin = is_vulnerable ? par->vulnerable_margin : par->vehicle_margin;
        int32_t highest = class == CLASS_NONE ? par->unknown_class : STAGE_FULL;
        bool is_sure = self->in.tracks[i].existence >= par->least_existence;
        if (is_sure) {
            int32_t warns = beginning_stage(par, &meeting, margin, par->warning_deviations);
            int32_t stage = beginning_stage(par, &meeting, margin, par->deviations);
            if (stage == STAGE_NONE && warns > STAGE_NONE) stage = STAGE_WARNING;
            if (stage > highest) stage = highest;
            if (stage > all.begins) all.begins = stage;
        }
        if (meeting.clearance < margin + par->margin_hysteresis) {
            int32_t stage = self->out.stage > STAGE_WARNING ? self->out.stage
                                                           : stage_for(par, &meeting, 1 + par->warning_hysteresis, 0);
            if (stage > highest) stage = highest;
            if (stage > all.stays) all.stays = stage;
        }
    }
    return all;
}

static int32_t samples(double time) {
    return (int32_t)floor(time / EMERGENCY_STEP + 0.5);
}

void two_stage_aeb_init(two_stage_aeb *self) {
    self->calm = 0;
    self->out.stage = STAGE_NONE;
    self->out.deceleration = 0;
    self->out.brake_torque = 0;
}

void two_stage_aeb_step(two_stage_aeb *self) {
    const two_stage_aeb_par *par = &self->par;
    double speed = self->in.motion.speed;
    bool is_braking = self->out.stage > STAGE_WARNING;
    double patience = is_braking && speed < STANDSTILL ? par->holding_time : par->release_time;
    demand now = demand_of(self);
    if (!is_braking && (speed < par->min_speed || speed > par->max_speed)) now.begins = now.stays = STAGE_NONE;

    if (now.begins >= self->out.stage) {
        self->out.stage = now.begins;
        self->calm = 0;
    } else if (now.stays >= self->out.stage) {
        self->calm = 0;
    } else if (++self->calm >= samples(patience)) {
        self->out.stage = now.begins > now.stays ? now.begins : now.stays;
        self->calm = 0;
    }
    double wanted = self->out.stage == STAGE_FULL      ? par->full_deceleration
                    : self->out.stage == STAGE_PARTIAL ? par->partial_deceleration
                                                       : 0;
    self->out.deceleration =
        emergency_build_up(wanted, self->out.deceleration, par->build_up_jerk, par->release_jerk);
    self->out.brake_torque = par->nominal_mass * self->out.deceleration * par->wheel_radius;
}
