/* The careful and competent human driver of UN R157 (annex 4, appendix 3): a reference for emergency brakes and pilots.
 *
 * The driver sees a risk, evaluates it, and reacts if it is critical (drivers.h). The driver's lane is lane_width wide
 * about the car's path. Risks are
 *   cut-in        a vehicle from the next lane comes nearer than lane_width - wandering to the middle of the lane (its
 *                 centre is more than *wandering*, 0.375 m, off its lane's middle); evaluated after another
 *                 evaluation_distance (0.72 m: 0.4 s at 1.8 m/s) or after evaluation_time; critical at a time to
 *                 collision below critical_ttc (2 s)
 *   cut-out       the vehicle ahead moves away by more than *wandering*, and a slower one is ahead of it; evaluated
 *                 after evaluation_time (0.4 s); critical at a time headway below critical_headway (2 s)
 *   deceleration  the vehicle ahead brakes with more than lead_deceleration (5 m/s2); as above
 *   approach      the next one in the lane is slower; evaluated as above, critical below critical_ttc. The regulation
 *                 does not name it: its driver follows at a headway of 2 s
 * Slower is by more than least_closing. Pedestrians and cyclists keep to no lane: they are a risk as soon as they will
 * be in the path when the car arrives, evaluated after evaluation_time, critical below critical_ttc. The driver brakes
 * with max_deceleration until no object that caused the braking approaches.
 *
 * A track has no acceleration: that of the vehicle ahead is the derivative of its speed behind a first-order lag of
 * acceleration_lag. Left out: the regulation's second brake, an AEB of 0.85 g once both are fully in line, as in the
 * reference models of the Joint Research Centre. An engineering model, not a claim of conformity. */
#ifndef REFERENCE_DRIVER_CC_H
#define REFERENCE_DRIVER_CC_H

#include "../drivers/drivers.h"

enum { EVALUATION_DISTANCE, EVALUATION_TIME };

typedef struct {
    double lane_width, wandering, evaluation_distance, evaluation_time;
    int32_t cut_in_evaluation;
    double critical_ttc, critical_headway, lead_deceleration, acceleration_lag, least_closing;
    double reaction_time, release_deceleration, jerk, max_deceleration, release_time, holding_time;
    double front_length, width, nominal_mass, wheel_radius;
} reference_driver_cc_par;

/* State of an object. */
typedef struct {
    int32_t id;
    double speed, acceleration;
    bool was_beside, was_hidden, has_braked; /* in the next lane; behind another, or braked, until it is not slower */
    int32_t risk;                            /* samples of it */
} driver_memory;

typedef struct {
    emergency_in in;
    emergency_out out;
    reference_driver_cc_par par;
    driver_foot foot;
    driver_memory memory[EMERGENCY_TRACKS];
} reference_driver_cc;

void reference_driver_cc_init(reference_driver_cc *self);
void reference_driver_cc_step(reference_driver_cc *self);

#endif
