#include "reference_driver_cc.h"

#include <math.h>

#define HIDDEN 3.0 /* m: between the rear ends of an object and a hidden one; an object may have two tracks */

static const driver_memory NOTHING = {0, 0, 0, false, false, false, 0};

/* Objects may change their places among the tracks; a new object has no history. */
static void recall(reference_driver_cc *self, const emergency_place *places) {
    const reference_driver_cc_par *par = &self->par;
    double part = EMERGENCY_STEP / fmax(par->acceleration_lag, EMERGENCY_STEP);
    driver_memory now[EMERGENCY_TRACKS];
    for (int i = 0; i < EMERGENCY_TRACKS; ++i) {
        now[i] = NOTHING;
        if (!places[i].is_ahead) continue;
        now[i].speed = places[i].speed;
        for (int j = 0; j < EMERGENCY_TRACKS; ++j) {
            if (self->memory[j].id == self->in.tracks[i].id) now[i] = self->memory[j];
        }
        now[i].id = self->in.tracks[i].id;
        now[i].acceleration += part * ((places[i].speed - now[i].speed) / EMERGENCY_STEP - now[i].acceleration);
        now[i].speed = places[i].speed;
        if (fabs(places[i].aside) >= 0.5 * par->lane_width) now[i].was_beside = true;
        if (fabs(places[i].aside) < par->wandering) now[i].was_beside = false; /* it has arrived */
    }
    for (int i = 0; i < EMERGENCY_TRACKS; ++i) self->memory[i] = now[i];
}

/* In line with the car, and not about to leave. */
static bool is_leading(const emergency_place *place, double wandering) {
    bool is_leaving = fabs(place->aside) > wandering && place->aside * place->across > 0;
    return place->is_ahead && fabs(place->aside) < place->touching && !is_leaving;
}

static bool is_hidden(const reference_driver_cc *self, const emergency_place *places, int index) {
    for (int j = 0; j < EMERGENCY_TRACKS; ++j) {
        if (is_leading(&places[j], self->par.wandering) && places[j].gap + HIDDEN < places[index].gap) return true;
    }
    return false;
}

typedef struct {
    bool is_risk, is_evaluated, is_critical;
} judgement;

static judgement judge(reference_driver_cc *self, const emergency_place *places, int index) {
    const reference_driver_cc_par *par = &self->par;
    const emergency_place *place = &places[index];
    driver_memory *memory = &self->memory[index];
    int32_t class = self->in.tracks[index].class;
    double side = fabs(place->aside);
    bool is_near = place->gap < par->critical_ttc * place->closing, is_slower = place->closing > par->least_closing;
    bool is_next = place->gap < par->critical_headway * self->in.motion.speed, is_in_time = true;
    judgement found = {false, true, is_near};
    if (class == CLASS_PEDESTRIAN || class == CLASS_BICYCLE) {
        emergency_car car = {.front = par->front_length, .width = par->width};
        found.is_risk = emergency_meet(&self->in, index, &car).clearance < 0 && is_slower;
    } else if (memory->was_beside) {
        bool comes = place->aside * place->across < 0 || side < place->touching;
        found.is_risk = is_slower && comes && side < par->lane_width - par->wandering;
        is_in_time = par->cut_in_evaluation == EVALUATION_TIME;
        if (!is_in_time) found.is_evaluated = side < par->lane_width - par->wandering - par->evaluation_distance;
    } else if (is_hidden(self, places, index)) {
        memory->was_hidden = true;
    } else {
        bool brakes = memory->acceleration < -par->lead_deceleration;
        if (brakes) {
            memory->has_braked = true;
        } else if (!is_slower) {
            memory->has_braked = memory->was_hidden = false;
        }
        found.is_risk = is_leading(place, par->wandering) && (is_slower || brakes);
        found.is_critical = is_near || ((memory->was_hidden || memory->has_braked) && is_next);
    }
    memory->risk = found.is_risk ? memory->risk + 1 : 0;
    if (is_in_time) found.is_evaluated = memory->risk > driver_samples(par->evaluation_time);
    return found;
}

void reference_driver_cc_init(reference_driver_cc *self) {
    self->foot.alarmed = self->foot.calm = 0;
    for (int i = 0; i < EMERGENCY_TRACKS; ++i) self->memory[i] = NOTHING;
    self->out.stage = STAGE_NONE;
    self->out.deceleration = 0;
    self->out.brake_torque = 0;
}

void reference_driver_cc_step(reference_driver_cc *self) {
    const reference_driver_cc_par *par = &self->par;
    const driver_habits habits = {
        par->reaction_time, par->release_deceleration, par->jerk, par->release_time, par->holding_time,
        par->nominal_mass, par->wheel_radius,
    };
    emergency_place places[EMERGENCY_TRACKS];
    for (int i = 0; i < EMERGENCY_TRACKS; ++i) {
        places[i] = emergency_place_of(&self->in, i, par->front_length, par->width);
    }
    recall(self, places);
    bool has_cause = false, is_braking = driver_brakes(&self->foot, &habits);
    for (int i = 0; i < EMERGENCY_TRACKS; ++i) {
        if (!places[i].is_ahead) continue;
        judgement found = judge(self, places, i);
        bool is_in_way = fabs(places[i].aside) < places[i].touching && places[i].closing > 0;
        if (found.is_evaluated && found.is_risk && (found.is_critical || is_braking)) has_cause = true;
        if (is_braking && is_in_way && self->memory[i].id && !is_hidden(self, places, i)) has_cause = true;
    }
    driver_act(&self->foot, &habits, has_cause, par->max_deceleration, STAGE_FULL, &self->in, &self->out);
}
