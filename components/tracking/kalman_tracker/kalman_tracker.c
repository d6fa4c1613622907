#include "kalman_tracker.h"

#include "filter.h"

#include <math.h>
#include <string.h>

#define STEP KALMAN_TRACKER_STEP
#define KEPT KALMAN_TRACKER_KEPT

typedef struct {
    double mount, range_noise, relative_noise, azimuth_noise, doppler_noise;
} sensor;

static sensor sensor_of(const kalman_tracker *self, int32_t number) {
    sensor first = {self->par.first_mount, self->par.first_range_noise, self->par.first_relative_noise,
                    self->par.first_azimuth_noise, self->par.first_doppler_noise};
    sensor second = {self->par.second_mount, self->par.second_range_noise, self->par.second_relative_noise,
                     self->par.second_azimuth_noise, self->par.second_doppler_noise};
    return number == 0 ? first : second;
}

/* Place, with the errors of range and azimuth turned into the car's axes, and speed along the ray. */
static filter_measurement measurement_of(const tracker_detection *seen, const tracker_motion *motion, const sensor *by) {
    tracker_place place = tracker_place_of(seen, motion, by->mount);
    double c = place.cosine, s = place.sine, away = by->relative_noise * seen->range;
    double along = by->range_noise * by->range_noise + away * away + 1e-12; /* never quite exact: S stays regular */
    double across = seen->range * by->azimuth_noise;
    across = across * across + 1e-12;
    filter_measurement measured = {
        by->doppler_noise > 0 ? 3 : 2,
        {place.x, place.y, place.speed},
        {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, c, s}},
        {{c * c * along + s * s * across, c * s * (along - across), 0},
         {c * s * (along - across), s * s * along + c * c * across, 0},
         {0, 0, by->doppler_noise * by->doppler_noise}},
    };
    return measured;
}

static void move(kalman_tracker *self) {
    const tracker_motion *now = &self->in.motion, *last = &self->last;
    double speed = 0.5 * (now->speed + last->speed), aside = 0.5 * (now->lateral_speed + last->lateral_speed);
    double angle = 0.5 * (now->yaw_rate + last->yaw_rate) * STEP, half = 0.5 * angle;
    /* The chord of an arc: sin(a/2) / (a/2) of its length, turned by a/2. */
    double shrink = fabs(half) > 1e-6 ? sin(half) / half : 1, c = shrink * cos(half), s = shrink * sin(half);
    double dx = (speed * c - aside * s) * STEP, dy = (speed * s + aside * c) * STEP;
    for (int32_t i = 0; i < KEPT; ++i) {
        kalman_tracker_kept *kept = &self->kept[i];
        if (kept->id == 0) continue;
        filter_predict(kept->state, kept->cov, STEP, dx, dy, angle, self->par.acceleration_noise);
        kept->age += STEP;
        kept->missed += STEP;
    }
    self->last = *now;
}

static void look_at(kalman_tracker_kept *kept, const tracker_detection *seen, int32_t number) {
    if (kept->sensor == number) ++kept->hits;
    if (seen->class != 0) kept->class = seen->class;
    kept->missed = 0;
    if (!(seen->width > 0)) return;
    ++kept->widths; /* mean of the first ten, then of about the last ten */
    kept->width += (seen->width - kept->width) / (kept->widths < 10 ? kept->widths : 10);
}

static void begin(kalman_tracker *self, const tracker_detection *seen, filter_measurement measured, int32_t number) {
    int32_t at = 0;
    while (at < KEPT && self->kept[at].id != 0) ++at;
    if (at == KEPT) return; /* no room: whoever is kept was there before */
    double spread = self->par.speed_deviation * self->par.speed_deviation;
    kalman_tracker_kept made = {.id = self->next_id++, .sensor = number, .looks = 1};
    for (int32_t i = 0; i < 2; ++i) {
        made.state[i] = measured.value[i];
        for (int32_t j = 0; j < 2; ++j) made.cov[i][j] = measured.noise[i][j];
        made.cov[2 + i][2 + i] = spread;
    }
    if (measured.count == 3) { /* the speed along the ray alone */
        filter_measurement doppler = {1, {measured.value[2]}, {{0, 0, measured.row[2][2], measured.row[2][3]}}, {{measured.noise[2][2]}}};
        filter_update(made.state, made.cov, &doppler);
    }
    look_at(&made, seen, number);
    self->kept[at] = made;
}

