/* A motion that keeps a speed, changes it once at a constant rate, and keeps the new one; and a counted time. */
#ifndef SPEED_PROFILE_H
#define SPEED_PROFILE_H

#include <stdint.h>

typedef struct {
    double speed, change_time, change_rate, final_speed; /* change_rate 0: no change */
} speed_profile;

typedef struct {
    double travelled, speed, acceleration;
} speed_profile_motion;

speed_profile_motion speed_profile_at(const speed_profile *profile, double time);

/* The time is base + steps * step, never a sum of steps. All zero at the start. */
typedef struct {
    double base, step;
    int64_t steps;
} counted_time;

double counted_time_now(const counted_time *time);
void counted_time_advance(counted_time *time, double h);

#endif
