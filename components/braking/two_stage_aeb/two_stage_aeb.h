/* Warns, brakes partly, brakes fully: autonomous emergency braking in two stages, for all objects in the car's path.
 *
 * An object that the car meets if both keep their motion (emergency.h) counts if it overlaps the car's width when the
 * car arrives, with a margin by its class. So a crossing pedestrian counts by the place at that time, not by the
 * present one. With the gap d and the closing speed c, a stage of braking begins at
 *   d <= max(ttc c, c lost_time + c^2/(2 required) + standing_gap)
 * i.e. by the time to collision d/c, or as soon as a constant deceleration *required* would just leave standing_gap.
 * With object_brakes, an object that surely brakes with b > 0 (its estimate less *deviations* standard deviations) keeps
 * braking to standstill: the car loses ttc c + b ttc^2/2 in ttc, and the deceleration *required* has to end the approach
 * at c + b lost_time, or at the place where the object stops if that is sooner.
 * The warning begins warning_lead c before the first of both. Of the stages of all objects the highest counts. Braking
 * continues, whatever d and c become, until the car has approached nothing in its path for release_time; from
 * standstill the car is held for holding_time. The warning ends where d is warning_hysteresis beyond its start, and
 * release_time later. While a stage is active, the margins are wider by margin_hysteresis. No stage begins below
 * min_speed or above max_speed; braking that has begun continues to standstill. Drag and rolling resistance are
 * neglected, which is conservative.
 *
 * UN R152: works from 10 to 60 km/h at least, demands 5 m/s2 at least (full_deceleration), warns of a vehicle 0.8 s
 * before at the latest, of a pedestrian when it brakes. Euro NCAP, AEB: car to car at 10 to 80 km/h, adults 0.5 m wide
 * who cross with 5 and 8 km/h. Stages by time to collision and required deceleration: Winner et al., Handbook of Driver
 * Assistance Systems, 2016. These are engineering checks, not a claim of conformity.
 *
 * A stage begins only for a track whose probability of existence is at least least_existence. Braking begins only if it
 * would begin for an object that is *deviations* standard deviations farther outside the path when the car arrives, and
 * *deviations* standard deviations of d minus the distance above farther away, by the track's covariance; the warning
 * likewise by warning_deviations. So a track whose speed is not yet measured does not brake the car. 0: estimates count
 * as exact. What has begun continues without these.
 *
 * Limits: the path is the circle the car is on now, so before a curve an object behind the curve counts as ahead. Without
 * object_brakes, a leading car that brakes counts with its present speed. */
#ifndef TWO_STAGE_AEB_H
#define TWO_STAGE_AEB_H

#include "../emergency/emergency.h"

typedef struct {
    double warning_lead, warning_hysteresis;
    double partial_ttc, partial_required, partial_deceleration;
    double full_ttc, full_required, full_deceleration;
    double lost_time, standing_gap;
    double build_up_jerk, release_jerk, release_time, holding_time;
    double min_speed, max_speed, min_age;
    double vehicle_margin, vulnerable_margin, margin_hysteresis;
    double deviations, warning_deviations, least_existence;
    int32_t unknown_class; /* the highest stage for objects without a class */
    bool object_brakes;    /* the acceleration of objects counts */
    double front_length, width, length, unknown_width, nominal_mass, wheel_radius;
} two_stage_aeb_par;

typedef struct {
    emergency_in in;
    emergency_out out;
    two_stage_aeb_par par;
    int32_t calm; /* samples since an object was last approached */
} two_stage_aeb;

void two_stage_aeb_init(two_stage_aeb *self);
void two_stage_aeb_step(two_stage_aeb *self);

#endif
