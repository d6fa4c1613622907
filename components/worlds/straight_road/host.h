/* Longitudinal motion of a car on two axles: spin, slip, load transfer, drag, grade, rolling resistance, brakes.
 *
 * State (v, w_front, w_rear):
 *   m v'   = X - 1/2 rho cdA (v - wind)|v - wind| - m g sin(slope),   X = Fx_front + Fx_rear
 *   I_i w_i' = T_i - (B_i + crr R Fz_i) dir(w_i) - R Fx_i
 *   Fx_i   = Fz_i mu_i sat(c k_i / mu_i),  k_i = (R w_i - v) / sqrt(v^2 + vs^2)
 *   Fz_front = W_front - X h/L,  Fz_rear = W_rear + X h/L  (moments about the centre of gravity, drag acting there)
 * with sat(x) = x / sqrt(1 + x^2) and dir(w) = sat(w / ws): brakes and rolling resistance hold a car at rest, with a
 * creep far below 1 mm/s, and without discontinuities.
 */
#ifndef HOST_H
#define HOST_H

typedef struct {
    double mass, front_load_share, cg_height, wheelbase;
    double wheel_radius, inertia_front, inertia_rear;
    double drag_area, air_density, rolling_resistance, grade;
    double wind; /* along the car, from behind */
    double friction_front, friction_rear, slip_stiffness;
    double drive_front, drive_rear, brake_front, brake_rear;
} host_data;

typedef struct {
    double position, speed, spin_front, spin_rear;
    double slope[3]; /* time derivatives of speed and spins at the end of the last step */
} host_state;

/* Initial state: rolling freely at the speed. */
void host_start(host_state *state, const host_data *data, double speed);

/* Advance by h in equal substeps, torques held. Second order, L-stable, deterministic. */
void host_advance(host_state *state, const host_data *data, double h, int substeps);

#endif
