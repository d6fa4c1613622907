/* A wheel with its spin and the deflection of its tyre, one implicit stage at a time.
 *
 *   I w' = T - R Fx - hold dir(w)            hold: brake and rolling resistance, friction that sticks at w = 0
 *   S_x slip' = (R w - u) - |u| slip         (Pacejka 2012, 7.2)
 *   S_y side' = -v - |u| side
 * S are relaxation lengths over sqrt(1 + rho^2), rho the slips relative to those where the tyre would slide: the
 * deflection, S slip, is proportional to its force. At standstill these are springs, so a car stays on a slope. Below
 * 2.5 m/s they are damped (8.3.3), with 0.7 of the critical damping of all of the load on such tyres.
 *
 * A stage of an SDIRK method requires y = base + gh f(y). Slips are linear in the spin, the force is linearized
 * (Newton), and the friction that sticks is solved exactly: a wheel locks and stays locked without chatter.
 */
#ifndef CHASSIS_WHEEL_H
#define CHASSIS_WHEEL_H

#include "tyre.h"

typedef struct {
    double spin, slip, side;
} wheel;

typedef struct {
    tyre_state tyre;
    double load, gh;
    double slip, slip_by_spin; /* slip that makes the force = slip + slip_by_spin spin */
    double side;
    double held, held_by_spin; /* slip without damping, likewise */
    wheel base, guess;
    double before; /* spin at the beginning of the step: the direction in which friction acts */
    double drive, brake;
} wheel_stage;

typedef struct {
    wheel end;
    double x, y;      /* forces along and across the wheel */
    double yields;                  /* spin per torque */
    double x_by_spin, slip_by_spin; /* force and slip per spin */
} wheel_result;

/* The slips of a stage, from the speeds of the hub *along* and *across*. Needs tyre, gh, base, guess. */
void wheel_touch(wheel_stage *s, const tyre *t, double along, double across);

/* Solves it. Needs the rest. */
wheel_result wheel_turn(const wheel_stage *s, const tyre *t);

/* A clutch between two wheels of an axle moves torque, up to a limit, from the faster to the slower one. */
void wheel_lock(wheel_result *left, wheel_result *right, double limit);

wheel wheel_after(const wheel *from, const wheel *rate, double time);
wheel wheel_rate(const wheel *from, const wheel *to, double time);

#endif
