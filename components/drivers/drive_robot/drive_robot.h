/* The drive robot of a test track: the car starts from standstill, with a constant acceleration up to a speed, forwards or
 * in reverse. It turns and holds the wheels itself, as no powertrain has a reverse gear; the cruise control gets the car's
 * own speed. Feedback of place and speed, of at most max_correction, keeps the car on the prescribed motion against the
 * creep of the powertrain and the cruise control. When an emergency brake demands more than release_torque, the robot
 * stops for good, as a driver who releases the accelerator. */
#ifndef DRIVE_ROBOT_H
#define DRIVE_ROBOT_H

#include <stdbool.h>
#include <stdint.h>

#define DRIVE_ROBOT_STEP 0.01 /* s; the step in the component.yaml */

typedef struct {
    struct {
        struct {
            double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
        } motion;
        double emergency_torque, yielding_torque;
    } in;
    struct {
        double wheel_torque[4], set_speed;
    } out;
    struct {
        double start_after, acceleration, speed;
        bool reverses;
        double place_gain, speed_gain, max_correction, release_torque, nominal_mass, wheel_radius;
    } par;
    int32_t ticks;
    double way, last; /* m driven; m/s in the step before */
    bool has_stopped;
} drive_robot;

void drive_robot_init(drive_robot *self);
void drive_robot_step(drive_robot *self);

#endif
