/* Parallel hybrid: the engine carries the slow part of the demand, the machine fills what is missing. */
#ifndef TORQUE_SPLIT_H
#define TORQUE_SPLIT_H

typedef struct {
    double torque, power;
} torque_split_unit;

typedef struct {
    struct {
        double torque_demand;
        torque_split_unit engine, machine;
    } in;
    struct {
        double engine_demand, machine_demand;
        struct {
            double front, rear;
        } wheels;
        double power;
    } out;
    struct {
        double engine_share, front_share;
    } par;
} torque_split;

void torque_split_init(torque_split *self);
void torque_split_step(torque_split *self, double h);

#endif
