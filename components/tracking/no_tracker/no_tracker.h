/* Passes on the nearest detections of the first sensor as tracks. Only the car's motion is stored; an id is the number
 * of the detection. Only the velocity along the ray is measured: the object is assumed to move along the car, as an
 * object ahead in its lane does. Without Doppler it is assumed to stand still. A scan reports its age: since then the
 * car has moved, and the object has continued with its speed. Covariances are those of the measurement; what is assumed
 * counts as exact, and every detection as an object that exists. */
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
