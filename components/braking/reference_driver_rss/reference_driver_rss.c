#include "reference_driver_rss.h"

#include <math.h>

static bool is_dangerous(const reference_driver_rss_par *par, const emergency_place *place, double speed) {
    double time = par->reaction_time, faster = speed + par->max_acceleration * time;
    double ahead = speed * time + 0.5 * par->max_acceleration * time * time +
                   0.5 * faster * faster / par->least_deceleration -
                   0.5 * place->speed * place->speed / par->lead_deceleration;
    double across = fabs(place->across), later = across + par->lateral_acceleration * time;
    double beside = par->margin + 0.5 * (across + later) * time + 0.5 * later * later / par->lateral_acceleration;
    return place->gap < ahead && fabs(place->aside) - place->touching < beside;
}

void reference_driver_rss_init(reference_driver_rss *self) {
    self->foot.alarmed = self->foot.calm = 0;
    self->out.stage = STAGE_NONE;
    self->out.deceleration = 0;
    self->out.brake_torque = 0;
}

void reference_driver_rss_step(reference_driver_rss *self) {
    const reference_driver_rss_par *par = &self->par;
    const driver_habits habits = {
        par->reaction_time, par->release_deceleration, par->jerk, par->release_time, par->holding_time,
        par->nominal_mass, par->wheel_radius,
    };
    bool has_cause = false;
    for (int i = 0; i < EMERGENCY_TRACKS; ++i) {
        emergency_place place = emergency_place_of(&self->in, i, par->front_length, par->width);
        if (place.is_ahead && is_dangerous(par, &place, self->in.motion.speed)) has_cause = true;
    }
    driver_act(&self->foot, &habits, has_cause, par->max_deceleration, STAGE_FULL, &self->in, &self->out);
}
