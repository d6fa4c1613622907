#include "wheel.h"

#include <math.h>

#define LOW_SPEED 2.5   /* m/s: below it slips are damped */
#define DAMPING 1.4     /* twice the damping ratio */
#define GRAVITY 9.81
#define MOST_SLIP 3.0   /* of both together, far beyond sliding: only their direction matters there */
#define NO_LENGTH 1e-30 /* so that a tyre without relaxation is possible at standstill */

static void keep_within(wheel *w) {
    double square = w->slip * w->slip + w->side * w->side;
    if (!(square > MOST_SLIP * MOST_SLIP)) return;
    double factor = MOST_SLIP / sqrt(square);
    w->slip *= factor;
    w->side *= factor;
}

/* Slip per speed: c g slip / S acts as a spring; c g / S is the square of its frequency. */
static double damping(double speed, double stiffness, double relaxation) {
    double part = speed / LOW_SPEED, fades = (1 - part * part) * (1 - part * part);
    return DAMPING * fades / sqrt(stiffness * GRAVITY * relaxation + 1);
}

void wheel_touch(wheel_stage *s, const tyre *t, double along, double across) {
    double speed = fabs(along), slip_length = t->slip_relaxation, side_length = t->side_relaxation;
    if (t->law != TYRE_LINEAR) {
        double a = s->tyre.slip_stiffness * s->guess.slip / s->tyre.friction;
        double b = s->tyre.side_stiffness * s->guess.side / s->tyre.side_friction;
        double shorter = 1 / sqrt(1 + a * a + b * b);
        slip_length *= shorter;
        side_length *= shorter;
    }
    double per = 1 / (slip_length + s->gh * speed + NO_LENGTH);
    s->held = (slip_length * s->base.slip - s->gh * along) * per;
    s->held_by_spin = t->radius * s->gh * per;
    double held_side = (side_length * s->base.side - s->gh * across) / (side_length + s->gh * speed + NO_LENGTH);
    s->side = held_side;
    s->slip = s->held;
    s->slip_by_spin = s->held_by_spin;
    s->guess.side = s->side; /* the end of the stage, without damping */
    if (speed < LOW_SPEED) {
        double slip_damping = damping(speed, s->tyre.slip_stiffness, t->slip_relaxation);
        s->slip -= slip_damping * along;
        s->slip_by_spin += slip_damping * t->radius;
        s->side -= damping(speed, s->tyre.side_stiffness, t->side_relaxation) * across;
    }
}

/* The spin under a force *flat* + *steep* spin; at 0 the wheel sticks as long as friction can hold it. */
static double turned(const wheel_stage *s, const tyre *t, double flat, double steep, double *yields) {
    double inertia = t->inertia / s->gh, stiff = inertia + t->radius * steep;
    double hold = s->brake + t->rolling_resistance * t->radius * s->load;
    double torque = s->drive - t->radius * flat, free = inertia * s->base.spin + torque;
    double way = s->before != 0 ? s->before : torque, friction = way < 0 ? -hold : hold;
    *yields = 1 / stiff;
    if (s->before != 0 ? (free - friction) * way > 0 : fabs(torque) > hold) return (free - friction) / stiff;
    /* The wheel is at rest, or stops, unless the driving torque exceeds friction. */
    if (fabs(torque) > hold && (free + friction) * way < 0) return (free + friction) / stiff;
    *yields = 0;
    return 0;
}

wheel_result wheel_turn(const wheel_stage *s, const tyre *t) {
    wheel_result result;
    double slip = s->slip + s->slip_by_spin * s->guess.spin;
    for (int iteration = 0;; ++iteration) {
        tyre_grip grip = tyre_grip_at(t, &s->tyre, slip, s->side);
        double steep = s->load * grip.x_by_slip;
        /* Beyond its peak a tyre accelerates its wheel; where that exceeds the inertia, the tangent is not used. */
        if (2 * t->radius * steep * s->slip_by_spin < -t->inertia / s->gh) steep = 0;
        result.x_by_spin = steep * s->slip_by_spin;
        double flat = s->load * grip.x + steep * (s->slip - slip);
        result.end.spin = turned(s, t, flat, result.x_by_spin, &result.yields);
        double moved = s->slip + s->slip_by_spin * result.end.spin - slip;
        result.x = s->load * grip.x + steep * moved;
        result.y = s->load * (grip.y + grip.y_by_slip * moved);
        slip += moved;
        /* The error of the tangent is the square of this. NaN also ends here. */
        if (!(fabs(moved) * s->tyre.slip_stiffness > 1e-3 * s->tyre.friction) || iteration == 7) break;
    }
    result.end.slip = s->held + s->held_by_spin * result.end.spin;
    result.end.side = s->guess.side;
    keep_within(&result.end);
    result.slip_by_spin = s->held_by_spin;
    return result;
}

static void twist(wheel_result *w, double torque) {
    double moved = w->yields * torque;
    w->end.spin += moved;
    w->end.slip += w->slip_by_spin * moved;
    keep_within(&w->end);
    w->x += w->x_by_spin * moved;
}

void wheel_lock(wheel_result *left, wheel_result *right, double limit) {
    double yields = left->yields + right->yields;
    if (yields == 0 || limit <= 0) return;
    double moved = (left->end.spin - right->end.spin) / yields;
    moved = moved < -limit ? -limit : moved > limit ? limit : moved;
    twist(left, -moved);
    twist(right, moved);
}

wheel wheel_after(const wheel *from, const wheel *rate, double time) {
    wheel w = {from->spin + time * rate->spin, from->slip + time * rate->slip, from->side + time * rate->side};
    return w;
}

wheel wheel_rate(const wheel *from, const wheel *to, double time) {
    double per = 1 / time;
    wheel w = {(to->spin - from->spin) * per, (to->slip - from->slip) * per, (to->side - from->side) * per};
    return w;
}
