#include "no_tracker.h"

#include <math.h>

void no_tracker_step(no_tracker *self) {
    const tracker_scan *scan = &self->in.first;
    int32_t count = 0;
    tracker_remember(&self->history, &self->in.motion);
    tracker_past then = tracker_ago(&self->history, scan->age);
    for (int32_t i = 0; i < TRACKER_RETURNS && count < TRACKER_TRACKS && scan->number > 0; ++i) {
        const tracker_detection *seen = &scan->returns[i];
        if (!seen->valid) continue;
        tracker_place place = tracker_place_of(seen, scan, &then);
        bool is_ahead = fabs(place.cosine) > 0.1; /* beside the car the ray gives no speed along it */
        double speed = seen->rate_deviation > 0 && is_ahead ? place.speed / place.cosine : 0;
        double c = place.cosine, s = place.sine, R = seen->range, rate = is_ahead ? seen->rate_deviation / c : 0;
        double along = hypot(seen->range_deviation, R * scan->scale.deviation);
        double across = R * hypot(seen->azimuth_deviation, scan->misalignment.deviation), age = scan->age;
        along *= along;
        across *= across;
        rate *= rate;
        tracker_covariance covariance = {.x_x = c * c * along + s * s * across + rate * age * age,
                                         .x_y = c * s * (along - across),
                                         .y_y = s * s * along + c * c * across,
                                         .x_vx = rate * age,
                                         .vx_vx = rate};
        tracker_track track = {i + 1, seen->class, place.x + speed * age, place.y, speed, 0, 0, 0, seen->width, 0, 1, covariance};
        self->out.tracks[count++] = track;
    }
    tracker_track none = {.id = 0};
    while (count < TRACKER_TRACKS) self->out.tracks[count++] = none;
}

void no_tracker_init(no_tracker *self) {
    self->history.count = 0;
    no_tracker_step(self);
    self->history.count = 0; /* the first step is at time 0, too */
}
