#include "reference_driver_fsm.h"

#include <math.h>

/* 0 beyond *safe*, 1 below *unsafe*. */
static double between(double gap, double safe, double unsafe) {
    if (gap > safe) return 0;
    return gap < unsafe ? 1 : (gap - safe) / (unsafe - safe);
}

static double proactive(const reference_driver_fsm_par *par, const emergency_place *place, double speed) {
    double lead = place->speed * place->speed / (2 * par->lead_deceleration);
    double reaction = speed * par->reaction_time, energy = 0.5 * speed * speed;
    return between(place->gap - par->margin, reaction + energy / par->comfortable_deceleration - lead + par->safe_margin,
                   reaction + energy / par->hard_deceleration - lead);
}

static double critical(const reference_driver_fsm_par *par, const emergency_place *place, double acceleration) {
    double felt = fmax(acceleration, -par->comfortable_deceleration), time = par->reaction_time;
    double later = place->closing + time * felt;
    if (place->closing <= 0) return 0;
    if (later < 0) return 2 * fabs(acceleration) * place->gap < place->closing * place->closing ? 1 : 0;
    double meanwhile = (place->closing + 0.5 * felt * time) * time, energy = 0.5 * later * later;
    return between(place->gap, meanwhile + energy / par->comfortable_deceleration,
                   meanwhile + energy / par->hard_deceleration);
}

static bool is_in_way(const reference_driver_fsm_par *par, const emergency_place *place) {
    double apart = fabs(place->aside) - place->touching;
    if (apart <= 0) return true;
    double comes = place->aside > 0 ? -place->across : place->across;
    if (comes <= 0 || place->closing <= 0) return false;
    return apart / comes <= (place->gap + par->passing_length) / place->closing + par->passing_time;
}

void reference_driver_fsm_init(reference_driver_fsm *self) {
    self->foot.alarmed = self->foot.calm = 0;
    self->out.stage = STAGE_NONE;
    self->out.deceleration = 0;
    self->out.brake_torque = 0;
}

void reference_driver_fsm_step(reference_driver_fsm *self) {
    const reference_driver_fsm_par *par = &self->par;
    const driver_habits habits = {
        par->reaction_time, par->release_deceleration, par->jerk, par->release_time, par->holding_time,
        par->nominal_mass, par->wheel_radius,
    };
    double worst = 0, careful = 0;
    for (int i = 0; i < EMERGENCY_TRACKS; ++i) {
        emergency_place place = emergency_place_of(&self->in, i, par->front_length, par->width);
        if (!place.is_ahead || !is_in_way(par, &place)) continue;
        worst = fmax(worst, critical(par, &place, self->in.motion.acceleration));
        careful = fmax(careful, proactive(par, &place, self->in.motion.speed));
    }
    double low = par->comfortable_deceleration, high = par->hard_deceleration;
    double wanted = worst > 0 ? low + worst * (high - low) : careful * low;
    driver_act(&self->foot, &habits, wanted > 0, fmin(wanted, par->max_deceleration),
               worst > 0 ? STAGE_FULL : STAGE_PARTIAL, &self->in, &self->out);
}
