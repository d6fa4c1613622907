/* Traction battery as an open-circuit voltage behind a resistance (Guzzella, Sciarretta: Vehicle Propulsion Systems, 4.5).
 *
 * P = U I with U = U0 - R I gives I = (U0 - sqrt(U0^2 - 4 R P)) / (2 R); soc' = -I / Q. The open-circuit voltage is
 * linear in the state of charge. Beyond U0^2 / (4 R) no current satisfies this: the greatest power is given.
 */
#ifndef TRACTION_PACK_H
#define TRACTION_PACK_H

typedef struct {
    double front, rear;
} traction_pack_axles;

typedef struct {
    struct {
        double drive_power, climate_power;
    } in;
    struct {
        struct {
            double voltage, discharge_limit, charge_limit;
        } supply;
        double soc, battery_power;
        traction_pack_axles load;
    } out;
    struct {
        double mass, front_share;
        double voltage, voltage_rise; /* V: half charged, and from empty to full */
        double capacity;              /* A.s */
        double resistance, initial_soc, max_discharge, max_charge, auxiliary_power;
    } par;
    double soc, current;
} traction_pack;

void traction_pack_init(traction_pack *self);
void traction_pack_step(traction_pack *self, double h);

#endif
