/* Stops before red lights, and before conflicts for those who have the right of way and would be there at the same time.
 *
 * Lights: red stops, yellow stops if v^2/(2 D) is not above yellow_deceleration when it becomes yellow, with D from the
 * front bumper to stop_gap before the line; else the car drives on, past a red that follows, too (Gazis, Herman,
 * Maradudin: The problem of the amber signal light, Operations Research 8, 112, 1960).
 *
 * Conflicts of the host's path in which it gives way: the car would be in the conflict from when its front enters to when
 * its rear leaves, at its present speed, or speeding up with start_acceleration once it has braked; each object that
 * comes there would be in it from when it enters to when it has left, at its present velocity. If the two times come
 * nearer to each other than time_margin, the car waits (post-encroachment time: Allen, Shin, Cooper: Analysis of traffic
 * conflicts and collisions, Transportation Research Record 667, 67, 1978), and drives on when they are release_margin
 * further apart. With 1.5 s this accepts gaps that are shorter than the critical ones of human drivers at stop signs
 * (6 to 7 s: Highway Capacity Manual, two-way stop-controlled intersections).
 *
 * Braking begins when v^2/(2 D) reaches comfort_deceleration and goes on with what v^2/(2 D) is then: an even stop at D = 0,
 * where the car is held; that is stop_gap before the conflict, and before all others in which the car would stand. Where no cause is left, the demand falls to nothing. A car whose front is in the conflict goes
 * on, as does one that could only stop with more than max_deceleration: what is left is a matter for emergency braking.
 *
 * An object is one that comes to the conflict if the straight line of its velocity passes the conflict's middle within
 * aside_tolerance; for those from the side bend_tolerance times their way is added, as they may come round a bend. Those
 * who drive as the host does, within 30 degrees, are no concern of it. Tracks tell no lengths; all are as long as
 * other_length. Where the conflict lies is told by the preview; beyond it, and without it, the lane goes on straight. */
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
        double x, y, vx, vy, width, age;
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
    int32_t light;         /* what is done about it */
    double light_distance; /* m: a sample ago */
    bool waits[YIELD_CONFLICTS];
} yield_assistant;

void yield_assistant_init(yield_assistant *self);
void yield_assistant_step(yield_assistant *self);

#endif
