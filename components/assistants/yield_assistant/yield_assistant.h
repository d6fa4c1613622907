/* Stops before red lights, and before conflicts if a road user with the right of way would be there at the same time.
 *
 * Lights: red stops, yellow stops if v^2/(2 D) is not above yellow_deceleration when it becomes yellow, with D from the
 * front bumper to stop_gap before the line; else the car passes the light, even if it turns red (Gazis, Herman,
 * Maradudin: The problem of the amber signal light, Operations Research 8, 112, 1960).
 *
 * Conflicts of the host's path in which it gives way: the car would occupy the conflict from when its front enters to
 * when its rear leaves, at its present speed, or accelerating with start_acceleration once it has braked. Each
 * approaching object would occupy it from when it enters to when it has left, at its present velocity. If the time
 * between the two is less than time_margin, the car waits (post-encroachment time: Allen, Shin, Cooper: Analysis of
 * traffic conflicts and collisions, Transportation Research Record 667, 67, 1978). It starts again when that time is
 * greater by release_margin. With 1.5 s this accepts shorter gaps than the critical gaps of human drivers at stop signs
 * (6 to 7 s: Highway Capacity Manual, two-way stop-controlled intersections).
 *
 * Braking begins when v^2/(2 D) reaches comfort_deceleration; the demand is the present v^2/(2 D), 0 without a cause.
 * The car stops evenly at D = 0, stop_gap before the conflict and all others that it would block, and is held. A car in
 * the conflict continues, as does one that cannot stop with max_deceleration: emergency braking covers this case.
 *
 * An object approaches the conflict if the straight line of its velocity passes the middle of the conflict within
 * aside_tolerance. For objects from the side bend_tolerance times their distance is added, as their path may be curved.
 * Objects with the host's direction, within 30 degrees, are ignored. Tracks have no lengths; all are as long as
 * other_length. The preview gives the place of the conflict; beyond it, and without it, the lane continues straight. */
#ifndef YIELD_ASSISTANT_H
#define YIELD_ASSISTANT_H

#include <stdbool.h>
#include <stdint.h>

#include "../lights/light_choice.h"

#define YIELD_STEP 0.01 /* s; the step in the component.yaml */
#define YIELD_TRACKS 8
#define YIELD_CONFLICTS 16
#define YIELD_POINTS 24

enum { REASON_NONE, REASON_LIGHT, REASON_YIELD };

typedef struct {
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
        struct {
            double x_x, x_y, x_vx, x_vy, y_y, y_vx, y_vy, vx_vx, vx_vy, vy_vy;
        } covariance;
    } tracks[YIELD_TRACKS];
    struct {
        double distance;
        int32_t colour;
        double remaining;
    } light;
    struct {
        int32_t path;
        double entry, exit;
        int32_t other_path;
        double other_entry, other_exit;
        bool gives_way;
    } conflicts[YIELD_CONFLICTS];
    struct {
        double distance, x, y, heading, curvature;
    } preview[YIELD_POINTS];
} yield_assistant_in;

typedef struct {
    yield_assistant_in in;
    struct {
        double deceleration, brake_torque;
        int32_t reason;
    } out;
    struct {
        double comfort_deceleration, max_deceleration, yellow_deceleration, jerk, stop_gap;
        double time_margin, release_margin, start_acceleration;
        double other_length, aside_tolerance, bend_tolerance, min_speed;
        double front_length, rear_length, nominal_mass, wheel_radius;
    } par;
    int32_t light;         /* the action for it */
    double light_distance; /* m: one sample before */
    bool waits[YIELD_CONFLICTS];
} yield_assistant;

void yield_assistant_init(yield_assistant *self);
void yield_assistant_step(yield_assistant *self);

#endif
