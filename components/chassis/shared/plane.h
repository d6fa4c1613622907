/* The road's plane below a car, and the car's axes in it. */
#ifndef CHASSIS_PLANE_H
#define CHASSIS_PLANE_H

#include "ports.h"

#define CHASSIS_GRAVITY 9.81

/* Slopes below the four wheels: their mean, and front minus rear per metre. */
typedef struct {
    double x, y, more_x, more_y;
} plane_slopes;

/* The heading is that of the nose seen from above; the yaw rate is about the normal. As the car moves, the plane tilts
 * with the curvature of the road: heading' = turn yaw_rate + drift speed. */
typedef struct {
    double ahead[3], left[3]; /* unit vectors of the car in the plane */
    double up;                /* vertical part of the unit normal */
    double bend;              /* curvature of the road along the car, > 0 in a dip */
    double turn, drift;
} plane;

plane_slopes plane_slopes_of(const chassis_ground ground[4], double wheelbase);
plane plane_below(double heading, const plane_slopes *slopes);

/* Euler angles of a car that is parallel to the plane: roll > 0 left side up, pitch > 0 nose down (ISO 8855). */
void plane_attitude(const plane *p, double *roll, double *pitch);

/* Where the wheels touch the ground: *ahead* and *left* are their places in the car. */
void plane_contacts(const plane *p, double x, double y, const double ahead[4], const double left[4], chassis_contact contacts[4]);

/* Drag and side force, with areas that include their coefficients. Both use the speed of the air relative to the car.
 * Returns the force along the car, the side force in *side. */
double plane_air_force(const plane *p, const chassis_air *air, double speed, double lateral_speed, double drag_area, double side_area, double *side);

#endif
