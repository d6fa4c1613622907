/* The tracker for TRACKER_SCANS sensors: included once, by the file that sets their number. */
#include "kalman_tracker.h"

#include <math.h>
#include <string.h>

#define KEPT KALMAN_TRACKER_KEPT
#define CLASSES 7 /* of actor_class */
#define DRIVES 2.0 /* m/s: above it the velocity gives the direction of the body */
#define TURNS 0.3 /* m/s: standard deviation of an unmeasured change of velocity */
#define SURE 0.999 /* the highest probability of existence */
#define LEAST_WIDTH 1e-3 /* m; 0 means: unknown */

typedef struct {
    filter_measurement measured[TRACKER_RETURNS];
    double origin[TRACKER_RETURNS][2]; /* place of the sensor at the scan */
    bool taken[TRACKER_RETURNS], fed[KEPT];
} pairing;

static const tracker_scan *scan_of(const kalman_tracker *self, int32_t number) {
    const tracker_scan *scans[TRACKER_SCANS] = {&self->in.first, &self->in.second};
#if TRACKER_SCANS > 2
    scans[2] = &self->in.corner_1;
    scans[3] = &self->in.corner_2;
    scans[4] = &self->in.corner_3;
    scans[5] = &self->in.corner_4;
    scans[6] = &self->in.corner_5;
#endif
    return scans[number];
}

static int32_t lasting_of(int32_t number) { return FILTER_MOVING + 2 * number; } /* the states of a sensor */

/* Place at the scan, with the errors of range and azimuth in the car's present axes, and speed along the ray. */
static filter_measurement measurement_of(const tracker_detection *seen, const tracker_scan *scan, const tracker_past *then, double origin[2]) {
    tracker_place place = tracker_place_of(seen, scan, then);
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
        {0.5 * age * age, 0, -age * c},
    };
    origin[0] = place.x - seen->range * c;
    origin[1] = place.y - seen->range * s;
    return measured;
}

/* The errors of scale and azimuth of sensor *number* at (x, y). With a measured place its noise would bias the estimate. */
static void relate(filter_measurement *measured, int32_t number, const double origin[2], double x, double y) {
    int32_t scale = lasting_of(number), azimuth = scale + 1;
    measured->row[0][scale] = measured->row[1][azimuth] = x - origin[0];
    measured->row[1][scale] = y - origin[1];
    measured->row[0][azimuth] = -measured->row[1][scale];
}

/* Measurement *d*, as seen from the estimate of a track. */
static filter_measurement seen_by(const pairing *all, int32_t d, const filter *estimate, int32_t number) {
    filter_measurement measured = all->measured[d];
    const double *state = estimate->state;
    relate(&measured, number, all->origin[d], state[0] + measured.row[0][2] * state[2], state[1] + measured.row[1][3] * state[3]);
    return measured;
}

static double fade_of(const tracker_lasting *error) { return error->time > 0 ? exp(-TRACKER_STEP / error->time) : 1; }

static void move(kalman_tracker *self) {
    bool is_first = self->history.count == 0;
    tracker_move moved = tracker_remember(&self->history, &self->in.motion);
    if (is_first) return;
    const tracker_lasting *errors[2 * TRACKER_SCANS];
    double fade[2 * TRACKER_SCANS], steady = exp(-TRACKER_STEP / self->par.acceleration_time);
    for (int32_t e = 0; e < 2 * TRACKER_SCANS; ++e) {
        const tracker_scan *scan = scan_of(self, e / 2);
        errors[e] = e % 2 == 0 ? &scan->scale : &scan->misalignment;
        fade[e] = fade_of(errors[e]);
    }
    for (int32_t i = 0; i < KEPT; ++i) {
        kalman_tracker_kept *kept = &self->kept[i];
        if (kept->id == 0) continue;
        filter_predict(&kept->estimate, TRACKER_STEP, moved.x, moved.y, moved.angle, self->par.acceleration_noise);
        filter_bias_predict(&kept->acceleration, TRACKER_STEP, moved.angle, steady, self->par.acceleration_deviation);
        for (int32_t e = 0; e < 2 * TRACKER_SCANS; ++e) {
            if (fade[e] < 1) filter_fade(&kept->estimate, &kept->acceleration, FILTER_MOVING + e, fade[e], errors[e]->deviation);
        }
        kept->age += TRACKER_STEP;
        kept->missed += TRACKER_STEP;
    }
}

