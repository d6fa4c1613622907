#include "speed_profile.h"

#include <math.h>

speed_profile_motion speed_profile_at(const speed_profile *profile, double time) {
    double rate = fabs(profile->change_rate), from = profile->speed, to = profile->final_speed;
    double since = time - profile->change_time;
    speed_profile_motion motion = {from * time, from, 0};
    if (rate > 0 && since > 0) {
        double acceleration = to < from ? -rate : rate, duration = fabs(to - from) / rate;
        double changing = fmin(since, duration);
        motion.speed = since < duration ? from + acceleration * since : to;
        motion.acceleration = since < duration ? acceleration : 0;
        motion.travelled = from * (time - since + changing) + 0.5 * acceleration * changing * changing + to * (since - changing);
    }
    return motion;
}

double counted_time_now(const counted_time *time) {
    return time->base + (double)time->steps * time->step;
}

void counted_time_advance(counted_time *time, double h) {
    if (h != time->step) {
        time->base += (double)time->steps * time->step;
        time->step = h;
        time->steps = 0;
    }
    time->steps += 1;
}
