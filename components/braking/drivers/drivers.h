/* Shared by reference drivers: the driver releases the accelerator, reacts after a delay, and brakes.
 *
 * An alarm starts a clock. Until *reaction_time* is over the car only coasts with release_deceleration. Then it brakes
 * with the wanted deceleration, built up with *jerk*, released at once. The alarm ends without a cause for release_time
 * (holding_time at standstill after braking). UN R157, annex 4, appendix 3: 0.75 s between perception and braking,
 * 0.774 g after 0.6 s, i.e. 12.65 m/s3; coasting with 0.4 m/s2 as in the reference models of the Joint Research Centre
 * (ec-jrc, JRC-FSM, 2021).
 */
#ifndef DRIVERS_H
#define DRIVERS_H

#include "../emergency/emergency.h"

typedef struct {
    double reaction_time, release_deceleration, jerk, release_time, holding_time;
    double nominal_mass, wheel_radius;
} driver_habits;

typedef struct {
    int32_t alarmed; /* samples since the alarm; 0: there is none */
    int32_t calm;    /* samples without a cause */
} driver_foot;

/* After the reaction time. */
bool driver_brakes(const driver_foot *foot, const driver_habits *habits);

/* One sample: *has_cause* starts or keeps the alarm; *wanted* and its *stage* apply when the driver brakes. */
void driver_act(driver_foot *foot, const driver_habits *habits, bool has_cause, double wanted, int32_t stage,
                const emergency_in *in, emergency_out *out);

int32_t driver_samples(double time);

#endif
