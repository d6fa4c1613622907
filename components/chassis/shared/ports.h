/* The ports of every chassis (interface `chassis`), with the order of wheels: front left, front right, rear left, rear right. */
#ifndef CHASSIS_PORTS_H
#define CHASSIS_PORTS_H

#include <stdbool.h>

typedef struct {
    double front, rear;
} chassis_axles;

typedef struct {
    double height, slope_x, slope_y, friction;
} chassis_ground;

typedef struct {
    double x, y, heading;
} chassis_pose;

typedef struct {
    double density, wind_x, wind_y;
} chassis_air;

typedef struct {
    double x, y;
} chassis_contact;

typedef struct {
    chassis_axles wheels, brake;
    double wheel_torque[4], wheel_brake[4], steering;
    chassis_ground ground[4];
    chassis_pose start;
    struct {
        bool given;
        double x, y, heading, speed;
    } host_start; /* as a scenario states it */
    chassis_air air;
} chassis_inputs;

typedef struct {
    struct {
        double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
    } motion;
    chassis_contact contacts[4];
    chassis_axles wheel_speed;
    double wheel_speeds[4], load[4];
    double roll, pitch, speed, position, acceleration;
} chassis_outputs;

/* Limits finite but implausible inputs: 100 kN.m at an axle, slopes of 2, wind of 100 m/s, friction of 0.001 to 2. Air
 * without a given density has 1.2 kg/m3. */
chassis_inputs chassis_within_reason(const chassis_inputs *in, double steering_limit);

/* Of a body whose first states are x, y, heading, speed, lateral speed, yaw rate and the travelled distance. */
void chassis_tell_motion(chassis_outputs *out, const double *body, double acceleration, double lateral_acceleration);

/* The speed at the start: as a scenario states it, else *otherwise*. */
double chassis_start_speed(const chassis_inputs *in, double otherwise);

double chassis_limited(double value, double low, double high);

#endif
