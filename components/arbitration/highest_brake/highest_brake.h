/* The highest brake demand of all assistants applies. The driver's drive torque applies while no assistant brakes.
 * After braking it returns with a limited rate, so that the car does not jerk forward. */
#ifndef HIGHEST_BRAKE_H
#define HIGHEST_BRAKE_H

#include <stdbool.h>

#define HIGHEST_BRAKE_STEP 0.01 /* s; the step in the component.yaml */

typedef struct {
    struct {
        struct {
            double drive_torque, brake_torque;
        } demand;
        double emergency_torque, yielding_torque;
    } in;
    struct {
        double drive_torque, brake_torque;
    } out;
    struct {
        double drive_cut, drive_rate; /* N.m, N.m/s */
    } par;
    bool cut; /* the drive torque is cut, or is returning */
} highest_brake;

void highest_brake_init(highest_brake *self);
void highest_brake_step(highest_brake *self);

#endif
