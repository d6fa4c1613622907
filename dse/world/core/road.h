/* A road network seen from the path that the host drives: the ground below its wheels, its place in its lane, the lane
 * ahead, and where others are in the world. What the road is like is in the tables; nothing is integrated. */
#ifndef ROAD_H
#define ROAD_H

#include "path.h"

#define ROAD_WHEELS 4
#define ROAD_ACTORS 8
#define ROAD_PREVIEW 24
#define ROAD_PATHS 8
#define ROAD_LIGHTS 16
#define ROAD_CONFLICTS 16
#define ROAD_LANES 8 /* of a path in its direction */

typedef struct {
    double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
} road_motion;

typedef struct {
    int32_t id, class;
    double length, width, height, clearance;
    int32_t path;
    double lane, station, offset, turn;
    double speed, lateral_speed, acceleration;
} road_mover;

typedef struct {
    int32_t id, class;
    double length, width, height, clearance;
    double x, y, z, heading;
    double speed, lateral_speed, acceleration;
    int32_t path, lane;
    double station, offset;
    double ahead, aside, approach, above;
} road_actor;

typedef struct {
    struct {
        road_motion motion;
        struct {
            double x, y;
        } contacts[ROAD_WHEELS];
        road_mover movers[ROAD_ACTORS];
        struct {
            double friction_loss, water_film, temperature;
        } surface;
        struct {
            bool given;
            double x, y, heading, speed;
        } host_start;
        double clock_offset;
    } in;
    struct {
        struct {
            double height, slope_x, slope_y, friction;
        } ground[ROAD_WHEELS];
        struct {
            double station, offset, heading, curvature, width, grade, bank, speed_limit;
            bool on_road;
        } lane;
        struct {
            double distance, x, y, heading, curvature;
        } preview[ROAD_PREVIEW];
        struct {
            double x, y, heading;
        } start;
        road_actor actors[ROAD_ACTORS];
        struct {
            double distance;
            int32_t colour;
            double remaining;
        } light;
        struct {
            double length;
            bool closed;
            int32_t leftmost, rightmost;
            double lane_width;
            struct {
                double middle, width;
                int32_t users;
            } lanes[ROAD_LANES];
        } paths[ROAD_PATHS];
        struct {
            int32_t path;
            double station;
            int32_t colour;
            double remaining;
        } light_heads[ROAD_LIGHTS];
        struct {
            int32_t path;
            double entry, exit;
            int32_t other_path;
            double other_entry, other_exit;
            bool gives_way;
        } conflicts[ROAD_CONFLICTS];
    } out;
    struct {
        double start_station, start_offset, preview_spacing; /* m; 0: no preview */
        int32_t start_lane;
    } par;
    /* Where things were last: stations of the host's path, and pieces of paths to begin looking at. */
    double x, y, station, per_x, per_y; /* stations per m along the axes */
    int32_t piece, mover_pieces[ROAD_ACTORS], crossing_pieces[ROAD_ACTORS];
    double crossing_stations[ROAD_ACTORS];
    bool crosses[ROAD_ACTORS];
    double base_time, step; /* time is base_time + steps * step, never a sum of steps */
    int64_t steps;
} road;

void road_init(road *self);
void road_step(road *self, double h);

#endif
