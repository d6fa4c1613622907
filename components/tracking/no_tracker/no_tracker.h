/* Passes the first sensor's detections on, the nearest of them, as if each were a track: nothing is remembered, an id is
 * the number of the detection. Of velocities only that along the ray is measured: the object is taken to move along the
 * car, as one ahead in its lane does. Without Doppler it is taken to stand. */
#ifndef NO_TRACKER_H
#define NO_TRACKER_H

#include "../tracker/tracker.h"

typedef struct {
    tracker_in in;
    tracker_out out;
    struct {
        double mount; /* m */
        bool doppler;
    } par;
} no_tracker;

void no_tracker_init(no_tracker *self);
void no_tracker_step(no_tracker *self);

#endif
