/* The single-track car that lateral controllers use, along a straight line at constant speed.
 *
 * State z = (offset e, its rate, heading error t, its rate), steering d (Snider 2009, section 3; Rajamani 2012, 2.5):
 *   m e''  = -(Cf + Cr) e'/v + (Cf + Cr) t - (a Cf - b Cr) t'/v + Cf d
 *   I t''  = -(a Cf - b Cr) e'/v + (a Cf - b Cr) t - (a^2 Cf + b^2 Cr) t'/v + a Cf d
 * with axle stiffness Cf = cf Wf, Cr = cr Wr by the axles' loads at rest. Along a path of curvature k that is banked by
 * an angle p the car is in balance on it, e = e' = t' = 0, with
 *   d = L k + K (v^2 k + g p),  K = m (b/Cf - a/Cr)/L,    t = -b k + m a/(L Cr) (v^2 k + g p)
 */
#ifndef CAR_MODEL_H
#define CAR_MODEL_H

typedef struct {
    double mass, yaw_inertia, wheelbase, front_load_share;
    double front_stiffness, rear_stiffness; /* 1/rad: lateral force per load and slip angle */
} car_model;

/* z at the end of a step is transition z + steering d, with d held. */
typedef struct {
    double transition[4][4], steering[4];
} car_motion;

/* Heading error and steering that keep the car on a path. */
typedef struct {
    double heading, steering;
} car_balance;

/* Exact for held steering: exponential of the matrix by scaling and squaring (Moler, Van Loan 2003). *speed* > 0. */
car_motion car_motion_over(const car_model *car, double speed, double time);

car_balance car_balance_on(const car_model *car, double speed, double curvature, double bank);

/* From the centre of gravity to the rear axle, b. */
double car_rear(const car_model *car);

#endif
