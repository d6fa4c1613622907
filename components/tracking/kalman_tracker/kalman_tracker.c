#include "kalman_tracker.h"

#include "filter.h"

#include <math.h>
#include <string.h>

#define KEPT KALMAN_TRACKER_KEPT
#define CLASSES 7 /* of actor_class */
#define DRIVES 2.0 /* m/s: above it the velocity gives the direction of the body */
#define TURNS 0.3 /* m/s: standard deviation of an unmeasured change of velocity */
#define LEAST_WIDTH 1e-3 /* m; 0 means: unknown */

typedef struct {
    filter_measurement measured[TRACKER_RETURNS];
    bool taken[TRACKER_RETURNS], fed[KEPT];
} pairing;

/* Place at the scan, with the errors of range and azimuth in the car's present axes, and speed along the ray. */
static filter_measurement measurement_of(const tracker_detection *seen, const tracker_scan *scan, const tracker_past *then) {
    tracker_place place = tracker_place_of(seen, scan->mount, then);
    double c = place.cosine, s = place.sine, age = scan->age;
    double along = seen->range_deviation * seen->range_deviation + 1e-12; /* never quite exact: S stays regular */
    double across = seen->range * seen->azimuth_deviation;
    across = across * across + 1e-12;
    filter_measurement measured = {
        seen->rate_deviation > 0 ? 3 : 2,
        {place.x, place.y, place.speed},
        {{1, 0, -age, 0}, {0, 1, 0, -age}, {0, 0, c, s}},
        {{c * c * along + s * s * across, c * s * (along - across), 0},
         {c * s * (along - across), s * s * along + c * c * across, 0},
         {0, 0, seen->rate_deviation * seen->rate_deviation}},
    };
    return measured;
}

static void move(kalman_tracker *self) {
    bool is_first = self->history.count == 0;
    tracker_move moved = tracker_remember(&self->history, &self->in.motion);
    if (is_first) return;
    for (int32_t i = 0; i < KEPT; ++i) {
        kalman_tracker_kept *kept = &self->kept[i];
        if (kept->id == 0) continue;
        filter_predict(kept->state, kept->cov, TRACKER_STEP, moved.x, moved.y, moved.angle, self->par.acceleration_noise);
        kept->age += TRACKER_STEP;
        kept->missed += TRACKER_STEP;
    }
}

static void look_at(kalman_tracker_kept *kept, const tracker_detection *seen, int32_t number) {
    if (kept->sensor == number) ++kept->hits;
    if (seen->class > 0 && seen->class < CLASSES) kept->class = seen->class;
    kept->missed = 0;
    if (!(seen->width > 0)) return;
    ++kept->widths; /* mean of the first ten, then of about the last ten */
    kept->width += (seen->width - kept->width) / (kept->widths < 10 ? kept->widths : 10);
}

static void begin(kalman_tracker *self, const tracker_detection *seen, filter_measurement measured, double age, int32_t number) {
    int32_t at = 0;
    while (at < KEPT && self->kept[at].id != 0) ++at;
    if (at == KEPT) return; /* no room: existing tracks are kept */
    double spread = self->par.speed_deviation * self->par.speed_deviation;
    kalman_tracker_kept made = {.id = self->next_id++, .sensor = number, .looks = 1};
    for (int32_t i = 0; i < 2; ++i) {
        made.state[i] = measured.value[i];
        for (int32_t j = 0; j < 2; ++j) made.cov[i][j] = measured.noise[i][j];
        made.cov[2 + i][2 + i] = spread;
    }
    if (measured.count == 3) { /* only the speed along the ray */
        filter_measurement doppler = {1, {measured.value[2]}, {{0, 0, measured.row[2][2], measured.row[2][3]}}, {{measured.noise[2][2]}}};
        filter_update(made.state, made.cov, &doppler);
    }
    filter_predict(made.state, made.cov, age, 0, 0, 0, 0);
    look_at(&made, seen, number);
    self->kept[at] = made;
}

