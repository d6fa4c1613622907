#include "pd_acc.h"

void pd_acc_init(pd_acc *self) {
    /* The derivative starts at zero, for any first error. */
    self->previous_error = self->in.set_speed - self->in.speed;
    pd_acc_step(self);
}

void pd_acc_step(pd_acc *self) {
    const acc_in *in = &self->in;
    const pd_acc_par *par = &self->par;
    const acc_car car = {par->nominal_mass, par->wheel_radius, par->drag_area, par->rolling_resistance};

    double error = in->set_speed - in->speed;
    double slope = (error - self->previous_error) / ACC_STEP;
    self->previous_error = error;

    double low = -par->max_deceleration, high = par->max_acceleration;
    double acceleration = acc_limit(par->kp_speed * error + par->kd_speed * slope, low, high);
    double wanted_gap = acc_wanted_gap(par->gap_setting, par->standstill_gap, in);
    int32_t mode = ACC_MODE_SPEED;
    if (in->target.detected) {
        double following = par->kp_gap * (in->target.gap - wanted_gap) - par->kd_gap * in->target.closing_speed;
        following = acc_limit(following, low, high);
        /* Limited demands are compared: two that both demand full acceleration do not select following mode. */
        if (following < acceleration) {
            acceleration = following;
            mode = ACC_MODE_DISTANCE;
        }
    }
    acc_demand(&car, acceleration, in, &self->out);
    acc_report(mode, wanted_gap, in, &self->out);
}
