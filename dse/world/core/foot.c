#include "foot.h"

#include <math.h>
#include <stddef.h>

#define ITERATIONS 60
#define LEAST_NEARNESS 0.02 /* of 1 - curvature * t; nearer to the centre of curvature than this, no foot is one */

static bool finish(double x, double y, path_place place, path_foot *foot) {
    foot->line = path_line_at(place);
    foot->t = (y - foot->line.y) * foot->line.tx - (x - foot->line.x) * foot->line.ty;
    return 1 - foot->line.curvature * foot->t > LEAST_NEARNESS;
}

/* The zero within [low, high] of how far the point lies ahead of the line's normal; a corner of the line, where it lies
 * ahead of one side and behind the other, is found by halving. */
static bool descend(const path_table *path, double x, double y, double s, int32_t near, double low, double high, path_foot *foot) {
    for (int32_t i = 0; i < ITERATIONS; ++i) {
        path_place place = path_find(path, s, near);
        path_course at = path_course_at(place);
        double dx = x - at.x[0], dy = y - at.y[0], ahead = dx * at.x[1] + dy * at.y[1];
        double square = at.x[1] * at.x[1] + at.y[1] * at.y[1], slope = square - dx * at.x[2] - dy * at.y[2];
        if (ahead > 0) {
            low = s;
        } else {
            high = s;
        }
        /* Beyond the centre of curvature Newton's step leads away: go the point's way. */
        double next = s + (slope > LEAST_NEARNESS * square ? ahead / slope : ahead);
        bool halved = !(next >= low && next <= high);
        if (halved) {
            if (!(high - low > 1e-12 * (1 + fabs(s)))) return finish(x, y, place, foot);
            next = 0.5 * (low + high);
        }
        double step = fabs(next - s);
        s = next;
        /* What is left is of the size of Newton's step squared, unless the curvature jumped on the way. */
        if (!halved && step < 1e-6) {
            path_place there = path_find(path, s, place.piece);
            if (step < 1e-10 || there.piece == place.piece) return finish(x, y, there, foot);
        }
        near = place.piece;
    }
    finish(x, y, path_find(path, s, near), foot);
    return false;
}

bool foot_from(const path_table *path, double x, double y, double s, int32_t near, path_foot *foot) {
    return descend(path, x, y, s, near, -HUGE_VAL, HUGE_VAL, foot);
}

static double distance(const path_line *line, double x, double y) {
    double dx = x - line->x, dy = y - line->y;
    return sqrt(dx * dx + dy * dy);
}

path_foot foot_of_all(const path_table *path, double x, double y) {
    path_foot foot, best = {path_line_at(path_find(path, 0, 0)), 0};
    double nearest = HUGE_VAL;
    /* The middle of a piece is no farther away than the point in it that is nearest, and half its length. */
    for (int32_t pass = 0; pass < 2; ++pass) {
        double bound = nearest;
        for (int32_t i = 0; i < path->pieces; ++i) {
            const double *row = path->rows + (ptrdiff_t)i * path->stride;
            double start = row[0], end = i + 1 < path->pieces ? row[path->stride] : path->length;
            path_place place = {row, 0.5 * (end - start), 0, i};
            path_line line = path_line_at(place);
            double middle = distance(&line, x, y);
            if (pass == 0) {
                nearest = fmin(nearest, middle);
                continue;
            }
            if (middle - 0.51 * (end - start) > fmin(bound, nearest)) continue;
            descend(path, x, y, 0.5 * (start + end), i, start, end, &foot);
            double found = distance(&foot.line, x, y);
            if (found <= nearest || i == 0) {
                nearest = found;
                best = foot;
            }
        }
    }
    /* From its end on a path that is not closed goes straight on. */
    const path_place *place = &best.line.place;
    if (foot_from(path, x, y, path_station(*place), place->piece, &foot) &&
        distance(&foot.line, x, y) <= nearest + 1e-9) {
        best = foot;
    }
    return best;
}
