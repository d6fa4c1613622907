#include "lane_target.h"

#include <math.h>
#include <string.h>

/* A track relative to the lane: distance of its foot along the middle, its offset to the left, the speed of the foot,
   and the speed of the track to the left of it. */
typedef struct {
    double distance, offset, speed, across;
} place;

/* *from*: of a smaller distance, see lateral_path. */
static double square_to(const lateral_line *line, double distance, int from, double x, double y) {
    lateral_point point = lateral_path(line, distance, &from);
    return (x - point.x) * (x - point.x) + (y - point.y) * (y - point.y);
}

/* Minimum between two distances, by the golden section. */
static double nearest_between(const lateral_line *line, double low, double high, double x, double y) {
    int from = 0;
    lateral_path(line, low, &from);
    const double golden = 0.6180339887498949;
    double a = high - golden * (high - low), b = low + golden * (high - low);
    double at_a = square_to(line, a, from, x, y), at_b = square_to(line, b, from, x, y);
    for (int i = 0; i < 48 && high - low > 1e-7; ++i) {
        if (at_a < at_b) {
            high = b;
            b = a;
            at_b = at_a;
            a = high - golden * (high - low);
            at_a = square_to(line, a, from, x, y);
        } else {
            low = a;
            a = b;
            at_a = at_b;
            b = low + golden * (high - low);
            at_b = square_to(line, b, from, x, y);
        }
    }
    return 0.5 * (low + high);
}

/* The foot is between the neighbours of the nearest point of the preview. */
static double foot(const lateral_line *line, double x, double y) {
    double low = 0, high = 0, here = 0, before = 0, least = square_to(line, 0, 0, x, y);
    bool is_nearest = true, is_last = false; /* the point *here* is the nearest so far */
    for (int i = 0; !is_last; ++i) {
        is_last = i == line->pieces;
        double next = is_last ? here + sqrt(x * x + y * y) : line->distance[i + 1];
        double square = square_to(line, next, i, x, y);
        if (is_nearest) {
            low = before;
            high = next;
        }
        is_nearest = square < least;
        if (is_nearest) least = square;
        before = here;
        here = next;
    }
    if (is_nearest) {
        low = before;
        high = here;
    }
    return nearest_between(line, low, high, x, y);
}

static place place_of(const lateral_in *lane, const lateral_line *line, const tracker_track *track) {
    place found;
    int from = 0;
    found.distance = foot(line, track->x, track->y);
    double half = 1e-3, behind = fmax(found.distance - half, 0);
    lateral_point a = lateral_path(line, behind, &from), b = lateral_path(line, found.distance + half, &from);
    double dx = b.x - a.x, dy = b.y - a.y, length = sqrt(dx * dx + dy * dy);
    double c = length > 0 ? dx / length : 1, s = length > 0 ? dy / length : 0;
    from = 0;
    lateral_point at = lateral_path(line, found.distance, &from);
    found.offset = c * (track->y - at.y) - s * (track->x - at.x);
    from = 0;
    double stretch = 1 - lateral_curvature(lane, found.distance, &from) * found.offset;
    found.speed = (c * track->vx + s * track->vy) / (stretch > 0.1 ? stretch : 0.1);
    found.across = c * track->vy - s * track->vx;
    return found;
}

/* The least distance from the middle from now until *horizon*. */
static double least_offset(const place *at, double horizon) {
    double later = at->offset + horizon * at->across;
    return at->offset * later < 0 ? 0 : fmin(fabs(at->offset), fabs(later));
}

static double own_speed(const lateral_in *lane) {
    double stretch = 1 - lane->lane.curvature * lane->lane.offset, turn = lane->lane.heading;
    double along = lane->motion.speed * cos(turn) - lane->motion.lateral_speed * sin(turn);
    return along / (stretch > 0.1 ? stretch : 0.1);
}

static void choose(lane_target *self) {
    lateral_in lane = {.motion = self->in.motion, .lane = self->in.lane};
    memcpy(lane.preview, self->in.preview, sizeof lane.preview);
    lateral_line line;
    bool is_known = false;
    double least = HUGE_VAL, speed = 0;
    int32_t id = 0;
    for (int32_t i = 0; i < TRACKER_TRACKS; ++i) {
        const tracker_track *track = &self->in.tracks[i];
        if (track->id == 0 || !(track->x > 0)) continue;
        if (!is_known) line = lateral_line_of(&lane);
        is_known = true;
        place at = place_of(&lane, &line, track);
        double share = self->par.share + (track->id == self->followed ? self->par.hold : 0);
        if (least_offset(&at, self->par.horizon) > 0.5 * share * lane.lane.width) continue;
        if (!(at.distance > 1e-6 && at.distance < least)) continue;
        least = at.distance;
        speed = at.speed;
        id = track->id;
    }
    self->followed = id;
    self->out.target.detected = id != 0;
    if (id == 0) return;
    self->out.target.gap = least - self->par.host_front;
    self->out.target.closing_speed = own_speed(&lane) - speed;
}

void lane_target_init(lane_target *self) {
    self->followed = 0;
    self->out.target.gap = self->out.target.closing_speed = 0;
    choose(self);
}

void lane_target_step(lane_target *self) { choose(self); }
