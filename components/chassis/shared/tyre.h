/* Tyre forces per load over slip: stiffness alone, stiffness and friction, or the Magic Formula with combined slip.
 *
 * slip = (R w - u) / |u|, side = -v / |u| = -tan(alpha), u and v the speeds of the wheel along and across itself.
 * Both forces have the sign of their slip.
 *
 * LINEAR   x = c_x slip, y = c_y side
 * LIMITED  the same over sqrt(1 + rho^2), rho^2 = (c_x slip / mu)^2 + (c_y side / mu)^2
 * MAGIC    H. B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), 4.3.2, as of PAC2002 without camber, shifts and
 * ply steer: asymmetric terms differ between left and right tyres of one make. With dfz = Fz / Fz0 - 1
 *   Fx0 = D sin(C atan(B k - E (B k - atan(B k)))), D = lambda (PDX1 + PDX2 dfz) Fz,
 *         B C D = Fz (PKX1 + PKX2 dfz) exp(PKX3 dfz), C = PCX1, E = PEX1
 *   Fy0 likewise of alpha, B C D = PKY1 Fz0 sin(2 atan(Fz / (PKY2 Fz0)))
 *   Fx  = Fx0 cos(C atan(B a - E (B a - atan(B a)))), B = RBX1 cos(atan(RBX2 k)), C = RCX1, E = REX1
 *   Fy  = Fy0 likewise of k, B = RBY1 cos(atan(RBY2 a))
 */
#ifndef CHASSIS_TYRE_H
#define CHASSIS_TYRE_H

typedef enum { TYRE_LINEAR, TYRE_LIMITED, TYRE_MAGIC } tyre_law;

typedef struct {
    double shape, friction, friction_load, curvature;
    double reduction, reduction_slope, reduction_shape, reduction_curvature; /* by the other slip */
} tyre_magic;

typedef struct {
    tyre_law law;
    double radius, inertia, rolling_resistance;
    double slip_stiffness, side_stiffness, friction; /* of LINEAR and LIMITED, per load */
    double slip_relaxation, side_relaxation;         /* lengths, m */
    double nominal_load;                             /* MAGIC uses the rest */
    tyre_magic along, across;
    double slip_stiffness_load, slip_stiffness_exponent, side_stiffness_peak; /* PKX2, PKX3, PKY2; stiffness: PKX1, PKY1 */
} tyre;

/* A tyre under a load on a ground: stiffness and friction, both per load. */
typedef struct {
    double slip_stiffness, side_stiffness, friction, side_friction;
} tyre_state;

/* Forces per load, and their derivatives by slip. */
typedef struct {
    double x, y, x_by_slip, y_by_slip;
} tyre_grip;

tyre_state tyre_under(const tyre *t, double load, double ground_friction);
tyre_grip tyre_grip_at(const tyre *t, const tyre_state *s, double slip, double side);

#endif