static void weigh(const kalman_tracker *self, kalman_tracker_kept *kept, bool hit) {
    double real = hit ? self->par.detection_rate : 1 - self->par.detection_rate;
    double not = hit ? self->par.false_rate : 1 - self->par.false_rate;
    kept->existence = fmin(kept->existence * real / (kept->existence * real + (1 - kept->existence) * not), SURE);
}

static void look_at(const kalman_tracker *self, kalman_tracker_kept *kept, const tracker_detection *seen, int32_t number) {
    weigh(self, kept, true);
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
    double unknown = self->par.acceleration_deviation * self->par.acceleration_deviation;
    kalman_tracker_kept made = {
        .id = self->next_id++, .acceleration.variance = unknown, .sensor = number, .looks = 1, .existence = self->par.birth};
    filter *estimate = &made.estimate;
    for (int32_t sensor = 0; sensor < TRACKER_SCANS; ++sensor) {
        const tracker_scan *scan = scan_of(self, sensor);
        int32_t scale = lasting_of(sensor), azimuth = scale + 1;
        estimate->cov[scale][scale] = scan->scale.deviation * scan->scale.deviation;
        estimate->cov[azimuth][azimuth] = scan->misalignment.deviation * scan->misalignment.deviation;
    }
    for (int32_t i = 0; i < 2; ++i) {
        estimate->state[i] = measured.value[i];
        estimate->cov[2 + i][2 + i] = spread;
        for (int32_t j = 0; j < 2; ++j) {
            estimate->cov[i][j] = measured.noise[i][j];
            for (int32_t e = FILTER_MOVING; e < FILTER_STATES; ++e) {
                estimate->cov[i][j] += measured.row[i][e] * measured.row[j][e] * estimate->cov[e][e];
            }
        }
        for (int32_t e = FILTER_MOVING; e < FILTER_STATES; ++e) {
            estimate->cov[i][e] = estimate->cov[e][i] = -measured.row[i][e] * estimate->cov[e][e];
        }
    }
    if (measured.count == 3) { /* only the speed along the ray */
        filter_measurement doppler = {1, {measured.value[2]}, {{0, 0, measured.row[2][2], measured.row[2][3]}}, {{measured.noise[2][2]}}, {0}};
        filter_update(estimate, NULL, &doppler);
    }
    filter_predict(estimate, age, 0, 0, 0, 0);
    look_at(self, &made, seen, number);
    self->kept[at] = made;
}

/* As if the seen point were any point of the body: a track without class may be as large as a lorry. */
static void spread(kalman_tracker_kept *kept) {
    static const double length[CLASSES] = {16, 4.5, 16, 2.2, 1.8, 0.5, 1}, width[CLASSES] = {2.55, 1.8, 2.55, 0.8, 0.6, 0.5, 1};
    double vx = kept->estimate.state[2], vy = kept->estimate.state[3], speed = sqrt(vx * vx + vy * vy);
    bool drives = speed > fmax(DRIVES, 2 * sqrt(kept->estimate.cov[2][2] + kept->estimate.cov[3][3])); /* and the speed is significant */
    filter_spread(&kept->estimate, length[kept->class], width[kept->class], drives ? vx / speed : 1, drives ? vy / speed : 0);
}

