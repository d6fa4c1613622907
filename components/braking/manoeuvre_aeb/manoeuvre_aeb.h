/* Brakes at walking speed for all that is in the car's way, or will be there soon: when it starts, turns out of a parking
 * space, or reverses.
 *
 * The car's way is a strip as wide as the car and a margin, from the bumper in its direction of travel to where it would
 * stop, at its present acceleration for lost_time, then with full_deceleration, and standing_gap further. An object counts if its box is in this strip at any time within
 * the horizon, at its present velocity over ground. The box has the size of the object's class along its velocity, about
 * the tracked point; slower than 0.5 m/s it has its width only. So the car waits for a vehicle that is about to cross,
 * whatever its own speed will be. Without a class, it has unknown_width, or is a car if it is faster than 3 m/s.
 *
 * It begins between min_speed and max_speed, and only for tracks of min_age and least_existence. Braking continues for
 * release_time after the danger, and from standstill for holding_time.
 *
 * Limits: the strip is straight, and the width of a door or a mirror does not count. */
#ifndef MANOEUVRE_AEB_H
#define MANOEUVRE_AEB_H

#include "../emergency/emergency.h"

typedef struct {
    emergency_in in;
    emergency_out out;
    struct {
        double horizon, margin, lost_time, full_deceleration, standing_gap;
        double build_up_jerk, release_jerk, release_time, holding_time;
        double min_speed, max_speed, min_age, least_existence, unknown_width;
        double front_length, width, length, nominal_mass, wheel_radius;
    } par;
    int32_t calm; /* samples since the last danger */
} manoeuvre_aeb;

void manoeuvre_aeb_init(manoeuvre_aeb *self);
void manoeuvre_aeb_step(manoeuvre_aeb *self);

#endif
