/* Lines that road users follow, as points at the start: vertices as they are, curves in short chords. */
#include "storyboard.h"

#include <math.h>

#define CHORDS SB_CHORDS /* of each segment of a curve */
#define MOST_ORDER 8
#define PI 3.14159265358979323846

static sb_point *points_of(storyboard *board, const sb_trajectory *line) {
    return board->points + line->point;
}

static void lay_polyline(storyboard *board, const sb_trajectory *line) {
    sb_point *points = points_of(board, line);
    for (int32_t i = 0; i < line->vertices; ++i) {
        const sb_vertex *vertex = &scenario_tables.vertices[line->vertex + i];
        sb_place place = place_of(board, vertex->position, SB_NONE);
        points[i] = (sb_point){0, place.x, place.y, place.heading, board->values[vertex->time], NAN};
    }
    if (line->is_closed) points[line->points - 1] = points[0];
}

/* The heading turns by the mean of the curvature at both ends; each chord by Simpson's rule. */
static void lay_clothoids(storyboard *board, const sb_trajectory *line, int32_t actor) {
    sb_point *points = points_of(board, line);
    int32_t position = scenario_tables.vertices[line->vertex].position;
    sb_place start = position == SB_NONE ? board->actors[actor].at : place_of(board, position, SB_NONE);
    sb_point at = {0, start.x, start.y, start.heading, 0, NAN};
    points[0] = at;
    for (int32_t i = 1; i < line->vertices; ++i) {
        const int32_t *numbers = scenario_tables.vertices[line->vertex + i].numbers;
        double first = board->values[numbers[0]], last = board->values[numbers[1]], length = board->values[numbers[2]];
        double base = at.heading + board->values[numbers[3]], chord = length / CHORDS, bend = (last - first) / length;
        for (int32_t k = 0; k < CHORDS; ++k) {
            double u = k * chord, m = u + 0.5 * chord, v = u + chord;
            double a = base + u * (first + 0.5 * bend * u), b = base + m * (first + 0.5 * bend * m);
            double c = base + v * (first + 0.5 * bend * v);
            at.x += chord / 6 * (cos(a) + 4 * cos(b) + cos(c));
            at.y += chord / 6 * (sin(a) + 4 * sin(b) + sin(c));
            at.heading = c;
            points[1 + (i - 1) * CHORDS + k] = at;
        }
    }
    points[0].heading = start.heading + board->values[scenario_tables.vertices[line->vertex + 1].numbers[3]];
}

/* De Boor's algorithm on homogeneous coordinates. */
static void lay_nurbs(storyboard *board, const sb_trajectory *line) {
    sb_point *points = points_of(board, line);
    int32_t degree = line->order - 1;
    const int32_t *knots = scenario_tables.knots + line->knot;
    double low = board->values[knots[degree]], high = board->values[knots[line->vertices]];
    for (int32_t i = 0; i < line->points; ++i) {
        double u = low + (high - low) * i / (line->points - 1), d[MOST_ORDER][3];
        int32_t span = degree;
        while (span < line->vertices - 1 && u >= board->values[knots[span + 1]]) ++span;
        for (int32_t k = 0; k <= degree; ++k) {
            const sb_vertex *vertex = &scenario_tables.vertices[line->vertex + span - degree + k];
            sb_place place = place_of(board, vertex->position, SB_NONE);
            double weight = board->values[vertex->numbers[0]];
            d[k][0] = place.x * weight;
            d[k][1] = place.y * weight;
            d[k][2] = weight;
        }
        for (int32_t r = 1; r <= degree; ++r) {
            for (int32_t k = degree; k >= r; --k) {
                double from = board->values[knots[span - degree + k]], to = board->values[knots[span + 1 + k - r]];
                double part = to > from ? (u - from) / (to - from) : 0;
                for (int32_t c = 0; c < 3; ++c) d[k][c] = (1 - part) * d[k - 1][c] + part * d[k][c];
            }
        }
        points[i] = (sb_point){0, d[degree][0] / d[degree][2], d[degree][1] / d[degree][2], 0, 0, NAN};
    }
}

/* Whether a vertex has a direction of its own. */
static bool is_turned(const sb_trajectory *line, int32_t i) {
    if (line->kind != POLYLINE || i >= line->vertices) return false;
    return scenario_tables.positions[scenario_tables.vertices[line->vertex + i].position].has_heading;
}

void trajectory_lay(storyboard *board, int32_t number, int32_t actor) {
    const sb_trajectory *line = &scenario_tables.trajectories[number];
    sb_point *points = points_of(board, line);
    switch (line->kind) {
    case POLYLINE: lay_polyline(board, line); break;
    case CLOTHOIDS: lay_clothoids(board, line, actor); break;
    default: lay_nurbs(board, line);
    }
    for (int32_t i = 1; i < line->points; ++i) {
        points[i].s = points[i - 1].s + hypot(points[i].x - points[i - 1].x, points[i].y - points[i - 1].y);
    }
    /* Without directions of its own, a point has that of the chord to the next one. */
    for (int32_t i = 0; line->kind != CLOTHOIDS && i < line->points; ++i) {
        points[i].speed = NAN;
        if (is_turned(line, i)) continue;
        int32_t k = i + 1 < line->points ? i : i - 1;
        if (k >= 0 && points[k + 1].s > points[k].s) {
            points[i].heading = atan2(points[k + 1].y - points[k].y, points[k + 1].x - points[k].x);
        }
    }
}

