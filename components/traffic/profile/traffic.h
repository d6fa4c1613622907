/* Inputs and outputs of the traffic components. */
#ifndef TRAFFIC_H
#define TRAFFIC_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define TRAFFIC_MOVERS 8
#define TRAFFIC_PATHS 8
#define TRAFFIC_HEADS 16
#define TRAFFIC_CONFLICTS 16
#define TRAFFIC_LANES 8 /* that a path tells of */
#define TRAFFIC_HOSTS 16
#define TRAFFIC_CAR 1 /* of actor_class */
#define TRAFFIC_TRUCK 2
#define TRAFFIC_MOTORCYCLE 3
#define TRAFFIC_BICYCLE 4
#define TRAFFIC_PEDESTRIAN 5
#define TRAFFIC_RED 2 /* of the colours of light_head; below: none, off; above: red_yellow, yellow, green */
#define TRAFFIC_RED_YELLOW 3
#define TRAFFIC_YELLOW 4
#define TRAFFIC_DRY_GRIP 8.829 /* m/s2: 0.9 g, the friction of the tyres of the chassis on dry asphalt */
#define TRAFFIC_LEAST_FRICTION 0.001
#define TRAFFIC_QUARTER_TURN 1.57079632679489661923 /* rad */

typedef struct {
    int32_t id, class;
    double length, width, height, clearance;
    int32_t path;
    double lane, station, offset, turn;
    double speed, lateral_speed, acceleration;
} traffic_mover;

/* A lane where its path begins: m to the left of the path's own, and the classes that may drive there (in_the_way.h). */
typedef struct {
    double middle, width;
    int32_t users;
} traffic_lane;

typedef struct {
    struct {
        double station, offset, heading, curvature, width, grade, bank, speed_limit;
        bool on_road;
    } lane;
    struct {
        double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
    } motion;
    struct {
        double length;
        bool closed;
        int32_t leftmost, rightmost;
        double lane_width;
        traffic_lane lanes[TRAFFIC_LANES]; /* from the rightmost on; width 0: unknown */
    } paths[TRAFFIC_PATHS];
    struct {
        int32_t path;
        double station;
        int32_t colour;
        double remaining;
    } light_heads[TRAFFIC_HEADS];
    struct {
        int32_t path;
        double entry, exit;
        int32_t other_path;
        double other_entry, other_exit;
        bool gives_way;
    } conflicts[TRAFFIC_CONFLICTS];
    struct {
        double friction_loss, water_film, temperature;
    } surface;
    struct {
        double length, width, station, offset, speed;
    } hosts[TRAFFIC_HOSTS]; /* cars of a shared world, by their centres, on path 0; length 0: none */
} traffic_in;

typedef struct {
    traffic_mover movers[TRAFFIC_MOVERS];
} traffic_out;

/* m/s2: what the tyres can do on this surface; infinite on a dry road, where a vehicle brakes as its parameters define. */
static inline double traffic_grip(const traffic_in *in) {
    double loss = in->surface.friction_loss;
    return loss > 0 ? TRAFFIC_DRY_GRIP * fmax(1 - loss, TRAFFIC_LEAST_FRICTION) : HUGE_VAL;
}

/* Difference of two stations; on a closed path, of a lap of this length, at most half a lap. */
static inline double traffic_ahead(double lap, double from, double to) {
    return lap > 0 ? to - from - lap * rint((to - from) / lap) : to - from;
}

#endif
