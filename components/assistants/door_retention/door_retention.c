#include "door_retention.h"

#include <math.h>

#define STANDSTILL 0.1 /* m/s */
#define INSIDE 0.3     /* m: by which a track may seem to be within the car's side */

static bool passes(const door_retention *self, const tracker_track *track) {
    if (track->id == 0 || track->age < self->par.min_age || track->existence < self->par.least_existence) return false;
    double beside = fabs(track->y) - 0.5 * self->par.width, before = -self->par.door_edge - track->x;
    if (beside < -INSIDE || beside > self->par.reach || track->vx < self->par.least_speed) return false;
    return before < self->par.horizon * track->vx && -before < self->par.clearance;
}

void door_retention_init(door_retention *self) {
    self->left = 0;
    self->out.retained = false;
}

void door_retention_step(door_retention *self) {
    bool is_danger = false;
    for (int32_t i = 0; i < TRACKER_TRACKS; ++i) is_danger = is_danger || passes(self, &self->in.tracks[i]);
    if (!(fabs(self->in.motion.speed) < STANDSTILL)) {
        self->left = 0;
    } else if (is_danger) {
        self->left = (int32_t)floor(self->par.hold / TRACKER_STEP + 0.5) + 1;
    } else if (self->left > 0) {
        --self->left;
    }
    self->out.retained = self->left > 0;
}
