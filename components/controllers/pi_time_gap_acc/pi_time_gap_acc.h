/* Cascaded cruise control: a P law turns the gap into a speed to drive, a PI law with feed-forward drives that speed
 * (upper and lower controller as in Rajamani: Vehicle Dynamics and Control, 2012, chapters 5 and 6; the integral stops at
 * a limit, Astrom, Hagglund: Advanced PID Control, 2006, 3.5). */
#ifndef PI_TIME_GAP_ACC_H
#define PI_TIME_GAP_ACC_H

#include "../acc/acc.h"

typedef struct {
    double kp_speed, ki_speed; /* 1/s, 1/s2 */
    double k_gap;              /* 1/s: speed above the lead's per gap error */
    int32_t gap_setting;
    double standstill_gap;
    double max_acceleration, max_deceleration;
    double nominal_mass, wheel_radius, drag_area, rolling_resistance;
} pi_time_gap_acc_par;

typedef struct {
    acc_in in;
    acc_out out;
    pi_time_gap_acc_par par;
    double integral; /* m/s2 */
} pi_time_gap_acc;

void pi_time_gap_acc_init(pi_time_gap_acc *self);
void pi_time_gap_acc_step(pi_time_gap_acc *self);

#endif
