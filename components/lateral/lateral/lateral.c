#include "lateral.h"

#include <math.h>

double lateral_clamp(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

double lateral_steering(double wanted, double last, double max_angle, double max_rate) {
    double turn = max_rate * LATERAL_STEP;
    return lateral_clamp(lateral_clamp(wanted, -max_angle, max_angle), last - turn, last + turn);
}

/* A point of the path, in the car's axes. The first is beside the car, the others are those of the preview. */
typedef struct {
    double distance, x, y, heading, curvature;
} knot;

static knot knot_at(const lateral_in *in, int index) {
    if (index > 0) {
        int i = index - 1;
        knot ahead = {
            in->preview[i].distance, in->preview[i].x, in->preview[i].y, in->preview[i].heading, in->preview[i].curvature,
        };
        return ahead;
    }
    double turn = in->lane.heading, offset = in->lane.offset;
    knot beside = {0, -offset * sin(turn), -offset * cos(turn), -turn, in->lane.curvature};
    return beside;
}

/* Number of points of the preview: each is farther ahead than the one before. */
static int count(const lateral_in *in) {
    int n = 0;
    for (double last = 0; n < LATERAL_POINTS && in->preview[n].distance > last; ++n) last = in->preview[n].distance;
    return n;
}

/* Advances *from* to the last knot before *distance*. */
static int knot_before(const lateral_in *in, double distance, int *from) {
    int last = count(in);
    while (*from < last && in->preview[*from].distance <= distance) ++*from;
    return *from;
}

double lateral_curvature(const lateral_in *in, double distance, int *from) {
    int index = knot_before(in, distance, from);
    knot before = knot_at(in, index);
    if (index == count(in)) return before.curvature;
    knot next = knot_at(in, index + 1);
    double part = (distance - before.distance) / (next.distance - before.distance);
    return before.curvature + part * (next.curvature - before.curvature);
}

/* Cubic of Hermite between two knots: coefficients of u, u from 0 to 1. */
typedef struct {
    double x[4], y[4];
} segment;

static segment segment_between(const knot *from, const knot *to) {
    double length = to->distance - from->distance, x = to->x - from->x, y = to->y - from->y;
    double vx = length * cos(from->heading), vy = length * sin(from->heading);
    double wx = length * cos(to->heading), wy = length * sin(to->heading);
    segment found = {
        {from->x, vx, 3 * x - 2 * vx - wx, vx + wx - 2 * x},
        {from->y, vy, 3 * y - 2 * vy - wy, vy + wy - 2 * y},
    };
    return found;
}

static lateral_point point_at(const segment *s, double u) {
    lateral_point point = {
        s->x[0] + u * (s->x[1] + u * (s->x[2] + u * s->x[3])),
        s->y[0] + u * (s->y[1] + u * (s->y[2] + u * s->y[3])),
    };
    return point;
}

lateral_point lateral_path(const lateral_in *in, double distance, int *from) {
    int index = knot_before(in, distance, from);
    knot before = knot_at(in, index);
    if (index == count(in)) {
        double on = distance - before.distance;
        lateral_point point = {before.x + on * cos(before.heading), before.y + on * sin(before.heading)};
        return point;
    }
    knot next = knot_at(in, index + 1);
    segment s = segment_between(&before, &next);
    return point_at(&s, (distance - before.distance) / (next.distance - before.distance));
}

static bool is_inside(lateral_point point, double behind, double radius) {
    double x = point.x + behind;
    return x * x + point.y * point.y <= radius * radius;
}

lateral_point lateral_path_on_circle(const lateral_in *in, double behind, double radius) {
    int last = count(in), index = 0;
    knot before, next = knot_at(in, 0);
    lateral_point point = {next.x, next.y};
    if (!is_inside(point, behind, radius)) return point;
    while (is_inside(point, behind, radius)) {
        if (index == last) { /* straight continuation of the last one: |point + u direction| = radius */
            double cosine = cos(next.heading), sine = sin(next.heading), x = point.x + behind;
            double along = x * cosine + point.y * sine, across = x * sine - point.y * cosine;
            double on = sqrt(fmax(radius * radius - across * across, 0)) - along;
            lateral_point end = {point.x + on * cosine, point.y + on * sine};
            return end;
        }
        before = next;
        next = knot_at(in, ++index);
        point.x = next.x;
        point.y = next.y;
    }
    segment s = segment_between(&before, &next);
    double low = 0, high = 1;
    for (int halving = 0; halving < 50; ++halving) { /* to the last digits of a double */
        double middle = 0.5 * (low + high);
        if (is_inside(point_at(&s, middle), behind, radius)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return point_at(&s, low);
}

/* How far a point of the path is ahead of the car's point, along *direction* there. */
static double beyond(lateral_point point, lateral_point direction, double ahead) {
    return (point.x - ahead) * direction.x + point.y * direction.y;
}

static lateral_point direction_at(const segment *s, double u) {
    lateral_point direction = {
        s->x[1] + u * (2 * s->x[2] + u * 3 * s->x[3]),
        s->y[1] + u * (2 * s->y[2] + u * 3 * s->y[3]),
    };
    return direction;
}

lateral_place lateral_place_of(const lateral_in *in, double ahead) {
    int last = count(in), index = 0;
    knot before = knot_at(in, 0), next = before;
    lateral_point point = {before.x, before.y}, direction = {cos(before.heading), sin(before.heading)};
    bool is_before = beyond(point, direction, ahead) < 0, is_between = false;
    while (is_before && !is_between && index < last) {
        before = next;
        next = knot_at(in, ++index);
        lateral_point end = {next.x, next.y}, there = {cos(next.heading), sin(next.heading)};
        is_between = beyond(end, there, ahead) >= 0;
        point = end;
        direction = there;
    }
    double distance = next.distance;
    if (is_between) {
        segment s = segment_between(&before, &next);
        double low = 0, high = 1;
        for (int halving = 0; halving < 50; ++halving) { /* to the last digits of a double */
            double middle = 0.5 * (low + high);
            if (beyond(point_at(&s, middle), direction_at(&s, middle), ahead) < 0) {
                low = middle;
            } else {
                high = middle;
            }
        }
        point = point_at(&s, low);
        direction = direction_at(&s, low);
        distance = before.distance + low * (next.distance - before.distance);
    }
    int from = 0;
    double size = hypot(direction.x, direction.y);
    lateral_place place = {
        -(direction.x * point.y + direction.y * (ahead - point.x)) / size,
        -atan2(direction.y, direction.x),
        lateral_curvature(in, distance, &from),
    };
    return place;
}
