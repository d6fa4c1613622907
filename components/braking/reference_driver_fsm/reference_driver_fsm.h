/* The fuzzy safety model of UN R157 (amendment of 2022): how hard a driver should brake early to avoid hard braking
 * (Mattas et al.: Fuzzy surrogate safety metrics for real-time assessment of rear-end collision risk, Accident Analysis
 * and Prevention 148, 105794, 2020; reference models of the Joint Research Centre, ec-jrc, JRC-FSM, 2021).
 *
 * With gap d, own speed u, that of the one ahead w and own acceleration a, two metrics from 0, safe, to 1, linear in d
 * between a safe and an unsafe gap:
 *   proactive, PFS   d - margin;  safe u r + u^2/(2 b) - w^2/(2 l) + safe_margin,  unsafe u r + u^2/(2 h) - w^2/(2 l)
 *   critical, CFS    with a' = max(a, -b), u' = u + r a' and s = (u + a' r/2 - w) r: safe s + (u' - w)^2/(2 b), unsafe
 *                    s + (u' - w)^2/(2 h); if u' < w, 1 below (u - w)^2/(2 |a|), else 0; 0 if u <= w
 * r = reaction_time, b = comfortable, h = hard, l = lead_deceleration. The driver brakes with CFS (h - b) + b if that
 * is critical, else with PFS b. An object beside the car counts if its side reaches the car's in less than (gap +
 * passing_length)/closing speed + passing_time. Of all objects the worst counts.
 *
 * Not a claim of conformity. */
#ifndef REFERENCE_DRIVER_FSM_H
#define REFERENCE_DRIVER_FSM_H

#include "../drivers/drivers.h"

typedef struct {
    double comfortable_deceleration, hard_deceleration, lead_deceleration, margin, safe_margin;
    double passing_length, passing_time;
    double reaction_time, release_deceleration, jerk, max_deceleration, release_time, holding_time;
    double front_length, width, nominal_mass, wheel_radius;
} reference_driver_fsm_par;

typedef struct {
    emergency_in in;
    emergency_out out;
    reference_driver_fsm_par par;
    driver_foot foot;
} reference_driver_fsm;

void reference_driver_fsm_init(reference_driver_fsm *self);
void reference_driver_fsm_step(reference_driver_fsm *self);

#endif
