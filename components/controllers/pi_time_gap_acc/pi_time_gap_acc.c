#include "pi_time_gap_acc.h"

static void control(pi_time_gap_acc *self, double step) {
    const acc_in *in = &self->in;
    const pi_time_gap_acc_par *par = &self->par;
    const acc_car car = {par->nominal_mass, par->wheel_radius, par->drag_area, par->rolling_resistance};

    double wanted_gap = acc_wanted_gap(par->gap_setting, par->standstill_gap, in);
    double wanted_speed = in->set_speed, slope = 0; /* of the wanted speed, fed forward */
    int32_t mode = ACC_MODE_SPEED;
    if (in->target.detected) {
        double lead_speed = in->speed - in->target.closing_speed;
        double following = lead_speed + par->k_gap * (in->target.gap - wanted_gap);
        if (following < wanted_speed) {
            wanted_speed = following;
            slope = -par->k_gap * in->target.closing_speed;
            mode = ACC_MODE_DISTANCE;
        }
    }
    double error = wanted_speed - in->speed;
    double integral = self->integral + par->ki_speed * error * step;
    double wanted = par->kp_speed * error + integral + slope;
    double acceleration = acc_limit(wanted, -par->max_deceleration, par->max_acceleration);
    /* At a limit the integral changes only if that leads back from the limit. */
    if (wanted == acceleration || (wanted > acceleration) != (error > 0)) self->integral = integral;
    acc_demand(&car, acceleration, in, &self->out);
    acc_report(mode, wanted_gap, in, &self->out);
}

void pi_time_gap_acc_init(pi_time_gap_acc *self) {
    self->integral = 0;
    control(self, 0);
}

void pi_time_gap_acc_step(pi_time_gap_acc *self) {
    control(self, ACC_STEP);
}
