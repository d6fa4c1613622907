/* One demand for a powertrain that drives and recuperates, and what is left for the friction brake. */
#ifndef DEMAND_BLENDING_H
#define DEMAND_BLENDING_H

typedef struct {
    struct {
        struct {
            double drive_torque, brake_torque;
        } demand;
        struct {
            double front, rear;
        } wheels; /* what the powertrain gives now */
        struct {
            double front, rear;
        } wheel_speed;
    } in;
    struct {
        double powertrain_demand, brake_demand;
    } out;
    struct {
        double share;                 /* of the braking that the powertrain may take over */
        double max_torque, max_power; /* N.m, W: of the powertrain, braking, at the wheels */
        double end_speed, full_speed; /* rad/s of the wheels: none below the first, all from the second */
    } par;
} demand_blending;

void demand_blending_init(demand_blending *self);
void demand_blending_step(demand_blending *self);

#endif
