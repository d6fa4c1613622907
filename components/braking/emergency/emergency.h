/* What emergency brakes share: ports, and how the car meets the objects in its way. */
#ifndef EMERGENCY_H
#define EMERGENCY_H

#include <stdbool.h>
#include <stdint.h>

#define EMERGENCY_STEP 0.01 /* s; the step in the component.yaml of every emergency brake */
#define EMERGENCY_TRACKS 8

enum { STAGE_NONE, STAGE_WARNING, STAGE_PARTIAL, STAGE_FULL };
enum { CLASS_NONE, CLASS_CAR, CLASS_TRUCK, CLASS_MOTORCYCLE, CLASS_BICYCLE, CLASS_PEDESTRIAN, CLASS_OBSTACLE };

typedef struct {
    struct {
        double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
    } motion;
    struct {
        int32_t id, class;
        double x, y, vx, vy, width, age;
    } tracks[EMERGENCY_TRACKS];
} emergency_in;

typedef struct {
    int32_t stage;
    double deceleration, brake_torque;
} emergency_out;

/* Where an object is against the car's way: the circle of its yaw rate and speed. */
typedef struct {
    bool is_ahead;        /* there is one, and it is not behind; else all is 0 */
    double gap;           /* m: from the front bumper along the way, >= 0 */
    double speed;         /* m/s: along the way, of the point of the way beside it */
    double closing;       /* m/s: -d gap/dt */
    double aside, across; /* m: of its middle to the left of the way; m/s: d aside/dt */
    double touching;      /* m: |aside| where their sides touch */
} emergency_place;

/* *front* is from the centre of gravity to the bumper, *width* that of the car. An object whose width is not known is
 * as wide as its class: 0.5 m a pedestrian (Euro NCAP's target), 0.6 m a bicycle, 1.8 m a car. */
emergency_place emergency_place_of(const emergency_in *in, int index, double front, double width);

/* How the car meets an object if both go on as they do. */
typedef struct {
    bool is_ahead;    /* there is one, and the car comes nearer to it */
    double gap;       /* m: from the front bumper along the car's way, >= 0 */
    double closing;   /* m/s: -d gap/dt, > 0 */
    double clearance; /* m: between their sides when the car arrives; < 0: they overlap */
} emergency_meeting;

/* The car keeps its way and speed, the object its velocities along and across that way. */
emergency_meeting emergency_meet(const emergency_in *in, int index, double front, double width);

/* From one that was *last*, by no more than the jerks allow in one step. */
double emergency_build_up(double wanted, double last, double build_up_jerk, double release_jerk);

#endif
