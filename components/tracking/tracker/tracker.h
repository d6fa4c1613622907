/* What the trackers share: ports, and where a detection lies seen from the car. */
#ifndef TRACKER_H
#define TRACKER_H

#include <stdbool.h>
#include <stdint.h>

#define TRACKER_STEP 0.02 /* s; the step in the component.yaml of every tracker */
#define TRACKER_RETURNS 16
#define TRACKER_TRACKS 8

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
    int32_t number;
    double age, mount;
    tracker_detection returns[TRACKER_RETURNS];
} tracker_scan;

typedef struct {
    tracker_motion motion;
    tracker_scan first, second;
} tracker_in;

typedef struct {
    int32_t id, class;
    double x, y, vx, vy, width, age;
} tracker_track;

typedef struct {
    tracker_track tracks[TRACKER_TRACKS];
} tracker_out;

/* How the car has moved: place, heading and motion at the last steps, the newest first in *motion*. */
#define TRACKER_REMEMBERED 64
typedef struct {
    tracker_motion motion[TRACKER_REMEMBERED];
    double x[TRACKER_REMEMBERED], y[TRACKER_REMEMBERED], heading[TRACKER_REMEMBERED]; /* against where it began */
    int32_t newest, count;                                                           /* count 0: nothing yet */
} tracker_history;

/* A move of the car: ahead, to its left, and its turn, seen from where it began. */
typedef struct {
    double x, y, angle;
} tracker_move;

/* The move of *T* s at the mean of two motions: speeds along and across the car that turns, a chord of an arc. */
tracker_move tracker_moved(const tracker_motion *from, const tracker_motion *to, double T);

/* Remembers the motion a step after the last one; tells the move of the step. */
tracker_move tracker_remember(tracker_history *history, const tracker_motion *now);

/* The car *age* s ago: how it has moved since, and its motion then, linear between two steps. Before all that is
 * remembered (1.26 s) it moved as at the first step of it. */
typedef struct {
    tracker_move since;
    tracker_motion motion;
} tracker_past;

tracker_past tracker_ago(const tracker_history *history, double age);

/* Where a return was when it was seen, from where the centre of gravity is now, along the car's axes of now; the ray it lay
 * on; and its speed over ground along the ray. */
typedef struct {
    double x, y, cosine, sine, speed;
} tracker_place;

/* By a sensor *mount* m ahead of the centre of gravity, on the car as it was then. */
tracker_place tracker_place_of(const tracker_detection *seen, double mount, const tracker_past *then);

#endif
