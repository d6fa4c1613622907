/* Control of an electric drive with a unit on one axle or on both: distributes demands, observes the limits of the
 * battery, and adds up the units for the car. All values of an absent unit are zero. */
#ifndef DRIVE_CONTROL_H
#define DRIVE_CONTROL_H

#define DRIVE_CONTROL_EFFICIENCY 0.85 /* between battery and wheels, as the control assumes it */

typedef struct {
    double front, rear;
} drive_control_axles;

typedef struct {
    double torque, regeneration, electric_power, inertia, mass;
} drive_control_unit;

typedef struct {
    struct {
        double torque_demand, regeneration_demand;
        drive_control_axles wheel_speed;
        struct {
            double voltage, discharge_limit, charge_limit;
        } supply;
        struct {
            drive_control_unit front, rear;
        } units;
    } in;
    struct {
        drive_control_axles demands, wheels;
        double electric_power, regeneration;
        drive_control_axles load, inertia;
    } out;
    struct {
        double mass;                    /* of shafts and mounts, where the units are */
        double front_share;             /* of the driving torque */
        double front_regeneration;      /* of the braking torque */
        double max_regeneration;        /* N.m at the wheels */
    } par;
} drive_control;

void drive_control_init(drive_control *self);
void drive_control_step(drive_control *self);

#endif
