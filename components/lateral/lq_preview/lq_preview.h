/* Linear-quadratic lane keeping with preview of the curvature (Sharp, Valtetsiotis: Optimal preview car steering
 * control, Vehicle System Dynamics 35 suppl., 101, 2001; preview of a curvature as in Peng, Tomizuka: J. Dyn. Syst. 115,
 * 679, 1993; the model of Snider, CMU-RI-TR-09-08, 2009).
 *
 * State z and steering d of the car are relative to those in balance on the present path, z* k and d* k, which include
 * understeer: z~ = z - z* k, d~ = d - d* k. One sample later, z~ = A z~ + B d~ + z* (k - k'): only changes of the
 * curvature disturb. The sum of e^2/offset_error^2 + t~^2/heading_error^2 + d~^2/steering_effort^2 is least with
 *   d = d* k - K z~ + sum over j of g_j (k_{j+1} - k_j),  g_j = (r + B'PB)^-1 B' (Ac')^j P z*,  Ac = A - B K
 * with k_j the curvature at the car's place in j samples, as far as preview_time. P, K and g are computed when the
 * controller starts, at each of LQ_SPEEDS speeds, and interpolated.
 */
#ifndef LQ_PREVIEW_H
#define LQ_PREVIEW_H

#include "../lateral/lateral.h"

#define LQ_SPEEDS 24
#define LQ_SPEED_STEP 2.5 /* m/s: the first speed, and between speeds */
#define LQ_SAMPLES 100    /* of preview, at most */

typedef struct {
    double offset_error, heading_error, steering_effort; /* deviations that are equally bad (Bryson's rule) */
    double preview_time;
    double mass, yaw_inertia, wheelbase, front_load_share, front_stiffness, rear_stiffness;
    double max_steering, max_steering_rate;
} lq_preview_par;

typedef struct {
    lateral_in in;
    lateral_out out;
    lq_preview_par par;
    double gain[LQ_SPEEDS][4];
    double ahead[LQ_SPEEDS][LQ_SAMPLES]; /* m: g */
} lq_preview;

void lq_preview_init(lq_preview *self);
void lq_preview_step(lq_preview *self);

#endif