double trajectory_length(const storyboard *board, int32_t number) {
    const sb_trajectory *line = &scenario_tables.trajectories[number];
    return board->points[line->point + line->points - 1].s;
}

static double between(double a, double b, double part) {
    return a + part * (b - a);
}

/* Beyond its ends a trajectory goes on straight. */
sb_point trajectory_at(const storyboard *board, int32_t number, double s) {
    const sb_trajectory *line = &scenario_tables.trajectories[number];
    const sb_point *points = board->points + line->point;
    int32_t low = 0, high = line->points - 1;
    while (high - low > 1) {
        int32_t middle = low + (high - low) / 2;
        if (points[middle].s <= s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    double length = points[high].s - points[low].s, part = length > 0 ? (s - points[low].s) / length : 0;
    double inside = fmin(fmax(part, 0), 1);
    bool turns = line->kind == CLOTHOIDS || is_turned(line, low);
    double turn = turns ? remainder(points[high].heading - points[low].heading, 2 * PI) : 0;
    return (sb_point){
        s,
        between(points[low].x, points[high].x, part),
        between(points[low].y, points[high].y, part),
        points[low].heading + inside * turn,
        between(points[low].time, points[high].time, inside),
        NAN,
    };
}

/* In which direction a road user moves along a line at a positive speed: who begins to reverse faces backwards. */
double trajectory_sense(int32_t number, double speed) {
    const sb_trajectory *line = &scenario_tables.trajectories[number];
    return !is_turned(line, 0) && speed < 0 ? -1 : 1;
}

void trajectory_put(const storyboard *board, int32_t number, sb_actor *actor, double sense) {
    sb_point at = trajectory_at(board, number, actor->along);
    bool is_reversed = sense < 0 && !is_turned(&scenario_tables.trajectories[number], 0);
    double heading = is_reversed ? at.heading + PI : at.heading;
    actor->at = (sb_place){.path = SB_NONE, .sense = 1, .x = at.x, .y = at.y, .heading = heading};
}

/* Between points the acceleration is constant, so that each is passed at its time; *speed* is that at the first. */
void trajectory_accelerate(storyboard *board, int32_t number, double speed) {
    const sb_trajectory *line = &scenario_tables.trajectories[number];
    sb_point *points = points_of(board, line);
    for (int32_t i = 0; i < line->points; ++i) {
        points[i].speed = speed;
        double way = i + 1 < line->points ? points[i + 1].s - points[i].s : 0;
        double duration = i + 1 < line->points ? points[i + 1].time - points[i].time : 0;
        speed = way > 0 && duration > 0 ? fmax(2 * way / duration - speed, 0) : 0;
    }
}

double trajectory_station(const storyboard *board, int32_t number, double time) {
    const sb_trajectory *line = &scenario_tables.trajectories[number];
    const sb_point *points = board->points + line->point;
    int32_t i = 0;
    while (i + 2 < line->points && points[i + 1].time <= time) ++i;
    double duration = points[i + 1].time - points[i].time;
    double part = duration > 0 ? fmin(fmax((time - points[i].time) / duration, 0), 1) : 1;
    double first = points[i].speed, way = points[i + 1].s - points[i].s;
    if (!isnan(first) && duration > 0) {
        /* Who would have to turn round arrives earlier. */
        double used = fmin(part * duration, first * duration > 2 * way ? 2 * way / first : duration);
        double bend = first * duration > 2 * way ? -first * first / (2 * way) : 2 * (way - first * duration) / (duration * duration);
        return way > 0 ? points[i].s + used * (first + 0.5 * bend * used) : points[i].s;
    }
    return between(points[i].s, points[i + 1].s, part);
}

double trajectory_foot(const storyboard *board, int32_t number, double x, double y) {
    const sb_trajectory *line = &scenario_tables.trajectories[number];
    const sb_point *points = board->points + line->point;
    double best = HUGE_VAL, found = 0;
    for (int32_t i = 0; i + 1 < line->points; ++i) {
        double dx = points[i + 1].x - points[i].x, dy = points[i + 1].y - points[i].y, square = dx * dx + dy * dy;
        double part = square > 0 ? ((x - points[i].x) * dx + (y - points[i].y) * dy) / square : 0;
        part = fmin(fmax(part, 0), 1);
        double off = hypot(points[i].x + part * dx - x, points[i].y + part * dy - y);
        if (off < best) {
            best = off;
            found = between(points[i].s, points[i + 1].s, part);
        }
    }
    return found;
}
