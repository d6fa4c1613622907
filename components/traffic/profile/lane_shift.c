#include "lane_shift.h"

#include <math.h>

#define STEEPEST 0.3 /* m aside per m along */

/* The speed along the lane below which the change takes longer. */
static double least_speed(const lane_shift *shift) {
    return LANE_SHIFT_PEAK * fabs(shift->to - shift->from) / (STEEPEST * shift->duration);
}

void lane_shift_advance(lane_shift *shift, double travelled, double h) {
    double least = least_speed(shift), passed = least * h > travelled ? travelled / least : h;
    shift->progress = fmin(shift->progress + passed / shift->duration, 1);
}

lane_shift_pose lane_shift_at(const lane_shift *shift, double speed) {
    double u = shift->progress, way = shift->to - shift->from;
    if (u >= 1 || way == 0) return (lane_shift_pose){1, shift->to, 0, speed};
    double share = fmin(u * u * u * (10 + u * (6 * u - 15)), 1), rate = 30 * u * u * (1 - u) * (1 - u) / shift->duration;
    double slope = way * rate / fmax(speed, least_speed(shift));
    return (lane_shift_pose){share, shift->from + way * share, atan(slope), speed * sqrt(1 + slope * slope)};
}
