/* Shared by the trackers: ports, and the place of a detection in the car's axes. */
#ifndef TRACKER_H
#define TRACKER_H

#include <stdbool.h>
#include <stdint.h>

#define TRACKER_STEP 0.02 /* s; the step in the component.yaml of every tracker */
#define TRACKER_RETURNS 16
#define TRACKER_TRACKS 8
#ifndef TRACKER_SCANS
#define TRACKER_SCANS 2 /* surround_tracker has 7 */
#endif

typedef struct {
    double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
} tracker_motion;

typedef struct {
    bool valid;
    double range, azimuth, range_rate, strength;
    int32_t class;
    double width, range_deviation, azimuth_deviation, rate_deviation;
} tracker_detection;

typedef struct {
    double deviation, time;
} tracker_lasting;

typedef struct {
    int32_t number;
    double age, mount, mount_left, mount_turn;
    tracker_lasting scale, misalignment;
    tracker_detection returns[TRACKER_RETURNS];
} tracker_scan;

typedef struct {
    tracker_motion motion;
    tracker_scan first, second;
#if TRACKER_SCANS > 2
    tracker_scan corner_1, corner_2, corner_3, corner_4, corner_5;
#endif
} tracker_in;

typedef struct {
    double x_x, x_y, x_vx, x_vy, y_y, y_vx, y_vy, vx_vx, vx_vy, vy_vy;
} tracker_covariance;

typedef struct {
    int32_t id, class;
    double x, y, vx, vy, ax, ax_deviation, width, age, existence;
    tracker_covariance covariance;
} tracker_track;

typedef struct {
    tracker_track tracks[TRACKER_TRACKS];
} tracker_out;

/* The car's motion: place, heading and motion at the last steps, the newest first in *motion*. */
#define TRACKER_REMEMBERED 64
typedef struct {
    tracker_motion motion[TRACKER_REMEMBERED];
    double x[TRACKER_REMEMBERED], y[TRACKER_REMEMBERED], heading[TRACKER_REMEMBERED]; /* relative to the start */
    int32_t newest, count;                                                           /* count 0: empty */
} tracker_history;

/* A move of the car: ahead, to its left, and its turn, in the axes of its start. */
typedef struct {
    double x, y, angle;
} tracker_move;

/* The move in *T* s with the mean of two motions: speeds along and across the turning car, a chord of an arc. */
tracker_move tracker_moved(const tracker_motion *from, const tracker_motion *to, double T);

/* Stores the motion one step after the last one; returns the move of the step. */
tracker_move tracker_remember(tracker_history *history, const tracker_motion *now);

/* The car *age* s ago: its move since, and its motion then, linear between two steps. Before the first stored step
 * (1.26 s) it moved as at that step. */
typedef struct {
    tracker_move since;
    tracker_motion motion;
} tracker_past;

tracker_past tracker_ago(const tracker_history *history, double age);

/* The place of a return at the time of the scan, from the present centre of gravity, along the car's present axes; its
 * ray; and its speed over ground along the ray. */
typedef struct {
    double x, y, cosine, sine, speed;
} tracker_place;

/* By the sensor of *scan*, on the car as it was then. */
tracker_place tracker_place_of(const tracker_detection *seen, const tracker_scan *scan, const tracker_past *then);

#endif
