/* Electric machine behind an inverter and a fixed gear, seen from the wheels of its axle.
 *
 * Its torque follows the demand with a lag, below T <= k I (current of the inverter), P <= P_max min(1, U / U_rated), and
 * P <= sqrt(3/2) U I cos(phi): a phase of a star has at most U / sqrt(6) (space-vector modulation; Schroeder, Elektrische
 * Antriebe - Regelung von Antriebssystemen). Losses are kc T^2 + ki w + kw w^3 + C (Larminie, Lowry: Electric Vehicle
 * Technology Explained, 7.1.5), to which the inverter adds a standby power and a share of what passes through it.
 */
#ifndef TRACTION_MACHINE_H
#define TRACTION_MACHINE_H

typedef struct {
    struct {
        double torque_demand, wheel_speed, voltage;
        struct {
            double ratio, efficiency, mass;
        } gear;
        struct {
            double max_current, standby_power, loss, mass;
        } inverter;
    } in;
    struct {
        struct {
            double torque, regeneration, electric_power, inertia, mass;
        } unit;
    } out;
    struct {
        double mass, rotor_inertia;
        double max_torque, max_power, rated_voltage, max_speed;
        double torque_per_current; /* N.m/A, effective value per phase */
        double power_factor, lag;
        double copper, iron, windage, idle; /* kc, ki, kw, C */
    } par;
    double torque; /* of the machine */
} traction_machine;

void traction_machine_init(traction_machine *self);
void traction_machine_step(traction_machine *self, double h);

#endif
