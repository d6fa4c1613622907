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

/* Whether the preview has no more than *points* points: each is farther ahead than the one before. */
static bool ends_after(const lateral_in *in, int points) {
    double last = points > 0 ? in->preview[points - 1].distance : 0;
    return points == LATERAL_POINTS || !(in->preview[points].distance > last);
}

double lateral_curvature(const lateral_in *in, double distance, int *from) {
    while (!ends_after(in, *from) && in->preview[*from].distance <= distance) ++*from;
    knot before = knot_at(in, *from);
    if (ends_after(in, *from)) return before.curvature;
    knot next = knot_at(in, *from + 1);
    double part = (distance - before.distance) / (next.distance - before.distance);
    return before.curvature + part * (next.curvature - before.curvature);
}

/* Of Hermite, between two knots with their directions. */
static lateral_cubic cubic_between(const knot *from, lateral_point out, const knot *to, lateral_point in) {
    double length = to->distance - from->distance, x = to->x - from->x, y = to->y - from->y;
    double vx = length * out.x, vy = length * out.y;
    double wx = length * in.x, wy = length * in.y;
    lateral_cubic found = {
        {from->x, vx, 3 * x - 2 * vx - wx, vx + wx - 2 * x},
        {from->y, vy, 3 * y - 2 * vy - wy, vy + wy - 2 * y},
    };
    return found;
}

static lateral_point direction_of(const knot *at) {
    lateral_point direction = {cos(at->heading), sin(at->heading)};
    return direction;
}

static lateral_point point_at(const lateral_cubic *s, double u) {
    lateral_point point = {
        s->x[0] + u * (s->x[1] + u * (s->x[2] + u * s->x[3])),
        s->y[0] + u * (s->y[1] + u * (s->y[2] + u * s->y[3])),
    };
    return point;
}

lateral_line lateral_line_of(const lateral_in *in) {
    lateral_line line = {.pieces = 0};
    knot at = knot_at(in, 0);
    line.direction = direction_of(&at);
    while (!ends_after(in, line.pieces)) {
        knot next = knot_at(in, line.pieces + 1);
        lateral_point there = direction_of(&next);
        line.cubic[line.pieces++] = cubic_between(&at, line.direction, &next, there);
        line.distance[line.pieces] = next.distance;
        line.direction = there;
        at = next;
    }
    line.end.x = at.x;
    line.end.y = at.y;
    return line;
}

lateral_point lateral_path(const lateral_line *line, double distance, int *from) {
    while (*from < line->pieces && line->distance[*from + 1] <= distance) ++*from;
    double on = distance - line->distance[*from];
    if (*from == line->pieces) {
        lateral_point point = {line->end.x + on * line->direction.x, line->end.y + on * line->direction.y};
        return point;
    }
    return point_at(&line->cubic[*from], on / (line->distance[*from + 1] - line->distance[*from]));
}

static bool is_inside(lateral_point point, double behind, double radius) {
    double x = point.x + behind;
    return x * x + point.y * point.y <= radius * radius;
}

lateral_point lateral_path_on_circle(const lateral_in *in, double behind, double radius) {
    int index = 0;
    knot before, next = knot_at(in, 0);
    lateral_point point = {next.x, next.y};
    if (!is_inside(point, behind, radius)) return point;
    while (is_inside(point, behind, radius)) {
        if (ends_after(in, index)) { /* straight continuation of the last one: |point + u direction| = radius */
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
    lateral_cubic s = cubic_between(&before, direction_of(&before), &next, direction_of(&next));
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

static lateral_point direction_at(const lateral_cubic *s, double u) {
    lateral_point direction = {
        s->x[1] + u * (2 * s->x[2] + u * 3 * s->x[3]),
        s->y[1] + u * (2 * s->y[2] + u * 3 * s->y[3]),
    };
    return direction;
}

lateral_place lateral_place_of(const lateral_in *in, double ahead) {
    int index = 0;
    knot before = knot_at(in, 0), next = before;
    lateral_point point = {before.x, before.y}, direction = direction_of(&before);
    bool is_before = beyond(point, direction, ahead) < 0, is_between = false;
    while (is_before && !is_between && !ends_after(in, index)) {
        before = next;
        next = knot_at(in, ++index);
        lateral_point end = {next.x, next.y}, there = direction_of(&next);
        is_between = beyond(end, there, ahead) >= 0;
        point = end;
        direction = there;
    }
    double distance = next.distance;
    if (is_between) {
        lateral_cubic s = cubic_between(&before, direction_of(&before), &next, direction_of(&next));
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
