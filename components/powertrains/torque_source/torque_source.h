/* Ideal torque sources: first-order lag, torque and power limits. One drives the axles, one is part of a hybrid. */
#ifndef TORQUE_SOURCE_H
#define TORQUE_SOURCE_H

typedef struct {
    double front, rear;
} torque_source_axles;

typedef struct {
    double torque_demand;
    torque_source_axles wheel_speed;
} torque_source_in;

typedef struct {
    torque_source_in in;
    struct {
        torque_source_axles wheels;
        double power;
    } out;
    struct {
        double max_torque, max_power, lag, front_share, efficiency, auxiliary_power;
    } par;
    double torque;
} ideal_powertrain;

typedef struct {
    torque_source_in in;
    struct {
        double torque, power;
    } out;
    struct {
        double max_torque, max_recuperation, max_power, lag, efficiency, auxiliary_power;
    } par;
    double torque;
} drive_unit;

void ideal_powertrain_init(ideal_powertrain *self);
void ideal_powertrain_step(ideal_powertrain *self, double h);

void drive_unit_init(drive_unit *self);
void drive_unit_step(drive_unit *self, double h);

#endif
