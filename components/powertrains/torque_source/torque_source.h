/* Ideal torque source: first-order lag, torque and power limits, constant efficiency. */
#ifndef TORQUE_SOURCE_H
#define TORQUE_SOURCE_H

typedef struct {
    double front, rear;
} torque_source_axles;

typedef struct {
    struct {
        double torque_demand;
        torque_source_axles wheel_speed;
    } in;
    struct {
        torque_source_axles wheels;
        double fuel_power, battery_power, co2;
    } out;
    struct {
        double max_torque, max_power, lag, front_share, efficiency, auxiliary_power;
        double fuel_share, co2_per_energy;
    } par;
    double torque;
} ideal_powertrain;

void ideal_powertrain_init(ideal_powertrain *self);
void ideal_powertrain_step(ideal_powertrain *self, double h);

#endif
