#include "no_tracker.h"

#include <math.h>

void no_tracker_init(no_tracker *self) {
    int32_t count = 0;
    for (int32_t i = 0; i < TRACKER_DETECTIONS && count < TRACKER_TRACKS; ++i) {
        const tracker_detection *seen = &self->in.first[i];
        if (!seen->valid) continue;
        tracker_place place = tracker_place_of(seen, &self->in.motion, self->par.mount);
        bool is_ahead = fabs(place.cosine) > 0.1; /* beside the car the ray says nothing about speed along it */
        double speed = self->par.doppler && is_ahead ? place.speed / place.cosine : 0;
        tracker_track track = {i + 1, seen->class, place.x, place.y, speed, 0, seen->width, 0};
        self->out.tracks[count++] = track;
    }
    tracker_track none = {0, 0, 0, 0, 0, 0, 0, 0};
    while (count < TRACKER_TRACKS) self->out.tracks[count++] = none;
}

void no_tracker_step(no_tracker *self) { no_tracker_init(self); }
