/* A car on four wheels: speeds along and across, yaw, heave, roll and pitch on springs, spin and tyre of every wheel.
 *
 * In the plane of the road below the car, as single_track, with all four wheels:
 *   m (u' - v r) = sum X_i + D + m g_ahead,  m (v' + u r) = sum Y_i + S + m g_left
 *   J_z r'       = sum (a_i Y_i - b_i X_i) + l S
 * Upright, heights against sea level, slopes of the body for its angles (sines), R and P those against the road's:
 *   m z''        = up sum N_i + rise (sum X_i + D) + bank (sum Y_i + S) - m g
 *   J_x roll''   =  sum b_i N_i + h sum Y_i + h R sum N_i
 *   J_y pitch''  = -sum a_i N_i - h sum X_i + h P sum N_i
 *   N_i          = share of the weight + springs, dampers and anti-roll bar of its axle against the ground below it, at least 0
 * Wheels have no weight of their own: springs are those of suspension and tyre in series. The roll axis is on the
 * ground; roll and pitch are small, so overturning is not modelled. Between two outputs of the road, the ground
 * continues with its slopes. The front wheels turn about one point (Ackermann). A differential gives both sides half of
 * an axle's torque, and its lock moves up to *preload + lock |torque|* to the slower wheel. wheel.h has wheels and
 * tyres, ars.h the integration.
 */
#ifndef TWO_TRACK_H
#define TWO_TRACK_H

#include <stdint.h>

#include "../shared/ars.h"
#include "../shared/ports.h"

typedef struct {
    chassis_inputs in;
    chassis_outputs out;
    struct {
        double initial_speed;
        double mass, roll_inertia, pitch_inertia, yaw_inertia, front_load_share, cg_height, wheelbase, track_front, track_rear;
        double wheel_radius, inertia_front, inertia_rear;
        double spring_front, spring_rear, damper_front, damper_rear, anti_roll_front, anti_roll_rear;
        double lock_front, lock_rear, preload_front, preload_rear;
        double drag_area, side_area, side_lever, rolling_resistance;
        struct {
            double grip, nominal_load, slip_relaxation, side_relaxation;
            double pcx1, pdx1, pdx2, pex1, pkx1, pkx2, pkx3, rbx1, rbx2, rcx1, rex1;
            double pcy1, pdy1, pdy2, pey1, pky1, pky2, rby1, rby2, rcy1, rey1;
        } tyre;
        double steering_limit;
        int32_t substeps;
    } par;
    ars_state state;
    double load[4], acceleration, lateral_acceleration; /* at the end of the last step */
} two_track;

void two_track_init(two_track *self);
void two_track_step(two_track *self, double h);

#endif
