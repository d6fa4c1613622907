#include "emergency.h"

#include <math.h>

#define SLOW 1.0        /* m/s: below it the yaw rate gives no curvature */
#define STRAIGHT 1e-9   /* 1/m */
#define CROSSES 1.0     /* m/s across the path: a vehicle that crosses it */
#define RUNS 3.0        /* m/s: an object without a class that crosses faster is a car */
#define NEAR_CENTRE 0.1 /* of the radius: an object nearer to the circle's centre is not on the car's path */

double emergency_width_of(int32_t class) {
    switch (class) {
    case CLASS_CAR: return 1.8;
    case CLASS_TRUCK: return 2.5;
    case CLASS_MOTORCYCLE: return 0.8;
    case CLASS_BICYCLE: return 0.6;
    case CLASS_PEDESTRIAN: return 0.5;
    default: return 1.0;
    }
}

double emergency_length_of(int32_t class) {
    switch (class) {
    case CLASS_CAR: return 4.5;
    case CLASS_TRUCK: return 12;
    case CLASS_MOTORCYCLE: return 2.1;
    case CLASS_BICYCLE: return 1.9;
    default: return 0;
    }
}

emergency_place emergency_place_of(const emergency_in *in, int index, double front, double width) {
    emergency_place place = {.is_ahead = false};
    if (in->tracks[index].id == 0) return place;
    double x = in->tracks[index].x, y = in->tracks[index].y;
    double k = in->motion.yaw_rate / fmax(in->motion.speed, SLOW);
    /* From the circle's centre, in radii. */
    double radius = hypot(k * x, 1 - k * y);
    double turned = atan2(k * x, 1 - k * y), along = fabs(k) < STRAIGHT ? x : turned / k;
    if (along <= 0 || radius < NEAR_CENTRE || cos(turned) < 0) return place;
    place.is_ahead = true;
    place.gap = fmax(along - front, 0);
    place.aside = (2 * y - k * (x * x + y * y)) / (1 + radius); /* (1 - radius)/k */
    double vx = in->tracks[index].vx, vy = in->tracks[index].vy;
    place.cosine = cos(turned);
    place.sine = sin(turned);
    place.radius = radius;
    place.speed = (vx * place.cosine + vy * place.sine) / radius;
    place.across = vy * place.cosine - vx * place.sine;
    place.closing = in->motion.speed - place.speed;
    double given = in->tracks[index].width;
    place.touching = 0.5 * (width + (given > 0 ? given : emergency_width_of(in->tracks[index].class)));
    return place;
}

/* Of two linear combinations of the errors of x, y, vx and vy. */
static double covariance_of(const emergency_in *in, int index, const double a[4], const double b[4]) {
    const emergency_covariance *c = &in->tracks[index].covariance;
    double of[4][4] = {{c->x_x, c->x_y, c->x_vx, c->x_vy},
                       {c->x_y, c->y_y, c->y_vx, c->y_vy},
                       {c->x_vx, c->y_vx, c->vx_vx, c->vx_vy},
                       {c->x_vy, c->y_vy, c->vx_vy, c->vy_vy}};
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) sum += a[i] * of[i][j] * b[j];
    }
    return sum;
}

/* Of a vehicle that crosses: the way across the path, to the left, on which any part of it meets any part of the car. */
static void cross(int32_t class, double width, double length, const emergency_place *place, emergency_meeting *meeting,
                  double *right, double *left) {
    double slope = fabs(place->across) / hypot(place->across, place->speed), ahead = 0.5 * slope * emergency_length_of(class);
    meeting->gap = fmax(meeting->gap - 0.5 * slope * emergency_width_of(class), 0);
    double passing = place->across * (length + 1.5 * slope * emergency_width_of(class)) / place->closing;
    double more = fmax(ahead - (place->touching - 0.5 * width), 0);
    *right += place->across > 0 ? -more - ahead : passing - more;
    *left += place->across > 0 ? passing + more : more + ahead;
}

emergency_meeting emergency_meet(const emergency_in *in, int index, const emergency_car *car) {
    emergency_place place = emergency_place_of(in, index, car->front, car->width);
    emergency_meeting meeting = {.is_ahead = place.is_ahead && place.closing > 0, .gap = place.gap, .closing = place.closing};
    if (!meeting.is_ahead) return meeting;
    bool is_unknown = !(in->tracks[index].width > 0) && in->tracks[index].class == CLASS_NONE;
    if (is_unknown && car->unknown_width > 0) place.touching = 0.5 * (car->width + car->unknown_width);
    double share = place.cosine / place.radius; /* of the car's axis along the path */
    meeting.speed = place.speed;
    meeting.braking = -share * in->tracks[index].ax;
    meeting.braking_deviation = share * in->tracks[index].ax_deviation;
    double right = 0, left = 0;
    int32_t class = in->tracks[index].class;
    if (class == CLASS_NONE && fabs(place.across) > RUNS) class = CLASS_CAR;
    if (car->length > 0 && fabs(place.across) > CROSSES && emergency_length_of(class) > 0) {
        cross(class, car->width, car->length, &place, &meeting, &right, &left);
    }
    double time = meeting.gap / place.closing, bent = place.across / place.closing, aside = place.aside + place.across * time;
    meeting.clearance = fmax(aside + right, -aside - left) - place.touching;
    double ahead[2] = {place.cosine / place.radius, place.sine / place.radius};
    double miss[2] = {bent * ahead[0] - place.sine, bent * ahead[1] + place.cosine};
    double aheads[4] = {ahead[0], ahead[1], 0, 0}, speeds[4] = {0, 0, -ahead[0], -ahead[1]};
    double misses[4] = {miss[0], miss[1], time * miss[0], time * miss[1]};
    meeting.clearance_deviation = sqrt(fmax(covariance_of(in, index, misses, misses), 0));
    meeting.gap_variance = covariance_of(in, index, aheads, aheads);
    meeting.gap_closing = covariance_of(in, index, aheads, speeds);
    meeting.closing_variance = covariance_of(in, index, speeds, speeds);
    return meeting;
}

double emergency_build_up(double wanted, double last, double build_up_jerk, double release_jerk) {
    return fmax(fmin(wanted, last + build_up_jerk * EMERGENCY_STEP), last - release_jerk * EMERGENCY_STEP);
}
