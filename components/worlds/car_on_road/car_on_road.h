/* The straight road with a car assembled from parts: their loads, inertias, drag and tyres are inputs. */
#ifndef CAR_ON_ROAD_H
#define CAR_ON_ROAD_H

#include "../straight_road/straight_road.h"

#define CAR_ON_ROAD_SMOOTHING 1.0 /* s: as ISO 15622 limits the mean jerk over 1 s, not its peak */

typedef struct {
    struct {
        straight_road_axles wheels, brake;
        struct {
            straight_road_axles body, aero, tyres, wheels, discs, climate, battery, drive;
        } loads;
        struct {
            straight_road_axles tyres, wheels, discs, drive;
        } inertias;
        struct {
            double aero, wheels;
        } drag_areas;
        struct {
            double radius, grip, stiffness, rolling_resistance;
        } tyre;
    } in;
    struct {
        straight_road_axles wheel_speed;
        double speed, position, acceleration, jerk;
        double gap, closing_speed;
        struct {
            double speed;
        } lead;
        struct {
            double range, azimuth, closing_speed;
            bool hit;
        } scene;
        bool collision;
        double mass, front_share;
    } out;
    struct {
        double initial_speed, initial_gap;
        double lead_speed, lead_change_time, lead_change_rate, lead_final_speed;
        double payload, payload_front_share, cg_height, wheelbase;
        double grade, surface, air_density; /* surface: grip relative to dry asphalt */
        double ray_angle, ray_reach;
        int32_t ray_count, substeps;
    } par;
    straight_road road;
    double smooth_acceleration;
} car_on_road;

void car_on_road_init(car_on_road *self);
void car_on_road_step(car_on_road *self, double h);

#endif
