/* Linear-quadratic cruise control with feed-forward (Liang, Peng: Optimal adaptive cruise control with guaranteed string
 * stability, Vehicle System Dynamics 32, 313, 1999; lag and spacing policy as in Rajamani: Vehicle Dynamics and Control,
 * 2012, chapters 5 and 6).
 *
 * The car's acceleration a follows the demand u with a first-order lag; d is what grade, wind and wrong parameters add.
 * With the gap less the wanted one e, the lead's speed less the own w, a time gap h and the lead's acceleration b
 *   e' = w - h a,   w' = b - a,   lag a' = u - a
 * is at rest where e = 0, w = h b, a = u = b. So
 *   u = b - K (e, w - h b, a - b)
 * makes the sum of e^2/gap_error^2 + (w - h b)^2/speed_error^2 + (u - b)^2/effort^2 least, for b that lasts. Towards
 * the set speed likewise with the speed's error alone. K is found when the controller starts (riccati.h), over
 * samples. The lower of both wins, within its limits and within max_jerk of the previous demand: no bump.
 *
 * b is the lead speed's derivative behind a lag of lead_lag, times feed_forward; it restarts where the speed jumps:
 * another vehicle. a is computed from the demands; d is estimated by an observer of the speed with two poles at
 * observer_lag and subtracted from the demand: no gap error remains on a hill. */
#ifndef LQ_ACC_H
#define LQ_ACC_H

#include "../acc/acc.h"

typedef struct {
    double gap_error, speed_error, effort; /* deviations that are equally bad (Bryson's rule) */
    double lag, feed_forward, lead_lag, observer_lag, max_jerk;
    int32_t gap_setting;
    double standstill_gap;
    double max_acceleration, max_deceleration;
    double nominal_mass, wheel_radius, drag_area, rolling_resistance;
} lq_acc_par;

typedef struct {
    acc_in in;
    acc_out out;
    lq_acc_par par;
    double following[3], free[2];            /* gains: of (e, w, a); of (speed error, a) */
    double wanted, demanded;                 /* m/s2: u; u - d */
    double speed, acceleration, disturbance; /* estimates: own; by the demands alone; d */
    double lead_speed, slow_speed, lead_acceleration;
    bool has_lead;
    int32_t designed_for; /* the gap setting that the gains are for */
} lq_acc;

void lq_acc_init(lq_acc *self);
void lq_acc_step(lq_acc *self);

#endif
