/* A vehicle that changes lanes before the host, and optionally one at rest in its former lane. The parameters of UN
   R157 (annex 4, appendix 3, guidance on critical scenarios): its speed Vo0 relative to the host's Ve0, the gap dx0 at
   which it begins, the lateral speed Vy (here its maximum, in the middle of the quintic), and of a cut-out the gap
   dx0_f to the one at rest. Once it has begun, its motion is independent of the host. Its speed changes at most as the
   surface at the beginning of the change allows. */
#ifndef CUT_IN_H
#define CUT_IN_H

#include "../profile/lane_shift.h"
#include "../profile/speed_profile.h"
#include "../profile/traffic.h"

typedef struct {
    traffic_in in;
    traffic_out out;
    struct {
        int32_t vehicle, speed_over, begin;
        int32_t from_lane, to_lane, host_lane;
        double lane_width, lateral_speed;
        double initial_gap, host_front, lap_length;
        double speed, begin_time, begin_gap;
        double change_delay, change_rate, final_speed;
        bool standing;
        double standing_gap, standing_length, standing_width, standing_height;
        double length, width, height;
    } par;
    double start, standing_at;      /* stations of their centres */
    double speed, travelled;        /* at the start; m since */
    double sense;                   /* 1: the gap decreases until it begins, -1: increases */
    bool has_begun;
    double begun_at;                /* s */
    double grip;                    /* m/s2, at the last step before the speed changes */
    lane_shift shift;
    counted_time time;
} cut_in;

void cut_in_init(cut_in *self);
void cut_in_step(cut_in *self, double h);

#endif
