/* The road's plane below a car, and the car's axes in it. */
#ifndef CHASSIS_PLANE_H
#define CHASSIS_PLANE_H

#include "ports.h"

#define CHASSIS_GRAVITY 9.81

typedef struct {
    double ahead[3], left[3]; /* unit vectors of the car in the plane */
    double up;                /* vertical part of the unit normal */
    double turn;              /* rate of the heading, which is seen from above, per yaw rate about the normal */
} plane;

/* A plane z = slope_x x + slope_y y with a car on it whose nose, seen from above, points along the heading. */
plane plane_below(double heading, double slope_x, double slope_y);

/* The mean of the slopes below four wheels. */
void plane_slopes(const chassis_ground ground[4], double slopes[2]);

/* Euler angles of a car that is parallel to the plane: roll > 0 left side up, pitch > 0 nose down (ISO 8855). */
void plane_attitude(const plane *p, double *roll, double *pitch);

/* Where the wheels stand: *ahead* and *left* are their places in the car. */
void plane_contacts(const plane *p, double x, double y, const double ahead[4], const double left[4], chassis_contact contacts[4]);

/* Drag and side force, with areas that include their coefficients: along and across, both by the speed of the air
 * against the car; returned as the force along the car, the other one in *side. */
double plane_air_force(const plane *p, const chassis_air *air, double speed, double lateral_speed, double drag_area, double side_area, double *side);

#endif
