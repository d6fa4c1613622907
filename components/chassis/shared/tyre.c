#include "tyre.h"

#include <math.h>

static double positive(double value) {
    return value > 0.01 ? value : 0.01;
}

tyre_state tyre_under(const tyre *t, double load, double ground_friction) {
    tyre_state s = {t->slip_stiffness, t->side_stiffness, t->friction * ground_friction, t->friction * ground_friction};
    if (t->law != TYRE_MAGIC) return s;
    double share = load / t->nominal_load, more = share > 3 ? 2 : share - 1; /* measurements end far below 3 */
    double peak = share / t->side_stiffness_peak;
    s.slip_stiffness = positive(t->slip_stiffness + t->slip_stiffness_load * more) * exp(t->slip_stiffness_exponent * more);
    s.side_stiffness = 2 * t->side_stiffness / (t->side_stiffness_peak * (1 + peak * peak));
    s.friction *= positive(t->along.friction + t->along.friction_load * more);
    s.side_friction *= positive(t->across.friction + t->across.friction_load * more);
    return s;
}

/* The argument of the formulas' sine and cosine: c atan(x - e (x - atan(x))), and its derivative. */
static double bent(double x, double shape, double curvature, double *by) {
    double inner = x - curvature * (x - atan(x));
    *by = shape * (1 - curvature + curvature / (1 + x * x)) / (1 + inner * inner);
    return shape * atan(inner);
}

static tyre_grip magic(const tyre *t, const tyre_state *s, double slip, double side) {
    const tyre_magic *a = &t->along, *b = &t->across;
    double angle = atan(side), by_x, by_y, by_angle, by_slip;
    double steep_x = s->slip_stiffness / (a->shape * s->friction), steep_y = s->side_stiffness / (b->shape * s->side_friction);
    double bent_slip = a->reduction_slope * slip, root = 1 / sqrt(1 + bent_slip * bent_slip), steep_angle = a->reduction * root;
    double less_steep = -steep_angle * root * root * a->reduction_slope * bent_slip; /* by slip */
    double steep_slip = b->reduction / sqrt(1 + b->reduction_slope * b->reduction_slope * angle * angle);
    double x = bent(steep_x * slip, a->shape, a->curvature, &by_x), y = bent(steep_y * angle, b->shape, b->curvature, &by_y);
    double less_x = bent(steep_angle * angle, a->reduction_shape, a->reduction_curvature, &by_angle);
    double less_y = bent(steep_slip * slip, b->reduction_shape, b->reduction_curvature, &by_slip);
    double pure_x = s->friction * sin(x), pure_y = s->side_friction * sin(y);
    tyre_grip grip = {
        .x = pure_x * cos(less_x),
        .y = pure_y * cos(less_y),
        .x_by_slip = s->friction * cos(x) * by_x * steep_x * cos(less_x) - pure_x * sin(less_x) * by_angle * angle * less_steep,
        .y_by_slip = -pure_y * sin(less_y) * by_slip * steep_slip,
    };
    return grip;
}

tyre_grip tyre_grip_at(const tyre *t, const tyre_state *s, double slip, double side) {
    if (t->law == TYRE_MAGIC) return magic(t, s, slip, side);
    double x = s->slip_stiffness * slip, y = s->side_stiffness * side;
    tyre_grip grip = {x, y, s->slip_stiffness, 0};
    if (t->law == TYRE_LIMITED) {
        double per_friction = 1 / s->friction, a = x * per_friction, b = y * per_friction;
        double root = 1 / sqrt(1 + a * a + b * b);
        grip.x *= root;
        grip.y *= root;
        grip.x_by_slip *= root * (1 - a * a * root * root);
        grip.y_by_slip = -grip.y * a * s->slip_stiffness * per_friction * root * root;
    }
    return grip;
}
