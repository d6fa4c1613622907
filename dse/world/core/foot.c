#include "foot.h"

#include <math.h>
#include <stddef.h>

#define ITERATIONS 60
#define LEAST_NEARNESS 0.02 /* of 1 - curvature * t; nearer to the centre of curvature than this, no foot is one */

/* Ahead of the line's normal at *s* the point lies by *ahead*; each step ahead takes *nearness* of that away. */
typedef struct {
    double ahead, nearness;
} sight;

static sight look(const path_table *path, double x, double y, double s, path_foot *foot) {
    foot->place = path_find(path, s, foot->place.piece);
    foot->line = path_line_at(foot->place);
    const path_line *line = &foot->line;
    double dx = x - line->x, dy = y - line->y;
    foot->t = dy * line->tx - dx * line->ty;
    sight seen = {dx * line->tx + dy * line->ty, 1 - line->curvature * foot->t};
    return seen;
}

/* Within [low, high]; a corner of the line, where the point lies ahead of one side and behind the other, is found by
 * halving. */
static bool descend(const path_table *path, double x, double y, double s, double low, double high, path_foot *foot) {
    for (int32_t i = 0; i < ITERATIONS; ++i) {
        int32_t piece = foot->place.piece;
        sight seen = look(path, x, y, s, foot);
        if (seen.ahead > 0) {
            low = s;
        } else {
            high = s;
        }
        double slope = foot->line.stretch * seen.nearness;
        /* Beyond the centre of curvature Newton's step leads away: go the point's way. */
        double step = seen.nearness > LEAST_NEARNESS ? seen.ahead / slope : seen.ahead;
        double next = s + step;
        bool halved = !(next >= low && next <= high);
        if (halved) {
            if (!(high - low > 1e-12 * (1 + fabs(s)))) return seen.nearness > LEAST_NEARNESS;
            next = 0.5 * (low + high);
        }
        step = fabs(next - s);
        s = next;
        /* What is left is of the size of Newton's step squared, unless the curvature jumped on the way. */
        if (!halved && (step < 1e-10 || (step < 1e-6 && i > 0 && piece == foot->place.piece))) {
            seen = look(path, x, y, s, foot);
            return seen.nearness > LEAST_NEARNESS;
        }
    }
    return false;
}

bool foot_from(const path_table *path, double x, double y, double s, int32_t near, path_foot *foot) {
    foot->place.piece = near;
    return descend(path, x, y, s, -HUGE_VAL, HUGE_VAL, foot);
}

static double length_of(const path_table *path, int32_t piece) {
    const double *row = path->rows + (ptrdiff_t)piece * path->stride;
    return (piece + 1 < path->pieces ? row[path->stride] : path->length) - row[0];
}

static double distance(const path_foot *foot, double x, double y) {
    double dx = x - foot->line.x, dy = y - foot->line.y;
    return sqrt(dx * dx + dy * dy);
}

path_foot foot_of_all(const path_table *path, double x, double y) {
    path_foot foot = {{path->rows, 0, 0, 0}, path_line_at((path_place){path->rows, 0, 0, 0}), 0}, best = foot;
    double nearest = HUGE_VAL;
    /* The middle of a piece is no farther away than the point in it that is nearest, and half its length. */
    for (int32_t pass = 0; pass < 2; ++pass) {
        double bound = nearest;
        for (int32_t i = 0; i < path->pieces; ++i) {
            const double *row = path->rows + (ptrdiff_t)i * path->stride;
            double start = row[0], length = length_of(path, i);
            foot.place = (path_place){row, 0.5 * length, 0, i};
            foot.line = path_line_at(foot.place);
            double middle = distance(&foot, x, y);
            if (pass == 0) {
                nearest = fmin(nearest, middle);
                continue;
            }
            if (middle - 0.51 * length > fmin(bound, nearest)) continue;
            descend(path, x, y, start + 0.5 * length, start, start + length, &foot);
            double found = distance(&foot, x, y);
            if (found <= nearest || i == 0) {
                nearest = found;
                best = foot;
            }
        }
    }
    /* From its end on a path that is not closed goes straight on. */
    foot = best;
    if (foot_from(path, x, y, path_station(best.place), best.place.piece, &foot) &&
        distance(&foot, x, y) <= nearest + 1e-9) {
        best = foot;
    }
    return best;
}
