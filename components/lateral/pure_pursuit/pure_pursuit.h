/* Steers along the circle through the rear axle that meets the path at the look-ahead distance (Coulter: Implementation
 * of the pure pursuit path tracking algorithm, CMU-RI-TR-92-01, 1992; on the rear axle as in Snider, CMU-RI-TR-09-08,
 * 2009, section 2.2). The look-ahead grows with the speed. A car that understeers runs outside of a curve by
 * ((v^2 k) K l / 2 L + m a v^2 k / (L Cr)) l, with l the look-ahead, as the law does not model the tyres. */
#ifndef PURE_PURSUIT_H
#define PURE_PURSUIT_H

#include "../lateral/lateral.h"

typedef struct {
    double lookahead_time, min_lookahead, max_lookahead;
    double wheelbase, front_load_share;
    double max_steering, max_steering_rate;
} pure_pursuit_par;

typedef struct {
    lateral_in in;
    lateral_out out;
    pure_pursuit_par par;
} pure_pursuit;

void pure_pursuit_init(pure_pursuit *self);
void pure_pursuit_step(pure_pursuit *self);

#endif
