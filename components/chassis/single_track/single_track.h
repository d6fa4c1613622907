/* A car on two wheels, one for each axle: speeds along and across, yaw, wheel spins, tyres, quasi-static load transfer.
 *
 *   m (u' - v r) = X + D + m g_ahead       X, Y: tyre forces along and across the car
 *   m (v' + u r) = Y + S + m g_left        D, S: of the air, by its speed against the car
 *   J r'         = a Y_front - b Y_rear + l S
 *   N_front = W b/L - X h/L, N_rear = W a/L + X h/L, W = m (g_up + u^2 bend)
 * with the weight along the axes of the plane of the road below the car, and the curvature of the road below it (slopes
 * of the rear axle relative to the front axle): a crest unloads, a banked curve loads. wheel.h has wheels and tyres,
 * ars.h the integration. Both wheels of an axle have one friction, their mean: two_track models the yaw moment of split
 * friction.
 */
#ifndef SINGLE_TRACK_H
#define SINGLE_TRACK_H

#include <stdint.h>

#include "../shared/ars.h"
#include "../shared/ports.h"

typedef struct {
    chassis_inputs in;
    chassis_outputs out;
    struct {
        double initial_speed;
        double mass, yaw_inertia, front_load_share, cg_height, wheelbase, track;
        double wheel_radius, inertia_front, inertia_rear;
        double drag_area, side_area, side_lever, rolling_resistance;
        int32_t tyre; /* linear, limited */
        double friction, slip_stiffness, cornering_stiffness_front, cornering_stiffness_rear;
        double slip_relaxation, side_relaxation, steering_limit;
        int32_t substeps;
    } par;
    ars_state state;
    double load[2], acceleration, lateral_acceleration; /* at the end of the last step */
} single_track;

void single_track_init(single_track *self);
void single_track_step(single_track *self, double h);

#endif
