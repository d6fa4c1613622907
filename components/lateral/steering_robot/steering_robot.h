/* The steering robot of a test track: it drives the rear axle along a path that the test prescribes, straight on,
 * through a turn, or across the lane; it does not see the road. Turn or drift begin turn_after seconds after the start.
 *
 * Rear wheel feedback (Samson: Control of chained systems, IEEE Trans. Automatic Control 40:64, 1995, as in Paden, Cap,
 * Yong, Yershov, Frazzoli: A survey of motion planning and control techniques for self-driving urban vehicles, IEEE
 * Trans. Intelligent Vehicles 1:33, 2016, eq. 17): with the curvature k of the path, the car's distance e to its left and
 * its heading a relative to it,
 *   curvature = k cos(a) / (1 - k e) - 2 a / l - e sin(a) / (a l^2),
 * so that small errors fall to 1/e of their size over l, of at least decay_distance and decay_time. */
#ifndef STEERING_ROBOT_H
#define STEERING_ROBOT_H

#include "../lateral/lateral.h"
#include "turn_path.h"

typedef struct {
    int32_t turn, drift_to;
    double turn_after, drift;
    double decay_distance, decay_time;
    double wheelbase, rear_axle, max_steering, max_steering_rate;
} steering_robot_par;

typedef struct {
    lateral_in in;
    lateral_out out;
    steering_robot_par par;
    turn_path path;
    double x, y, heading; /* of the rear axle at the start */
    double along;         /* m, of the path that is done */
} steering_robot;

void steering_robot_init(steering_robot *self);
void steering_robot_step(steering_robot *self);

#endif
