/* Service brake: dead time, first-order build-up, torque limit and a fixed distribution to the axles. */
#ifndef FRICTION_BRAKE_H
#define FRICTION_BRAKE_H

#include <stdint.h>

#define FRICTION_BRAKE_STEP 0.01 /* s; the step in every component.yaml that uses this */
#define FRICTION_BRAKE_DELAY 64  /* stored steps of demand, more than the longest dead time */

typedef struct {
    double front, rear;
} friction_brake_axles;

typedef struct {
    struct {
        double torque_demand;
        friction_brake_axles wheel_speed;
    } in;
    struct {
        friction_brake_axles torque;
        double power;
    } out;
    struct {
        double dead_time, lag, max_torque, front_share;
    } par;
    double torque;
    double demands[FRICTION_BRAKE_DELAY];
    int32_t newest;
} friction_brake;

void friction_brake_init(friction_brake *self);
void friction_brake_step(friction_brake *self);

#endif
