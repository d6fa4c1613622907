#include "path.h"

#include <math.h>
#include <stddef.h>

static const double *row_of(const path_table *path, int32_t piece) {
    return path->rows + (ptrdiff_t)piece * path->stride;
}

/* The last piece whose number in column *at* is at most *value*; 0 if none is. Most often it is *near* or the next. */
static int32_t piece_at(const path_table *path, int32_t at, double value, int32_t near) {
    int32_t last = path->pieces - 1;
    for (int32_t i = near; i >= 0 && i <= last && i < near + 2; ++i) {
        if ((i == 0 || row_of(path, i)[at] <= value) && (i == last || value < row_of(path, i + 1)[at])) return i;
    }
    int32_t low = 0, high = path->pieces;
    while (high - low > 1) {
        int32_t middle = low + (high - low) / 2;
        if (row_of(path, middle)[at] <= value) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Into [0, length); what is no number stays none. */
static double around(double value, double length) {
    if (value >= 0 && value < length) return value;
    value -= length * floor(value / length);
    return value >= length ? 0 : value;
}

path_place path_find(const path_table *path, double s, int32_t near) {
    double beyond = 0;
    if (path->closed) {
        s = around(s, path->length);
    } else if (!(s >= 0 && s <= path->length)) {
        double end = s < 0 ? 0 : path->length;
        beyond = s - end;
        s = end;
    }
    int32_t piece = piece_at(path, 0, s, near);
    const double *row = row_of(path, piece);
    path_place place = {row, s - row[0], beyond, piece};
    return place;
}

double path_station(path_place place) {
    return place.row[0] + place.u + place.beyond;
}

/* A polynomial and its derivatives (Horner). */
static path_jet polynomial(const double *c, int32_t count, double u) {
    double p = c[count - 1], first = 0, half = 0;
    for (int32_t i = count - 2; i >= 0; --i) {
        half = half * u + first;
        first = first * u + p;
        p = p * u + c[i];
    }
    path_jet jet = {p, first, 2 * half};
    return jet;
}

path_jet path_value(path_place place, path_quantity quantity) {
    path_jet jet = {0, 0, 0};
    if (quantity.count == 0) return jet;
    jet = polynomial(place.row + quantity.at, quantity.count, place.u);
    if (place.beyond != 0) jet.first = jet.second = 0;
    return jet;
}

/* As long as the line goes straight on, so does what is counted along it. */
static path_jet counted(path_place place, path_quantity quantity) {
    path_jet jet = polynomial(place.row + quantity.at, quantity.count, place.u);
    if (place.beyond != 0) {
        jet.value += jet.first * place.beyond;
        jet.second = 0;
    }
    return jet;
}

path_jet path_along(const path_lane *lane, path_place place) {
    return counted(place, lane->along);
}

path_jet path_height(const path_table *path, path_place place) {
    path_jet flat = {0, 0, 0};
    return path->height.count == 0 ? flat : counted(place, path->height);
}

double path_whole_length(const path_table *path, const path_lane *lane) {
    const double *row = row_of(path, path->pieces - 1);
    return polynomial(row + lane->along.at, lane->along.count, path->length - row[0]).value;
}

path_place path_find_along(const path_table *path, const path_lane *lane, double along, int32_t near) {
    double beyond = 0, whole = path_whole_length(path, lane);
    if (path->closed) {
        along = around(along, whole);
    } else if (!(along >= 0 && along <= whole)) {
        double end = along < 0 ? 0 : whole;
        beyond = along - end;
        along = end;
    }
    int32_t piece = piece_at(path, lane->along.at, along, near), last = path->pieces - 1;
    const double *row = row_of(path, piece), *c = row + lane->along.at;
    double length = (piece == last ? path->length : row_of(path, piece + 1)[0]) - row[0];
    double u = fmin(fmax((along - c[0]) / c[1], 0), length), slope = c[1];
    if (lane->along.count > 2) {
        /* Monotonous and almost straight within a piece: Newton's steps get smaller at once. */
        for (int32_t i = 0; i < 20; ++i) {
            path_jet jet = polynomial(c, lane->along.count, u);
            double step = (along - jet.value) / jet.first;
            slope = jet.first;
            u = fmin(fmax(u + step, 0), length);
            if (fabs(step) < 1e-5) break; /* what is left is of the size of its square */
        }
    }
    path_place place = {row, u, beyond / slope, piece};
    return place;
}

/* A quintic with two derivatives, each by itself: a processor computes them side by side. */
static inline void quintic(const double *c, double u, double value[3]) {
    value[0] = c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5]))));
    value[1] = c[1] + u * (2 * c[2] + u * (3 * c[3] + u * (4 * c[4] + u * (5 * c[5]))));
    value[2] = 2 * c[2] + u * (6 * c[3] + u * (12 * c[4] + u * (20 * c[5])));
}

static inline path_course course_at(path_place place) {
    path_course course;
    quintic(place.row + 1, place.u, course.x);
    quintic(place.row + 7, place.u, course.y);
    if (place.beyond != 0) {
        course.x[0] += course.x[1] * place.beyond;
        course.y[0] += course.y[1] * place.beyond;
        course.x[2] = course.y[2] = 0;
    }
    return course;
}

path_course path_course_at(path_place place) {
    return course_at(place);
}

path_line path_line_at(path_place place) {
    path_course course = course_at(place);
    const double *x = course.x, *y = course.y;
    double square = x[1] * x[1] + y[1] * y[1], stretch = sqrt(square), per = 1 / stretch;
    path_line line = {
        .x = x[0],
        .y = y[0],
        .tx = x[1] * per,
        .ty = y[1] * per,
        .stretch = stretch,
        .stretch_first = (x[1] * x[2] + y[1] * y[2]) * per,
        .curvature = (x[1] * y[2] - y[1] * x[2]) * per * per * per,
        .place = place,
    };
    return line;
}

/* Derivative of the curvature by the station. */
static double bending(const path_line *line) {
    const double *a = line->place.row + 1, *b = line->place.row + 7;
    double u = line->place.u, per = 1 / line->stretch;
    if (line->place.beyond != 0) return 0;
    double x3 = 6 * a[3] + u * (24 * a[4] + u * 60 * a[5]), y3 = 6 * b[3] + u * (24 * b[4] + u * 60 * b[5]);
    return per * per * (line->tx * y3 - line->ty * x3) - 3 * line->curvature * line->stretch_first * per;
}

path_beside path_beside_at(const path_line *line, path_jet t) {
    double near = 1 - line->curvature * t.value, ahead = line->stretch * near;
    path_beside beside = {
        .x = line->x - line->ty * t.value,
        .y = line->y + line->tx * t.value,
        .ahead = ahead,
        .aside = t.first,
        .length = fabs(ahead),
        .curvature = line->curvature / near,
    };
    if (t.first == 0 && t.second == 0) return beside;
    double ahead_first = line->stretch_first * near -
                         line->stretch * (bending(line) * t.value + line->curvature * t.first);
    double turning = line->curvature * line->stretch; /* of the reference line, per station */
    double square = ahead * ahead + t.first * t.first;
    beside.length = sqrt(square);
    beside.curvature = (ahead * (t.second + ahead * turning) - t.first * (ahead_first - t.first * turning)) /
                       (square * beside.length);
    return beside;
}

const path_lane *path_find_lane(const path_table *path, int32_t number) {
    for (int32_t i = 0; i < path->lane_count; ++i) {
        if (path->lanes[i].number == number) return &path->lanes[i];
    }
    return NULL;
}
