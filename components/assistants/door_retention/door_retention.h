/* Keeps the doors of a standing car shut while a road user passes, or is about to.
 *
 * A track counts if it is beside the car, from its side to *reach*, moves along it forwards faster than least_speed, is at
 * most *horizon* seconds before the rear edge of the front door, and at most *clearance* beyond it. The doors stay shut for
 * *hold* afterwards. While the car moves, they are not retained by this function. */
#ifndef DOOR_RETENTION_H
#define DOOR_RETENTION_H

#include "../../tracking/tracker/tracker.h"

typedef struct {
    tracker_motion motion;
    tracker_track tracks[TRACKER_TRACKS];
} door_retention_in;

typedef struct {
    bool retained;
} door_retention_out;

typedef struct {
    door_retention_in in;
    door_retention_out out;
    struct {
        double horizon, reach, clearance, hold, least_speed, min_age, least_existence, door_edge, width;
    } par;
    int32_t left; /* samples until the doors can be opened */
} door_retention;

void door_retention_init(door_retention *self);
void door_retention_step(door_retention *self);

#endif
