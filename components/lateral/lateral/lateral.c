#include "lateral.h"

#include <math.h>

double lateral_clamp(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

double lateral_steering(double wanted, double last, double max_angle, double max_rate) {
    double turn = max_rate * LATERAL_STEP;
    return lateral_clamp(lateral_clamp(wanted, -max_angle, max_angle), last - turn, last + turn);
}

/* Moves on to the first point beyond *distance*. */
static int beyond(const lateral_in *in, double distance, int *from) {
    while (*from < LATERAL_POINTS && in->preview[*from].distance <= distance) ++*from;
    return *from;
}

double lateral_curvature(const lateral_in *in, double distance, int *from) {
    int next = beyond(in, distance, from);
    if (next == LATERAL_POINTS) return in->preview[LATERAL_POINTS - 1].curvature;
    double start = next > 0 ? in->preview[next - 1].distance : 0; /* where the car is, if no point is there */
    double before = next > 0 ? in->preview[next - 1].curvature : in->lane.curvature;
    double part = fmax(distance - start, 0) / (in->preview[next].distance - start);
    return before + part * (in->preview[next].curvature - before);
}

/* Cubic of Hermite between two points: coefficients of u, u from 0 to 1. */
typedef struct {
    double x[4], y[4];
} segment;

static segment segment_to(const lateral_in *in, int next) {
    int last = next - 1;
    double length = in->preview[next].distance - in->preview[last].distance;
    double from = in->preview[last].heading, to = in->preview[next].heading;
    double x = in->preview[next].x - in->preview[last].x, y = in->preview[next].y - in->preview[last].y;
    double vx = length * cos(from), vy = length * sin(from), wx = length * cos(to), wy = length * sin(to);
    segment found = {
        {in->preview[last].x, vx, 3 * x - 2 * vx - wx, vx + wx - 2 * x},
        {in->preview[last].y, vy, 3 * y - 2 * vy - wy, vy + wy - 2 * y},
    };
    return found;
}

static lateral_point at(const segment *s, double u) {
    lateral_point point = {
        s->x[0] + u * (s->x[1] + u * (s->x[2] + u * s->x[3])),
        s->y[0] + u * (s->y[1] + u * (s->y[2] + u * s->y[3])),
    };
    return point;
}

lateral_point lateral_path(const lateral_in *in, double distance, int *from) {
    int next = beyond(in, distance, from);
    if (next == 0 || next == LATERAL_POINTS) {
        int end = next == 0 ? 0 : LATERAL_POINTS - 1;
        double on = distance - in->preview[end].distance, heading = in->preview[end].heading;
        lateral_point point = {in->preview[end].x + on * cos(heading), in->preview[end].y + on * sin(heading)};
        return point;
    }
    segment s = segment_to(in, next);
    double start = in->preview[next - 1].distance;
    return at(&s, (distance - start) / (in->preview[next].distance - start));
}

static bool is_inside(lateral_point point, double behind, double radius) {
    double x = point.x + behind;
    return x * x + point.y * point.y <= radius * radius;
}

lateral_point lateral_path_on_circle(const lateral_in *in, double behind, double radius) {
    int next = 0;
    lateral_point point = {in->preview[0].x, in->preview[0].y};
    while (next < LATERAL_POINTS - 1 && is_inside(point, behind, radius)) {
        ++next;
        point.x = in->preview[next].x;
        point.y = in->preview[next].y;
    }
    if (next == 0 || is_inside(point, behind, radius)) return point;
    segment s = segment_to(in, next);
    double low = 0, high = 1;
    for (int halving = 0; halving < 50; ++halving) { /* to the last digits of a double */
        double middle = 0.5 * (low + high);
        if (is_inside(at(&s, middle), behind, radius)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return at(&s, low);
}
