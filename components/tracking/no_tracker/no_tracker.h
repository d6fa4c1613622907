/* Passes the first sensor's detections on, the nearest of them, as if each were a track: nothing is remembered but how the
 * car has moved, an id is the number of the detection. Of velocities only that along the ray is measured: the object is
 * taken to move along the car, as one ahead in its lane does. Without Doppler it is taken to stand. What a scan tells is as
 * old as it says: since then the car has moved, and the object on with its speed. */
#ifndef NO_TRACKER_H
#define NO_TRACKER_H

#include "../tracker/tracker.h"

typedef struct {
    tracker_in in;
    tracker_out out;
    tracker_history history;
} no_tracker;

void no_tracker_init(no_tracker *self);
void no_tracker_step(no_tracker *self);

#endif
