#include "idm_acc.h"

#include <math.h>

void idm_acc_init(idm_acc *self) {
    idm_acc_step(self);
}

void idm_acc_step(idm_acc *self) {
    const acc_in *in = &self->in;
    const idm_acc_par *par = &self->par;
    const acc_car car = {par->nominal_mass, par->wheel_radius, par->drag_area, par->rolling_resistance};

    double wanted_gap = acc_wanted_gap(par->gap_setting, par->standstill_gap, in);
    double ratio = in->set_speed > 0 ? in->speed / in->set_speed : in->speed > 0 ? HUGE_VAL : 1;
    double free_road = ratio * ratio * ratio * ratio;
    double interaction = 0;
    if (in->target.detected) {
        double comfort = 2 * sqrt(par->max_acceleration * par->comfortable_deceleration);
        double dynamic = comfort > 0 ? in->speed * in->target.closing_speed / comfort : 0;
        double desired = fmax(wanted_gap + dynamic, 0);
        double share = in->target.gap > 0 ? desired / in->target.gap : HUGE_VAL;
        interaction = share * share;
    }
    double acceleration = par->max_acceleration * (1 - free_road - interaction);
    /* The model has no modes; the term that reduces the acceleration more is reported. */
    int32_t mode = interaction > free_road ? ACC_MODE_DISTANCE : ACC_MODE_SPEED;
    acceleration = acc_limit(acceleration, -par->max_deceleration, par->max_acceleration);
    acc_demand(&car, acceleration, in, &self->out);
    acc_report(mode, wanted_gap, in, &self->out);
}
