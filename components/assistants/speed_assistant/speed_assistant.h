/* The speed to drive: the driver's wish, the speed limit, the speed that curves ahead allow, and a stop at a red light.
 *
 * A speed u that must not be exceeded a distance D ahead allows sqrt(u^2 + 2 deceleration D) here: a car that keeps it
 * slows down evenly and reaches u exactly there. Curves: u^2 = lateral_acceleration/|k|, with the curvature k linear
 * between the car and the points of the preview. Where |k| grows by m per metre, u^2 + 2 d D has its minimum where
 * k^2 = lateral_acceleration m/(2 d), or at an end: the car enters no spiral too fast between two points.
 * Red: u = 0 with the front bumper stop_gap before the light. Yellow: as red, if the deceleration
 * (v^2/2)/(D - v lead_time) is not above yellow_deceleration when it becomes yellow; else the car passes, also at red
 * (Gazis, Herman, Maradudin: The problem of the amber signal light, Operations Research 8, 112, 1960).
 * Controllers follow a falling set speed late: all distances are reduced by v lead_time. A P law is deceleration/kp too
 * fast; with a lead_time of 1/kp a third of that remains where the curve begins, with 2/kp an eighth. A limit is not
 * previewed: where it begins, the set speed starts to fall to it with *deceleration*.
 *
 * Lateral comfort of 2 m/s2: ISO 15622 for curves. The bank of the road ahead is not given: curves count as level. */
#ifndef SPEED_ASSISTANT_H
#define SPEED_ASSISTANT_H

#include <stdbool.h>
#include <stdint.h>

#include "../lights/light_choice.h"

#define ASSISTANT_STEP 0.02 /* s; the step in the component.yaml */
#define ASSISTANT_POINTS 24

enum { REASON_WISH, REASON_LIMIT, REASON_CURVE, REASON_LIGHT };

typedef struct {
    struct {
        double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
    } motion;
    struct {
        double station, offset, heading, curvature, width, grade, bank, speed_limit;
        bool on_road;
    } lane;
    struct {
        double distance, x, y, heading, curvature;
    } preview[ASSISTANT_POINTS];
    struct {
        double distance;
        int32_t colour;
        double remaining;
    } light;
    double wish;
} speed_assistant_in;

typedef struct {
    double set_speed;
    int32_t reason;
} speed_assistant_out;

typedef struct {
    double lateral_acceleration, deceleration, yellow_deceleration;
    double lead_time, stop_gap, front_length;
} speed_assistant_par;

typedef struct {
    speed_assistant_in in;
    speed_assistant_out out;
    speed_assistant_par par;
    double limited;        /* m/s: the limit, or the ramp down to it; HUGE_VAL: none */
    double light_distance; /* m: one sample before */
    int32_t light;         /* the action for it */
} speed_assistant;

void speed_assistant_init(speed_assistant *self);
void speed_assistant_step(speed_assistant *self);

#endif
