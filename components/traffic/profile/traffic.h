/* What the components of traffic are told and tell. */
#ifndef TRAFFIC_H
#define TRAFFIC_H

#include <stdbool.h>
#include <stdint.h>

#define TRAFFIC_MOVERS 8
#define TRAFFIC_CAR 1 /* of actor_class */

typedef struct {
    int32_t id, class;
    double length, width, height;
    int32_t path, lane;
    double station, offset, turn;
    double speed, lateral_speed, acceleration;
} traffic_mover;

typedef struct {
    struct {
        double station, offset, heading, curvature, width, grade, bank, speed_limit;
        bool on_road;
    } lane;
    struct {
        double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
    } motion;
} traffic_in;

typedef struct {
    traffic_mover movers[TRAFFIC_MOVERS];
} traffic_out;

#endif
