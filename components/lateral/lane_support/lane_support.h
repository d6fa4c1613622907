/* Shared by the functions that keep a car from leaving its lane: ports. */
#ifndef LANE_SUPPORT_H
#define LANE_SUPPORT_H

#include <stdbool.h>
#include <stdint.h>

#define LANE_SUPPORT_STEP 0.02 /* s; the step in the component.yaml of each */
#define LANE_SUPPORT_TRACKS 8

typedef struct {
    double x_x, x_y, x_vx, x_vy, y_y, y_vx, y_vy, vx_vx, vx_vy, vy_vy;
} lane_support_covariance;

typedef struct {
    double wish;
    struct {
        double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
    } motion;
    struct {
        double station, offset, heading, curvature, width, grade, bank, speed_limit;
        bool on_road;
    } lane;
    struct {
        int32_t id, class;
        double x, y, vx, vy, ax, ax_deviation, width, age, existence;
        lane_support_covariance covariance;
    } tracks[LANE_SUPPORT_TRACKS];
} lane_support_in;

typedef struct {
    double steering;
    bool active;
} lane_support_out;

#endif
