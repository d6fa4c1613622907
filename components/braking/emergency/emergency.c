#include "emergency.h"

#include <math.h>

#define SLOW 1.0        /* m/s: below it the yaw rate tells no curvature */
#define STRAIGHT 1e-9   /* 1/m */
#define NEAR_CENTRE 0.1 /* of the radius: what is nearer to the circle's centre is not on the car's way */

static double width_of(int32_t class) {
    switch (class) {
    case CLASS_CAR: return 1.8;
    case CLASS_TRUCK: return 2.5;
    case CLASS_MOTORCYCLE: return 0.8;
    case CLASS_BICYCLE: return 0.6;
    case CLASS_PEDESTRIAN: return 0.5;
    default: return 1.0;
    }
}

emergency_meeting emergency_meet(const emergency_in *in, int index, double front, double width) {
    emergency_meeting meeting = {false, 0, 0, 0};
    if (in->tracks[index].id == 0) return meeting;
    double x = in->tracks[index].x, y = in->tracks[index].y;
    double k = in->motion.yaw_rate / fmax(in->motion.speed, SLOW);
    /* From the circle's centre, in radii. */
    double radius = hypot(k * x, 1 - k * y);
    double turned = atan2(k * x, 1 - k * y), along = fabs(k) < STRAIGHT ? x : turned / k;
    if (along <= 0 || radius < NEAR_CENTRE || cos(turned) < 0) return meeting;
    double aside = (2 * y - k * (x * x + y * y)) / (1 + radius); /* (1 - radius)/k */
    double vx = in->tracks[index].vx, vy = in->tracks[index].vy;
    double ahead = (vx * cos(turned) + vy * sin(turned)) / radius, across = vy * cos(turned) - vx * sin(turned);
    meeting.closing = in->motion.speed - ahead;
    meeting.gap = fmax(along - front, 0);
    meeting.is_ahead = meeting.closing > 0;
    if (!meeting.is_ahead) return meeting;
    double given = in->tracks[index].width;
    double object = given > 0 ? given : width_of(in->tracks[index].class);
    meeting.clearance = fabs(aside + across * meeting.gap / meeting.closing) - 0.5 * (width + object);
    return meeting;
}

double emergency_build_up(double wanted, double last, double build_up_jerk, double release_jerk) {
    return fmax(fmin(wanted, last + build_up_jerk * EMERGENCY_STEP), last - release_jerk * EMERGENCY_STEP);
}
