/* What the trackers share: ports, and where a detection lies seen from the car. */
#ifndef TRACKER_H
#define TRACKER_H

#include <stdbool.h>
#include <stdint.h>

#define TRACKER_DETECTIONS 16
#define TRACKER_TRACKS 8

typedef struct {
    double x, y, heading, speed, lateral_speed, yaw_rate, acceleration, lateral_acceleration;
} tracker_motion;

typedef struct {
    bool valid;
    double range, azimuth, range_rate, strength;
    int32_t class;
    double width;
} tracker_detection;

typedef struct {
    tracker_motion motion;
    tracker_detection first[TRACKER_DETECTIONS];
    tracker_detection second[TRACKER_DETECTIONS];
} tracker_in;

typedef struct {
    int32_t id, class;
    double x, y, vx, vy, width, age;
} tracker_track;

typedef struct {
    tracker_track tracks[TRACKER_TRACKS];
} tracker_out;

/* Where it is from the centre of gravity, the ray it lies on, and its speed over ground along the ray. */
typedef struct {
    double x, y, cosine, sine, speed;
} tracker_place;

/* Of a sensor *mount* m ahead of the centre of gravity. */
tracker_place tracker_place_of(const tracker_detection *seen, const tracker_motion *motion, double mount);

#endif
