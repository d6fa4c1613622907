/* Shared by the lateral controllers: ports, the path ahead, and the limits of the steering gear. */
#ifndef LATERAL_H
#define LATERAL_H

#include <stdbool.h>

#define LATERAL_STEP 0.02 /* s; the step in the component.yaml of every lateral controller */
#define LATERAL_POINTS 24

typedef struct {
    double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
} lateral_motion;

typedef struct {
    double station, offset, heading, curvature, width, grade, bank, speed_limit;
    bool on_road;
} lateral_lane;

typedef struct {
    double distance, x, y, heading, curvature;
} lateral_preview;

typedef struct {
    lateral_motion motion;
    lateral_lane lane;
    lateral_preview preview[LATERAL_POINTS];
} lateral_in;

typedef struct {
    double steering;
} lateral_out;

/* A point of the path, seen from the car's centre of gravity. */
typedef struct {
    double x, y;
} lateral_point;

/* Limits steering, and its change from *last* in one step. */
double lateral_steering(double wanted, double last, double max_angle, double max_rate);

/* Curvature of the path at that distance ahead along it, linear between the car and the points of the preview; beyond
 * the last point, its own. *from* counts the points before; it starts at 0 and increases with growing distances. */
double lateral_curvature(const lateral_in *in, double distance, int *from);

/* Coefficients of u, u from 0 to 1. */
typedef struct {
    double x[4], y[4];
} lateral_cubic;

/* The path on cubics with the directions of its points, straight beyond the last one. */
typedef struct {
    int pieces;
    double distance[LATERAL_POINTS + 1]; /* where each piece begins, and the last one ends */
    lateral_cubic cubic[LATERAL_POINTS];
    lateral_point end, direction;        /* of the last piece */
} lateral_line;

lateral_line lateral_line_of(const lateral_in *in);

/* The path at that distance ahead along it; *from* as above. */
lateral_point lateral_path(const lateral_line *line, double distance, int *from);

/* Where the path leaves a circle of *radius* about the point *behind* m behind the centre of gravity; the point beside
 * the car if that is outside. */
lateral_point lateral_path_on_circle(const lateral_in *in, double behind, double radius);

/* A point of the car relative to the path. */
typedef struct {
    double offset, heading; /* m to the left of the path; heading of the car relative to the path */
    double curvature;
} lateral_place;

/* The place of the point *ahead* m ahead of the centre of gravity, on the path of lateral_path. */
lateral_place lateral_place_of(const lateral_in *in, double ahead);

double lateral_clamp(double value, double low, double high);

#endif
