/* Sees the lane: camera, map and the perfect sensor by their parameters.
 *
 * What is seen. The place in the lane and the points ahead up to *max_range*, a camera's up to where contrast fades, as for
 * camera_mono: -ln(contrast) / a, a of fog, rain and snow as in range_sensor.h; in the dark up to *night_range*;
 * against the sun the least contrast is (1 + veil) times as much (sensing.h). Sees it less
 * far than *least_range*, or misses it as it does in *dropout* of its scans, it sees nothing.
 *
 * Errors. Seen is the lane as y = y0 + psi s + c s^2 / 2 (Dickmanns, Mysliwetz: Recursive 3-D road and ego-state recognition,
 * IEEE PAMI 14:199, 1992) beside where it is: normal errors of y0 (offset), psi (heading) and c (curvature), new ones for each
 * scan, move all points as they move the lane. A map is read where the car believes to be: errors along and across the lane and
 * of heading are Gauss-Markov processes with one *correlation_time*, as those of satellites and inertia are (Gelb: Applied
 * optimal estimation, 1974, 4.5): the car sees the lane as it would from so much further along it, beside its middle or turned.
 * Widths and limits are those of the true place.
 *
 * When. It looks every *period*, first at time 0, and tells of it *latency* later, as it was then. What it sees nothing of, is
 * not valid; then what it told last is carried on by how the car moves: the points by its move in the plane, offset and heading
 * by ds = (dx cos psi - dy sin psi) / (1 - curvature offset) along the lane, curvature linear up to the next point. Before the
 * first scan all is 0: a straight lane, on its middle. */
#ifndef LANE_SIGHT_H
#define LANE_SIGHT_H

#include <stdbool.h>
#include <stdint.h>

#define LANE_SIGHT_POINTS 24
#define LANE_SIGHT_KEPT 16   /* scans that are under way at most */
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
        double max_range;               /* m along the lane; 0: all that is ahead */
        double least_range, night_range; /* m; 0: sees by night as by day */
        double contrast;                /* the least it sees; 0: needs no sight */
        double rain_loss, rain_exponent, snow_loss, snow_exponent, fog_share; /* as range_sensor has them */
        double dropout;                                                       /* share of scans */
        double offset_noise, heading_noise, curvature_noise;                  /* standard deviations, of each scan */
        double along_error, across_error, turn_error, correlation_time;       /* m, m, rad, s: of where the car believes to be */
        bool knows_station, knows_height, knows_limit;                        /* grade and bank; speed limits */
        int32_t seed;
    } par;
    lane_sight_seen made[LANE_SIGHT_KEPT]; /* scan n at n % LANE_SIGHT_KEPT */
    lane_sight_motion last;
    double along, across, turn; /* errors of the place */
    int32_t tick, told;         /* of this step; the number of the scan that is told */
    uint64_t random;
} lane_sight;

void lane_sight_init(lane_sight *self);
void lane_sight_step(lane_sight *self);

#endif
