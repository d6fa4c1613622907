/* What the components of traffic are told and tell. */
#ifndef TRAFFIC_H
#define TRAFFIC_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define TRAFFIC_MOVERS 8
#define TRAFFIC_CAR 1 /* of actor_class */
#define TRAFFIC_BICYCLE 4
#define TRAFFIC_PEDESTRIAN 5
#define TRAFFIC_QUARTER_TURN 1.57079632679489661923 /* rad */

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

/* Stations from one to another; on a closed path, of a lap of this length, at most half way round. */
static inline double traffic_ahead(double lap, double from, double to) {
    return lap > 0 ? to - from - lap * rint((to - from) / lap) : to - from;
}

#endif