/* As if the seen point were any point of the body: a track without class may be as large as a lorry. */
static void spread(kalman_tracker_kept *kept) {
    static const double length[CLASSES] = {16, 4.5, 16, 2.2, 1.8, 0.5, 1}, width[CLASSES] = {2.55, 1.8, 2.55, 0.8, 0.6, 0.5, 1};
    double vx = kept->state[2], vy = kept->state[3], speed = sqrt(vx * vx + vy * vy);
    bool drives = speed > fmax(DRIVES, 2 * sqrt(kept->cov[2][2] + kept->cov[3][3])); /* and the speed is significant */
    filter_spread(kept->cov, length[kept->class], width[kept->class], drives ? vx / speed : 1, drives ? vy / speed : 0);
}

/* The nearest pairs of the remaining tracks and detections; *elsewhere*: possibly another point of the same body. */
static void pair(kalman_tracker *self, pairing *all, const tracker_detection *seen, int32_t number, bool elsewhere) {
    double distance[KEPT][TRACKER_RETURNS];
    for (int32_t i = 0; i < KEPT; ++i) {
        kalman_tracker_kept kept = self->kept[i];
        if (kept.id == 0 || all->fed[i]) continue;
        if (elsewhere) spread(&kept);
        for (int32_t d = 0; d < TRACKER_RETURNS; ++d) {
            if (!all->taken[d]) distance[i][d] = filter_distance(kept.state, kept.cov, &all->measured[d]);
        }
    }
    for (;;) {
        int32_t track = -1, best = -1;
        double least = self->par.gate;
        for (int32_t i = 0; i < KEPT; ++i) {
            if (self->kept[i].id == 0 || all->fed[i]) continue;
            for (int32_t d = 0; d < TRACKER_RETURNS; ++d) {
                if (all->taken[d] || !(distance[i][d] < least)) continue;
                least = distance[i][d];
                track = i;
                best = d;
            }
        }
        if (track < 0) break;
        kalman_tracker_kept *kept = &self->kept[track];
        all->fed[track] = all->taken[best] = true;
        double aside = fabs(kept->state[1]);
        if (elsewhere) spread(kept);
        filter_update(kept->state, kept->cov, &all->measured[best]);
        if (elsewhere) { /* a track that shows another face may be turning */
            for (int32_t v = 2; v < 4; ++v) kept->cov[v][v] += TURNS * TURNS;
            /* another face has its own width; until that is measured, the far end of the body stays */
            kept->widths = 0;
            if (kept->width > 0) kept->width = fmax(kept->width - 2 * (aside - fabs(kept->state[1])), LEAST_WIDTH);
        }
        look_at(kept, &seen[best], number);
    }
}

static void read(kalman_tracker *self, const tracker_scan *scan, int32_t number) {
    if (scan->number == self->read[number]) return;
    self->read[number] = scan->number;
    if (scan->number <= 0) return;
    const tracker_detection *seen = scan->returns;
    tracker_past then = tracker_ago(&self->history, scan->age);
    pairing all = {.fed = {false}};
    for (int32_t d = 0; d < TRACKER_RETURNS; ++d) {
        all.taken[d] = !seen[d].valid;
        if (seen[d].valid) all.measured[d] = measurement_of(&seen[d], scan, &then);
    }
    for (int32_t i = 0; i < KEPT; ++i) {
        if (self->kept[i].id != 0 && self->kept[i].sensor == number) ++self->kept[i].looks;
    }
    pair(self, &all, seen, number, false);
    pair(self, &all, seen, number, true);
    for (int32_t d = 0; d < TRACKER_RETURNS; ++d) {
        if (!all.taken[d]) begin(self, &seen[d], all.measured[d], scan->age, number);
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

static void clear(kalman_tracker *self) {
    memset(self->kept, 0, sizeof self->kept);
    self->history.count = self->read[0] = self->read[1] = 0;
    self->next_id = 1;
}

void kalman_tracker_step(kalman_tracker *self) {
    move(self);
    read(self, &self->in.first, 0);
    read(self, &self->in.second, 1);
    judge(self);
    tell(self);
}

void kalman_tracker_init(kalman_tracker *self) {
    clear(self);
    kalman_tracker_step(self);
    clear(self); /* the first step is at time 0, too */
}