static void read(kalman_tracker *self, const tracker_detection seen[TRACKER_DETECTIONS], int32_t number) {
    sensor by = sensor_of(self, number);
    filter_measurement measured[TRACKER_DETECTIONS];
    double distance[KEPT][TRACKER_DETECTIONS];
    bool taken[TRACKER_DETECTIONS], fed[KEPT] = {false};
    for (int32_t d = 0; d < TRACKER_DETECTIONS; ++d) {
        taken[d] = !seen[d].valid;
        if (seen[d].valid) measured[d] = measurement_of(&seen[d], &self->in.motion, &by);
    }
    for (int32_t i = 0; i < KEPT; ++i) {
        kalman_tracker_kept *kept = &self->kept[i];
        if (kept->id == 0) continue;
        if (kept->sensor == number) ++kept->looks;
        for (int32_t d = 0; d < TRACKER_DETECTIONS; ++d) {
            if (seen[d].valid) distance[i][d] = filter_distance(kept->state, kept->cov, &measured[d]);
        }
    }
    for (;;) {
        int32_t track = -1, best = -1;
        double least = self->par.gate;
        for (int32_t i = 0; i < KEPT; ++i) {
            if (self->kept[i].id == 0 || fed[i]) continue;
            for (int32_t d = 0; d < TRACKER_DETECTIONS; ++d) {
                if (taken[d] || !(distance[i][d] < least)) continue;
                least = distance[i][d];
                track = i;
                best = d;
            }
        }
        if (track < 0) break;
        fed[track] = taken[best] = true;
        filter_update(self->kept[track].state, self->kept[track].cov, &measured[best]);
        look_at(&self->kept[track], &seen[best], number);
    }
    for (int32_t d = 0; d < TRACKER_DETECTIONS; ++d) {
        if (!taken[d]) begin(self, &seen[d], measured[d], number);
    }
}

static void judge(kalman_tracker *self) {
    for (int32_t i = 0; i < KEPT; ++i) {
        kalman_tracker_kept *kept = &self->kept[i];
        if (kept->id == 0) continue;
        if (kept->hits >= self->par.confirm && kept->looks <= self->par.of) kept->confirmed = true;
        if (kept->missed > self->par.coast || (!kept->confirmed && kept->looks >= self->par.of)) kept->id = 0;
    }
}

static void tell(kalman_tracker *self) {
    bool told[KEPT] = {false};
    for (int32_t out = 0; out < TRACKER_TRACKS; ++out) {
        int32_t nearest = -1;
        double least = HUGE_VAL;
        for (int32_t i = 0; i < KEPT; ++i) {
            const double *at = self->kept[i].state;
            double square = at[0] * at[0] + at[1] * at[1];
            if (self->kept[i].id == 0 || !self->kept[i].confirmed || told[i] || !(square < least)) continue;
            least = square;
            nearest = i;
        }
        tracker_track track = {0, 0, 0, 0, 0, 0, 0, 0};
        if (nearest >= 0) {
            const kalman_tracker_kept *kept = &self->kept[nearest];
            tracker_track found = {kept->id, kept->class, kept->state[0], kept->state[1],
                                   kept->state[2], kept->state[3], kept->width, kept->age};
            track = found;
            told[nearest] = true;
        }
        self->out.tracks[out] = track;
    }
}

static bool is_due(int32_t tick, double period) {
    int32_t every = period > STEP ? (int32_t)fmin(period / STEP + 0.5, 1e6) : 1;
    return tick % every == 0;
}

static void sense(kalman_tracker *self) {
    if (is_due(self->tick, self->par.first_period)) read(self, self->in.first, 0);
    if (is_due(self->tick, self->par.second_period)) read(self, self->in.second, 1);
    judge(self);
    tell(self);
}

void kalman_tracker_init(kalman_tracker *self) {
    memset(self->kept, 0, sizeof self->kept);
    self->next_id = 1;
    self->tick = 0;
    self->last = self->in.motion;
    sense(self);
}

void kalman_tracker_step(kalman_tracker *self) {
    ++self->tick;
    move(self);
    sense(self);
}
