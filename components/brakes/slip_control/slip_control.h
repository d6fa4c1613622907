/* Slip control between demands and wheels: anti-lock brakes, drive torque limited by the slip of the driven axles, and single
 * brakes against a wrong yaw rate.
 *
 * The tyre force follows from the torques of a wheel and its spin:  F = (T + I spin') / R
 * Magic Formula tyres of all frictions have their peak where force per load = stiffness * slip, with the same *stiffness*
 * (the initial one over 2.9, as friction scales the height of the curve alone). So the slip aimed at is
 * F / (stiffness load), which finds the peak without knowing the friction: below it the target is above the slip, past it
 * below. Brakes have a lower *stiffness*, past the peak: 97 % of the highest force both for the tyre of two_track, which
 * falls past its peak, and for that of single_track, which approaches its highest force slowly. With
 *   T = R F - I a / R + I v / (R response) (target - slip)
 * the slip follows its target with the time constant *response*. The torque is never above the brake's, its rates
 * are limited, and the rear wheels have the lower torque of both (select low). Below *lowest_speed* the brake acts as it
 * is.
 *
 * The drive torque follows the same law with the torques of an axle and its faster wheel: the demand is at most what the
 * axle with the least to spare can use, in the shares that the powertrain has at present. A drive follows its demand late
 * (0.1 s), and past the peak of the tyre the wheel spins faster before the torque falls: *traction_stiffness* is higher, so
 * that the slip aimed at is about that of the peak.
 *
 * Stability: the yaw rate wanted is that of a linear single-track car at this steering, late by *yaw_lag*, and at most what
 * the present lateral acceleration allows, with a margin:
 *   r = v tan(steering) / (wheelbase (1 + (v / characteristic_speed)^2)),  |r| <= (|a_y| + margin) / v
 * Where the car turns too much, its outer front wheel is braked; too little, its inner rear wheel.
 *
 * Loads are those at rest, shifted by the acceleration. The reference speed is the car's true speed.
 */
#ifndef SLIP_CONTROL_H
#define SLIP_CONTROL_H

#include <stdbool.h>
#include <stdint.h>

#define SLIP_CONTROL_STEP 0.01 /* s; the step in every component.yaml that uses this */

typedef struct {
    double front, rear;
} slip_control_axles;

typedef struct {
    double torque, spin;
    bool active;
} slip_control_wheel;

typedef struct {
    struct {
        slip_control_axles demand;
        double drive_demand;
        slip_control_axles wheels; /* torques of the powertrain */
        double wheel_speeds[4], steering;
        struct {
            double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
        } motion;
    } in;
    struct {
        slip_control_axles brake; /* the part that both wheels of an axle have */
        double wheel_brake[4];    /* and what single wheels have on top */
        double drive_torque;
        bool anti_lock, traction, stability;
    } out;
    struct {
        int32_t functions;
        double mass, front_load_share, cg_height, wheelbase, track, wheel_radius, wheel_inertia;
        double stiffness, traction_stiffness, lowest_slip, highest_slip, entry_slip, response, traction_response, release_rate, apply_rate, lowest_speed;
        double characteristic_speed, yaw_lag, yaw_margin, yaw_tolerance, yaw_gain;
    } par;
    slip_control_wheel wheel[4];
    double torque; /* drives */
    double yaw_rate, yaw_brake[4]; /* wanted, and the torques for it */
    bool started;
} slip_control;

void slip_control_init(slip_control *self);
void slip_control_step(slip_control *self);

#endif