/* The nearest pairs of the remaining tracks and detections; *elsewhere*: possibly another point of the same body. */
static void pair(kalman_tracker *self, pairing *all, const tracker_detection *seen, int32_t number, bool elsewhere) {
    double distance[KEPT][TRACKER_RETURNS];
    for (int32_t i = 0; i < KEPT; ++i) {
        if (self->kept[i].id == 0 || all->fed[i]) continue;
        kalman_tracker_kept kept = self->kept[i];
        if (elsewhere) spread(&kept);
        for (int32_t d = 0; d < TRACKER_RETURNS; ++d) {
            if (all->taken[d]) continue;
            filter_measurement measured = seen_by(all, d, &kept.estimate, number);
            distance[i][d] = filter_distance(&kept.estimate, &measured);
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
        double aside = fabs(kept->estimate.state[1]);
        if (elsewhere) spread(kept);
        filter_measurement measured = seen_by(all, best, &kept->estimate, number);
        filter_update(&kept->estimate, &kept->acceleration, &measured);
        if (elsewhere) { /* a track that shows another face may be turning */
            for (int32_t v = 2; v < 4; ++v) kept->estimate.cov[v][v] += TURNS * TURNS;
            /* another face has its own width; until that is measured, the far end of the body stays */
            kept->widths = 0;
            if (kept->width > 0) kept->width = fmax(kept->width - 2 * (aside - fabs(kept->estimate.state[1])), LEAST_WIDTH);
        }
        look_at(self, kept, &seen[best], number);
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
        if (seen[d].valid) all.measured[d] = measurement_of(&seen[d], scan, &then, all.origin[d]);
    }
    for (int32_t i = 0; i < KEPT; ++i) {
        if (self->kept[i].id != 0 && self->kept[i].sensor == number) ++self->kept[i].looks;
    }
    pair(self, &all, seen, number, false);
    pair(self, &all, seen, number, true);
    for (int32_t i = 0; i < KEPT; ++i) {
        if (self->kept[i].id != 0 && self->kept[i].sensor == number && !all.fed[i]) weigh(self, &self->kept[i], false);
    }
    for (int32_t d = 0; d < TRACKER_RETURNS; ++d) {
        filter_measurement *measured = &all.measured[d];
        if (all.taken[d]) continue;
        relate(measured, number, all.origin[d], measured->value[0], measured->value[1]);
        begin(self, &seen[d], *measured, scan->age, number);
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
            const double *at = self->kept[i].estimate.state;
            double square = at[0] * at[0] + at[1] * at[1];
            if (self->kept[i].id == 0 || !self->kept[i].confirmed || told[i] || !(square < least)) continue;
            least = square;
            nearest = i;
        }
        tracker_track track = {.id = 0};
        if (nearest >= 0) {
            const kalman_tracker_kept *kept = &self->kept[nearest];
            const double *state = kept->estimate.state;
            const double (*c)[FILTER_STATES] = kept->estimate.cov;
            tracker_track found = {kept->id, kept->class, state[0], state[1], state[2], state[3],
                                   kept->acceleration.value, sqrt(kept->acceleration.variance), kept->width, kept->age, kept->existence,
                                   {c[0][0], c[0][1], c[0][2], c[0][3], c[1][1], c[1][2], c[1][3], c[2][2], c[2][3], c[3][3]}};
            track = found;
            told[nearest] = true;
        }
        self->out.tracks[out] = track;
    }
}

static void clear(kalman_tracker *self) {
    memset(self->kept, 0, sizeof self->kept);
    memset(self->read, 0, sizeof self->read);
    self->history.count = 0;
    self->next_id = 1;
}

void kalman_tracker_step(kalman_tracker *self) {
    move(self);
    for (int32_t sensor = 0; sensor < TRACKER_SCANS; ++sensor) read(self, scan_of(self, sensor), sensor);
    judge(self);
    tell(self);
}

void kalman_tracker_init(kalman_tracker *self) {
    clear(self);
    kalman_tracker_step(self);
    clear(self); /* the first step is at time 0, too */
}
