/* Emergency lane keeping: steers back before the car leaves the road, or its lane towards a vehicle that it would hit.
 *
 * The outer front wheel is d from the edge of the lane and nears it with the lateral speed u. It steers if
 *   d < trigger_distance + trigger_time u,
 * a limit on the distance and on the time to line crossing (Mammar, Glaser, Netto: Time to line crossing for lane
 * departure avoidance, IEEE Trans. Intelligent Transportation Systems 7:226, 2006). The right edge always counts: it is
 * that of the road. The left one counts if a track beside it is less than *horizon* away, oncoming or from behind.
 *
 * From then on it controls the lateral acceleration towards the place y0 where the side is keep_distance inside the edge,
 *   a = offset_gain (y0 - y) - speed_gain dy/dt,
 * within max_acceleration (3 m/s2: UN R79, corrective steering) and max_jerk, by the steering angle L (a / v^2 + k) of a
 * car that rolls. It keeps on for *hold*, since the driver who drifted does not steer. */
#ifndef EMERGENCY_LANE_KEEPING_H
#define EMERGENCY_LANE_KEEPING_H

#include "../lane_support/lane_support.h"

typedef struct {
    double trigger_distance, trigger_time, keep_distance, horizon, hold;
    double offset_gain, speed_gain, max_acceleration, max_jerk;
    double min_speed, max_speed;
    double wheelbase, front_axle, width;
} emergency_lane_keeping_par;

typedef struct {
    lane_support_in in;
    lane_support_out out;
    emergency_lane_keeping_par par;
    double sense;        /* of the edge: 1 left, -1 right */
    double acceleration; /* m/s2, demanded */
    int32_t left;        /* steps until it ends */
} emergency_lane_keeping;

void emergency_lane_keeping_init(emergency_lane_keeping *self);
void emergency_lane_keeping_step(emergency_lane_keeping *self);

#endif
