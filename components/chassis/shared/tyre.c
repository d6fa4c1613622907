#include "tyre.h"

#include <math.h>

tyre_state tyre_under(const tyre *t, double load, double ground_friction) {
    tyre_state s = {t->slip_stiffness, t->side_stiffness, t->friction * ground_friction, t->friction * ground_friction};
    if (t->law != TYRE_MAGIC) return s;
    double share = load / t->nominal_load, more = share > 3 ? 2 : share - 1; /* what was measured ends far below 3 */
    double peak = share / t->side_stiffness_peak;
    s.slip_stiffness = (t->slip_stiffness + t->slip_stiffness_load * more) * exp(t->slip_stiffness_exponent * more);
    s.side_stiffness = 2 * t->side_stiffness / (t->side_stiffness_peak * (1 + peak * peak));
    s.friction *= t->along.friction + t->along.friction_load * more;
    s.side_friction *= t->across.friction + t->across.friction_load * more;
    return s;
}

/* b x - e (b x - atan(b x)) */
static double bent(double x, double curvature) {
    return x - curvature * (x - atan(x));
}

static double reduced(const tyre_magic *m, double by, double other) {
    double b = m->reduction / sqrt(1 + m->reduction_slope * m->reduction_slope * other * other);
    return cos(m->reduction_shape * atan(bent(b * by, m->reduction_curvature)));
}

static tyre_grip magic(const tyre *t, const tyre_state *s, double slip, double side) {
    double angle = atan(side);
    double b = s->slip_stiffness / (t->along.shape * s->friction), x = b * slip, e = t->along.curvature;
    double inner = bent(x, e), argument = t->along.shape * atan(inner), left_x = reduced(&t->along, angle, slip);
    double steep = s->slip_stiffness * (1 - e + e / (1 + x * x)) / (1 + inner * inner);
    double y = s->side_stiffness / (t->across.shape * s->side_friction) * angle;
    double pure_y = s->side_friction * sin(t->across.shape * atan(bent(y, t->across.curvature)));
    tyre_grip grip = {
        .x = s->friction * sin(argument) * left_x,
        .y = pure_y * reduced(&t->across, slip, angle),
        .x_by_slip = steep * cos(argument) * left_x,
    };
    return grip;
}

tyre_grip tyre_grip_at(const tyre *t, const tyre_state *s, double slip, double side) {
    if (t->law == TYRE_MAGIC) return magic(t, s, slip, side);
    double x = s->slip_stiffness * slip, y = s->side_stiffness * side;
    tyre_grip grip = {x, y, s->slip_stiffness};
    if (t->law == TYRE_LIMITED) {
        double per_friction = 1 / s->friction, a = x * per_friction, b = y * per_friction;
        double root = 1 / sqrt(1 + a * a + b * b);
        grip.x *= root;
        grip.y *= root;
        grip.x_by_slip *= root * (1 - a * a * root * root);
    }
    return grip;
}
