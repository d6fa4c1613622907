/* Turns the front wheels along the path and, by an arc tangent of the front axle's offset, back to it (Hoffmann, Tomlin,
 * Montemerlo, Thrun: Autonomous automobile trajectory tracking for off-road driving, American Control Conference 2007,
 * 2296): the law of Stanley in the DARPA Grand Challenge 2005. With e, t the offset and heading error of the front axle
 * against the path's nearest point, k the curvature there, p the bank and r the yaw rate,
 *   d = -t + (v^2 k + g p)/(g c) - atan(gain e/(softening + v)) - yaw_damping (r - v k)
 * The second term is the paper's heading in a steady curve, m v r/(Cy (1 + a/b)): the slip angle of the front tyres,
 * here with their stiffness Cy = c m g b/L and the bank added. So a car of that stiffness keeps its front axle on the
 * curve, and small offsets decay with e^(-gain t) at any speed far above *softening*. The paper's last term, for the
 * lag of the steering servo, is omitted: the servo is not part of the controller, which measures no steering angle. */
#ifndef STANLEY_H
#define STANLEY_H

#include "../lateral/lateral.h"

typedef struct {
    double gain, softening, yaw_damping; /* 1/s, m/s, s */
    double wheelbase, front_load_share, front_stiffness;
    double max_steering, max_steering_rate;
} stanley_par;

typedef struct {
    lateral_in in;
    lateral_out out;
    stanley_par par;
} stanley;

void stanley_init(stanley *self);
void stanley_step(stanley *self);

#endif
