#include "plane.h"

#include <math.h>

plane plane_below(double heading, double slope_x, double slope_y) {
    double c = cos(heading), s = sin(heading);
    double rise = slope_x * c + slope_y * s, bank = -slope_x * s + slope_y * c; /* to the front, to the left */
    double flat = 1 + rise * rise, up = 1 / sqrt(flat + bank * bank), ahead = 1 / sqrt(flat), left = up * ahead;
    plane p = {
        .ahead = {ahead * c, ahead * s, ahead * rise},
        .left = {left * (-rise * bank * c - flat * s), left * (-rise * bank * s + flat * c), left * bank},
        .up = up,
        .turn = flat * up,
    };
    return p;
}

void plane_slopes(const chassis_ground ground[4], double slopes[2]) {
    slopes[0] = 0.25 * (ground[0].slope_x + ground[1].slope_x + ground[2].slope_x + ground[3].slope_x);
    slopes[1] = 0.25 * (ground[0].slope_y + ground[1].slope_y + ground[2].slope_y + ground[3].slope_y);
}

void plane_attitude(const plane *p, double *roll, double *pitch) {
    *roll = atan2(p->left[2], p->up);
    *pitch = -asin(p->ahead[2]);
}

void plane_contacts(const plane *p, double x, double y, const double ahead[4], const double left[4], chassis_contact contacts[4]) {
    for (int i = 0; i < 4; ++i) {
        contacts[i].x = x + ahead[i] * p->ahead[0] + left[i] * p->left[0];
        contacts[i].y = y + ahead[i] * p->ahead[1] + left[i] * p->left[1];
    }
}

double plane_air_force(const plane *p, const chassis_air *air, double speed, double lateral_speed, double drag_area, double side_area, double *side) {
    double u = speed - air->wind_x * p->ahead[0] - air->wind_y * p->ahead[1];
    double v = lateral_speed - air->wind_x * p->left[0] - air->wind_y * p->left[1];
    double pressure = 0.5 * air->density * sqrt(u * u + v * v);
    *side = -pressure * side_area * v;
    return -pressure * drag_area * u;
}
