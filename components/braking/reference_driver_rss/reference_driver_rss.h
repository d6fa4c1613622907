/* Responsibility-sensitive safety as a driver (Shalev-Shwartz, Shammah, Shashua: On a formal model of safe and scalable
 * self-driving cars, arXiv 1708.06374, 2017; with the parameters of the reference models for UN R157 by the Joint
 * Research Centre, ec-jrc, JRC-FSM, 2021).
 *
 * A situation is dangerous if the gap is below
 *   u r + p r^2/2 + (u + p r)^2/(2 b) - w^2/(2 l)                         own speed u, that of the one ahead w
 * and, beside, the room between both below
 *   margin + (2 c + q r) r/2 + (c + q r)^2/(2 q)                           lateral speed c of the other
 * r = reaction_time, p = max_acceleration, b = least_deceleration, l = lead_deceleration, q = lateral_acceleration. The
 * response is max_deceleration. An object that moves away counts as if it approached: the safe room ignores the sign.
 *
 * Not a claim of conformity. */
#ifndef REFERENCE_DRIVER_RSS_H
#define REFERENCE_DRIVER_RSS_H

#include "../drivers/drivers.h"

typedef struct {
    double max_acceleration, least_deceleration, lead_deceleration, lateral_acceleration, margin;
    double reaction_time, release_deceleration, jerk, max_deceleration, release_time, holding_time;
    double front_length, width, nominal_mass, wheel_radius;
} reference_driver_rss_par;

typedef struct {
    emergency_in in;
    emergency_out out;
    reference_driver_rss_par par;
    driver_foot foot;
} reference_driver_rss;

void reference_driver_rss_init(reference_driver_rss *self);
void reference_driver_rss_step(reference_driver_rss *self);

#endif
