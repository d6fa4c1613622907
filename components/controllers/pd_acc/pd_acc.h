/* Bimodal cruise control of the paper (ADAS Virtual Prototyping using Modelica and Unity Co-simulation via OpenMETA,
 * 1st Japanese Modelica Conference, 2016): a PD law for the speed, a PD law for the gap, the lower demand wins. */
#ifndef PD_ACC_H
#define PD_ACC_H

#include "../acc/acc.h"

typedef struct {
    double kp_speed, kd_speed; /* 1/s, 1: acceleration per speed error and per its derivative */
    double kp_gap, kd_gap;     /* 1/s2, 1/s: acceleration per gap error and per its derivative */
    int32_t gap_setting;
    double standstill_gap;
    double max_acceleration, max_deceleration;
    double nominal_mass, wheel_radius, drag_area, rolling_resistance;
} pd_acc_par;

typedef struct {
    acc_in in;
    acc_out out;
    pd_acc_par par;
    double previous_error;
} pd_acc;

void pd_acc_init(pd_acc *self);
void pd_acc_step(pd_acc *self);

#endif
