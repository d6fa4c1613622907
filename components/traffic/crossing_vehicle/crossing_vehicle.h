/* A vehicle that stands on a path of its own, sets out, and comes to where that path crosses or joins the host's just
 * when the host would: its front is in the middle of the conflict (on its path) when the host's front would be there (on
 * its own) if it kept its present speed, or *delay* later; the course of Euro NCAP's car-to-car crossing straight, in
 * which both hit each other's fronts. It speeds up evenly and keeps its speed; the moment it sets out lies between two
 * steps. Who would have had to set out before the run is under way at its start; what it does afterwards does not
 * depend on the host, if it ignores its duties.
 *
 * If it obeys, it stops before the conflict while the road says that it gives way and the host has not left the
 * conflict, and before a light of its path that is red or yellow, unless it would have to brake by more than twice its
 * deceleration; then it sets out again. */
#ifndef CROSSING_VEHICLE_H
#define CROSSING_VEHICLE_H

#include "../profile/speed_profile.h"
#include "../profile/traffic.h"

/* From a moment on: evenly to a speed, which it then keeps. */
typedef struct {
    double since, from, speed, rate, final_speed;
} crossing_phase;

typedef struct {
    traffic_in in;
    traffic_out out;
    struct {
        int32_t vehicle, path, manners;
        double station, delay, speed, acceleration, deceleration, stop_gap;
        double host_front, host_rear;
        double length, width, height;
    } par;
    crossing_phase phase;
    bool has_set_out, is_known; /* is_known: where it meets the host's path */
    double entry, middle, host_middle, host_exit;
    bool gives_way;
    counted_time time;
} crossing_vehicle;

void crossing_vehicle_init(crossing_vehicle *self);
void crossing_vehicle_step(crossing_vehicle *self, double h);

#endif
