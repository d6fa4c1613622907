/* A driver who steers by optimal preview control (MacAdam: Application of an optimal preview control for simulation of
 * closed-loop automobile driving, IEEE Trans. SMC 11, 393, 1981), with a reaction time and a lag of the arms.
 *
 * The driver predicts by a car model (car_model.h) the place at times h up to preview_time: y0(h) with the front wheels
 * straight, A(h) more for each rad of steering. The wanted steering, if held, minimizes the sum of the squares of
 * path - y0 - A d:  d = sum (path(h) - y0(h)) A(h) / sum A(h)^2. It acts reaction_time later, through a first-order lag
 * of muscle_time.
 */
#ifndef PREVIEW_DRIVER_H
#define PREVIEW_DRIVER_H

#include <stdint.h>

#include "../lateral/lateral.h"

#define DRIVER_SPEEDS 24
#define DRIVER_SPEED_STEP 2.5 /* m/s: the first speed, and between speeds */
#define DRIVER_GLANCES 10     /* evenly over the preview time */
#define DRIVER_MEMORY 64      /* samples of a reaction time, and one */

typedef struct {
    double preview_time, reaction_time, muscle_time;
    double mass, yaw_inertia, wheelbase, front_load_share, front_stiffness, rear_stiffness;
    double max_steering, max_steering_rate;
} preview_driver_par;

typedef struct {
    lateral_in in;
    lateral_out out;
    preview_driver_par par;
    struct {
        double by_rate, by_yaw_rate, by_steering; /* m per m/s, rad/s and rad */
    } moved[DRIVER_SPEEDS][DRIVER_GLANCES];
    double wanted[DRIVER_MEMORY]; /* a ring; the newest at *latest* */
    int32_t latest;
} preview_driver;

void preview_driver_init(preview_driver *self);
void preview_driver_step(preview_driver *self);

#endif
