/* Shared by emergency brakes: ports, and how the car meets the objects in its path. */
#ifndef EMERGENCY_H
#define EMERGENCY_H

#include <stdbool.h>
#include <stdint.h>

#define EMERGENCY_STEP 0.01 /* s; the step in the component.yaml of every emergency brake */
#define EMERGENCY_TRACKS 8

enum { STAGE_NONE, STAGE_WARNING, STAGE_PARTIAL, STAGE_FULL };
enum { CLASS_NONE, CLASS_CAR, CLASS_TRUCK, CLASS_MOTORCYCLE, CLASS_BICYCLE, CLASS_PEDESTRIAN, CLASS_OBSTACLE };

typedef struct {
    double x_x, x_y, x_vx, x_vy, y_y, y_vx, y_vy, vx_vx, vx_vy, vy_vy;
} emergency_covariance;

typedef struct {
    struct {
        double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
    } motion;
    struct {
        int32_t id, class;
        double x, y, vx, vy, ax, ax_deviation, width, age, existence;
        emergency_covariance covariance;
    } tracks[EMERGENCY_TRACKS];
} emergency_in;

typedef struct {
    int32_t stage;
    double deceleration, brake_torque;
} emergency_out;

/* An object relative to the car's path: the circle of its yaw rate and speed. */
typedef struct {
    bool is_ahead;        /* the object exists, and is not behind; else all is 0 */
    double gap;           /* m: from the front bumper along the path, >= 0 */
    double speed;         /* m/s: along the path, of the point of the path beside it */
    double closing;       /* m/s: -d gap/dt */
    double aside, across; /* m: of its middle to the left of the path; m/s: d aside/dt */
    double touching;      /* m: |aside| at which their sides touch */
    double cosine, sine, radius; /* direction of the path beside it, relative to the car; in radii of the circle */
} emergency_place;

/* m: of a road user of that class; 1 m and 0 without one. */
double emergency_width_of(int32_t class);
double emergency_length_of(int32_t class);

/* *front* is from the centre of gravity to the bumper, *width* that of the car. An object of unknown width gets
 * that of its class: 0.5 m for a pedestrian (Euro NCAP's target), 0.6 m for a bicycle, 1.8 m for a car; 1 m without one. */
emergency_place emergency_place_of(const emergency_in *in, int index, double front, double width);

/* How the car meets an object if both continue their present motion. */
typedef struct {
    bool is_ahead;    /* the object exists, and the car approaches it */
    double gap;       /* m: from the front bumper along the car's path, >= 0 */
    double closing;   /* m/s: -d gap/dt, > 0 */
    double speed, braking;    /* m/s, m/s2: of the object along the path; braking > 0: its speed falls */
    double braking_deviation; /* m/s2: standard deviation */
    double clearance; /* m: between their sides when the car arrives; < 0: they overlap */
    double clearance_deviation;                        /* m: standard deviation */
    double gap_variance, gap_closing, closing_variance; /* m2, m2/s, m2/s2: covariance of gap and closing */
} emergency_meeting;

/* Of a car: from its centre of gravity to its front bumper, its width; its length, 0: only its front counts; the width of
 * an object without width and class, 0: 1 m. */
typedef struct {
    double front, width, length, unknown_width;
} emergency_car;

/* The car keeps its path and speed, the object its velocities along and across that path. Deviations are linear in the
 * errors of the track; those of the car's motion and of widths are not known.
 *
 * With the length of the car > 0, a vehicle that crosses the path (faster than 1 m/s) is a box of the size of its class
 * (without a class: of a car if it is faster than 3 m/s, else it is none),
 * and meets the car if the way of that box across the path, from the arrival of the car's front until its rear has left,
 * overlaps the car's width: the closest approach of two boxes at constant velocities. The tracked point may be the middle
 * of its front or of its flank, so the box reaches half its length ahead of the point and its length behind it, and the
 * gap ends half its width before the point, and the car has passed one width behind it. */
emergency_meeting emergency_meet(const emergency_in *in, int index, const emergency_car *car);

/* From *last*, changed by no more than the jerk limits allow in one step. */
double emergency_build_up(double wanted, double last, double build_up_jerk, double release_jerk);

#endif
