/* A car whose tyres never lose their lateral grip: host.h along a path that the steering defines.
 *
 * No wheel slips sideways, so the middle of the rear axle moves along the car with a curvature of tan(steering) /
 * wheelbase (the kinematic single track). Steering is held over a step, so the path is an arc, and exact. Steering
 * controllers of other chassis fit; without steering it runs straight. Curves, banks and side wind have no effect.
 */
#ifndef LONGITUDINAL_H
#define LONGITUDINAL_H

#include <stdint.h>

#include "../../worlds/straight_road/host.h"
#include "../shared/ports.h"

typedef struct {
    chassis_inputs in;
    chassis_outputs out;
    struct {
        double initial_speed;
        double mass, front_load_share, cg_height, wheelbase, track;
        double wheel_radius, inertia_front, inertia_rear;
        double drag_area, rolling_resistance, friction, slip_stiffness, steering_limit;
        int32_t substeps;
    } par;
    host_state host;
    double x, y, heading, position; /* of the centre of gravity */
} longitudinal;

void longitudinal_init(longitudinal *self);
void longitudinal_step(longitudinal *self, double h);

#endif
