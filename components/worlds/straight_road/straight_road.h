/* World of the paper's case study: a straight road, the host vehicle with its wheels, one vehicle in front. */
#ifndef STRAIGHT_ROAD_H
#define STRAIGHT_ROAD_H

#include <stdbool.h>
#include <stdint.h>

#include "../../traffic/profile/speed_profile.h"
#include "host.h"
#include "ray_fan.h"

typedef struct {
    double front, rear;
} straight_road_axles;

typedef struct {
    struct {
        straight_road_axles wheels, brake;
        struct {
            int32_t mode;
        } status;
    } in;
    struct {
        straight_road_axles wheel_speed;
        double speed, position, acceleration;
        double gap, closing_speed;
        struct {
            double speed;
        } lead;
        struct {
            double range, azimuth, closing_speed;
            bool hit;
        } scene;
        bool collision;
    } out;
    struct {
        double initial_speed, initial_gap;
        double lead_speed, lead_change_time, lead_change_rate, lead_final_speed;
        double lead_offset, lead_width, lead_length;
        double mass, front_load_share, cg_height, wheelbase;
        double wheel_radius, inertia_front, inertia_rear;
        double drag_area, air_density, rolling_resistance, grade;
        double friction, slip_stiffness;
        double ray_angle, ray_reach;
        int32_t ray_count, substeps;
    } par;
    host_state host;
    ray_fan rays;
    counted_time time;
} straight_road;

void straight_road_init(straight_road *self);
void straight_road_step(straight_road *self, double h);

#endif
