#include "plane.h"

#include <math.h>

plane_slopes plane_slopes_of(const chassis_ground ground[4], double wheelbase) {
    double front_x = 0.5 * (ground[0].slope_x + ground[1].slope_x), rear_x = 0.5 * (ground[2].slope_x + ground[3].slope_x);
    double front_y = 0.5 * (ground[0].slope_y + ground[1].slope_y), rear_y = 0.5 * (ground[2].slope_y + ground[3].slope_y);
    plane_slopes slopes = {
        .x = 0.5 * (front_x + rear_x),
        .y = 0.5 * (front_y + rear_y),
        .more_x = (front_x - rear_x) / wheelbase,
        .more_y = (front_y - rear_y) / wheelbase,
    };
    return slopes;
}

plane plane_below(double heading, const plane_slopes *slopes) {
    double c = cos(heading), s = sin(heading);
    double rise = slopes->x * c + slopes->y * s, bank = -slopes->x * s + slopes->y * c; /* forwards, to the left */
    double flat = 1 + rise * rise, up = 1 / sqrt(flat + bank * bank), ahead = 1 / sqrt(flat), left = up * ahead;
    double bend = (slopes->more_x * c + slopes->more_y * s) * left;
    plane p = {
        .ahead = {ahead * c, ahead * s, ahead * rise},
        .left = {left * (-rise * bank * c - flat * s), left * (-rise * bank * s + flat * c), left * bank},
        .up = up,
        .bend = bend,
        .turn = flat * up,
        .drift = -bend * bank * up / ahead,
    };
    return p;
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
