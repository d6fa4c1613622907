/* A vehicle that waits on its own path, starts, and arrives where that path crosses or joins the host's at the same
 * time as the host: its front is in the middle of the conflict (on its path) when the host's front would be there (on
 * its own) at its present speed, or *delay* later. This is Euro NCAP's car-to-car crossing straight, in which both
 * fronts collide. It accelerates evenly and keeps its speed. The start time may be between two steps; if it is before
 * the run, the vehicle moves at the start of the run. Its motion after the start is independent of the host, if it
 * ignores the right of way.
 *
 * If it obeys, it stops before the conflict while it has to give way and the host has not left the conflict, and before
 * a red or yellow light of its path, unless it would have to brake by more than twice its deceleration; then it starts
 * again. */
#ifndef CROSSING_VEHICLE_H
#define CROSSING_VEHICLE_H

#include "../profile/speed_profile.h"
#include "../profile/traffic.h"

/* From a time on: constant acceleration to a speed, which it then keeps. */
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
