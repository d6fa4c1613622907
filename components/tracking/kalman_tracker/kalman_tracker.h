/* A Kalman filter for each object: constant velocity over ground, seen from the moving car (Bar-Shalom, Li, Kirubarajan:
 * Estimation with applications to tracking and navigation, 2001: discrete white noise acceleration, section 6.3.2;
 * converted measurements, section 10.4.3, without their bias, which is small for the angles of these sensors).
 *
 * State: place from the car's centre of gravity, velocity over ground, both along the car's axes. In a step the car moves
 * on by d and turns by a, from the means of its motion at both ends: p' = R(-a) (p + v T - d), v' = R(-a) v.
 * Measured: place, and the speed along the ray where the sensor has Doppler (doppler_noise > 0).
 *
 * A sensor is read once in each of its periods. Of all pairs of track and detection within the gate (squared Mahalanobis
 * distance) the nearest is taken, again and again. What no track takes begins one; it is told of once the sensor that
 * began it has hit it in *confirm* of its first *of* looks, and forgotten if it does not, or after *coast* without a hit.
 * Told are the nearest. The latency of a sensor is not compensated. */
#ifndef KALMAN_TRACKER_H
#define KALMAN_TRACKER_H

#include "../tracker/tracker.h"

#define KALMAN_TRACKER_STEP 0.02 /* s; the step in the component.yaml */
#define KALMAN_TRACKER_KEPT 24   /* tracks, confirmed or not */

typedef struct {
    int32_t id, class; /* id 0: free */
    double state[4];   /* x, y, vx, vy */
    double cov[4][4];
    double width, age, missed; /* s since the last hit */
    int32_t widths;            /* measured so far */
    int32_t sensor, looks, hits;
    bool confirmed;
} kalman_tracker_kept;

typedef struct {
    tracker_in in;
    tracker_out out;
    struct {
        double first_mount, second_mount;                              /* m */
        double first_period, second_period;                            /* s */
        double first_range_noise, second_range_noise;                  /* standard deviations */
        double first_relative_noise, second_relative_noise;            /* of the range, per range */
        double first_azimuth_noise, second_azimuth_noise;              /* rad */
        double first_doppler_noise, second_doppler_noise;              /* m/s; 0: does not measure it */
        double acceleration_noise;                                     /* m/s2, standard deviation over a step */
        double speed_deviation;                                        /* m/s, of a new track against standing still */
        double gate;                                                   /* squared */
        int32_t confirm, of;
        double coast; /* s */
    } par;
    kalman_tracker_kept kept[KALMAN_TRACKER_KEPT];
    tracker_motion last;
    int32_t next_id, tick;
} kalman_tracker;

void kalman_tracker_init(kalman_tracker *self);
void kalman_tracker_step(kalman_tracker *self);

#endif
