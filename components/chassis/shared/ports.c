#include "ports.h"

#define TORQUE 1e5
#define FAR 1e6

double chassis_limited(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

double chassis_start_speed(const chassis_inputs *in, double otherwise) {
    return in->host_start.given ? chassis_limited(in->host_start.speed, -100, 100) : otherwise;
}

chassis_inputs chassis_within_reason(const chassis_inputs *in, double steering_limit) {
    chassis_inputs out = *in;
    out.wheels.front = chassis_limited(in->wheels.front, -TORQUE, TORQUE);
    out.wheels.rear = chassis_limited(in->wheels.rear, -TORQUE, TORQUE);
    out.brake.front = chassis_limited(in->brake.front, 0, TORQUE);
    out.brake.rear = chassis_limited(in->brake.rear, 0, TORQUE);
    out.steering = chassis_limited(in->steering, -steering_limit, steering_limit);
    for (int i = 0; i < 4; ++i) {
        out.wheel_torque[i] = chassis_limited(in->wheel_torque[i], -TORQUE, TORQUE);
        out.wheel_brake[i] = chassis_limited(in->wheel_brake[i], 0, TORQUE);
        out.ground[i].height = chassis_limited(in->ground[i].height, -FAR, FAR);
        out.ground[i].slope_x = chassis_limited(in->ground[i].slope_x, -2, 2);
        out.ground[i].slope_y = chassis_limited(in->ground[i].slope_y, -2, 2);
        out.ground[i].friction = chassis_limited(in->ground[i].friction, 0.001, 2);
    }
    out.start.x = chassis_limited(in->start.x, -FAR, FAR);
    out.start.y = chassis_limited(in->start.y, -FAR, FAR);
    out.start.heading = chassis_limited(in->start.heading, -FAR, FAR);
    out.air.density = in->air.density > 0 ? chassis_limited(in->air.density, 0, 2) : 1.2;
    out.air.wind_x = chassis_limited(in->air.wind_x, -100, 100);
    out.air.wind_y = chassis_limited(in->air.wind_y, -100, 100);
    return out;
}

void chassis_tell_motion(chassis_outputs *out, const double *body, double acceleration, double lateral_acceleration) {
    out->motion.x = body[0];
    out->motion.y = body[1];
    out->motion.heading = body[2];
    out->motion.speed = out->speed = body[3];
    out->motion.lateral_speed = body[4];
    out->motion.yaw_rate = body[5];
    out->motion.acceleration = out->acceleration = acceleration;
    out->motion.lateral_acceleration = lateral_acceleration;
    out->position = body[6];
}
