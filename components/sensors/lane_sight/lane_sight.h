/* Lane sensor: its parameters make it a camera, a map or a perfect sensor.
 *
 * Range. It sees the place in the lane and the points ahead up to *max_range*. A camera sees them while contrast
 * suffices, as camera_mono: -ln(contrast) / a, a of fog, rain and snow as in range_sensor.h; in the dark up to
 * *night_range*; against the sun the least contrast is (1 + veil) times as much (sensing.h). If its range is below
 * *least_range*, or it misses the lane (*dropout* of its scans), it sees nothing.
 *
 * Errors. The lane is seen as y = y0 + psi s + c s^2 / 2 (Dickmanns, Mysliwetz: Recursive 3-D road and ego-state
 * recognition, IEEE PAMI 14:199, 1992) relative to its true place. Each scan has new normal errors of y0 (offset), psi
 * (heading) and c (curvature), which move all points with the lane. A map is read at the estimated place: errors along
 * and across the lane and of heading are Gauss-Markov processes with one *correlation_time*, as of satellites and
 * inertia (Gelb: Applied optimal estimation, 1974, 4.5): the lane is seen from a place shifted along it and aside, and
 * turned. Widths and limits are those of the true place.
 *
 * Timing. It scans every *period*, first at time 0, and reports *latency* later, with the values of the scan. Unseen
 * items are not valid; the last reported ones are then extrapolated by the car's motion: the points by its move in the
 * plane, offset and heading by ds = (dx cos psi - dy sin psi) / (1 - curvature offset) along the lane, curvature linear
 * up to the next point. Before the first scan all is 0: a straight lane, on its middle. */
#ifndef LANE_SIGHT_H
#define LANE_SIGHT_H

#include <stdbool.h>
#include <stdint.h>

#define LANE_SIGHT_POINTS 24
#define LANE_SIGHT_KEPT 16   /* scans that are pending at most */
#define LANE_SIGHT_STEP 0.01 /* s; the step in the component.yaml of every such sensor */

typedef struct {
    double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
} lane_sight_motion;

typedef struct {
    double station, offset, heading, curvature, width, grade, bank, speed_limit;
    bool on_road;
} lane_sight_lane;

typedef struct {
    double distance, x, y, heading, curvature;
} lane_sight_point;

typedef struct {
    bool valid;
    lane_sight_lane lane;
    lane_sight_point preview[LANE_SIGHT_POINTS];
} lane_sight_seen;

typedef struct {
    struct {
        lane_sight_motion motion;
        lane_sight_lane lane;
        lane_sight_point preview[LANE_SIGHT_POINTS];
        struct {
            double rain_rate, snow_rate, fog_extinction, darkness;
        } visibility;
        struct {
            double azimuth, elevation, glare;
        } sun;
    } in;
    struct {
        lane_sight_seen seen;
    } out;
    struct {
        double period, latency;         /* s, in whole steps */
        double max_range;               /* m along the lane; 0: all points ahead */
        double least_range, night_range; /* m; 0: sees by night as by day */
        double contrast;                /* the least visible contrast; 0: no limit */
        double rain_loss, rain_exponent, snow_loss, snow_exponent, fog_share; /* as in range_sensor */
        double dropout;                                                       /* share of scans */
        double offset_noise, heading_noise, curvature_noise;                  /* standard deviations, of each scan */
        double along_error, across_error, turn_error, correlation_time;       /* m, m, rad, s: of the estimated place */
        bool knows_station, knows_height, knows_limit;                        /* grade and bank; speed limits */
        int32_t seed;
    } par;
    lane_sight_seen made[LANE_SIGHT_KEPT]; /* scan n at n % LANE_SIGHT_KEPT */
    lane_sight_motion last;
    double along, across, turn; /* errors of the place */
    int32_t tick, told;         /* of this step; the number of the reported scan */
    uint64_t random;
} lane_sight;

void lane_sight_init(lane_sight *self);
void lane_sight_step(lane_sight *self);

#endif
