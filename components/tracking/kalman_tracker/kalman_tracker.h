/* A Kalman filter for each object: constant velocity over ground, seen from the moving car (Bar-Shalom, Li, Kirubarajan:
 * Estimation with applications to tracking and navigation, 2001: discrete white noise acceleration, section 6.3.2;
 * converted measurements, section 10.4.3, without their bias, which is small for the angles of these sensors).
 *
 * State: place from the car's centre of gravity, velocity over ground, both along the car's axes. In a step the car moves
 * on by d and turns by a, from the means of its motion at both ends: p' = R(-a) (p + v T - d), v' = R(-a) v.
 * Measured: place, with the deviations of range and azimuth that the sensor tells, and the speed along the ray where it has
 * Doppler (rate_deviation > 0).
 *
 * A scan is as old as it says. What it tells is turned and moved by how the car has moved since, and measures where the
 * object was then: p - v age; the noise of its acceleration since then is left out.
 *
 * A scan is read once, when its number is another one. Of all pairs of track and detection within the gate (squared
 * Mahalanobis distance) the nearest is taken, again and again. A sensor tells one point of a body, and another one when it
 * sees another face; so do two sensors. So of what is left, pairs are made again as if the point might be any of a body of
 * the track's class: the covariance of its place grows by that of a uniform one on length by width, extent^2/12 each, along
 * its velocity (slower than 2 m/s or two of its deviations: along the car).
 * Such a pair moves the place, and hardly the velocity; the width told of the other face counts, and until there is one, the
 * side that is nearer to the car stays where it was.
 * What no track takes begins one; it is told of once the sensor that began it has hit it in *confirm* of its first *of*
 * scans, and forgotten if it does not, or after *coast* without a hit. Told are the nearest. */
#ifndef KALMAN_TRACKER_H
#define KALMAN_TRACKER_H

#include "../tracker/tracker.h"

#define KALMAN_TRACKER_KEPT 24 /* tracks, confirmed or not */

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
        double acceleration_noise; /* m/s2, standard deviation over a step */
        double speed_deviation;    /* m/s, of a new track against standing still */
        double gate;               /* squared */
        int32_t confirm, of;
        double coast; /* s */
    } par;
    kalman_tracker_kept kept[KALMAN_TRACKER_KEPT];
    tracker_history history;
    int32_t read[2]; /* numbers of the scans that were read last */
    int32_t next_id;
} kalman_tracker;

void kalman_tracker_init(kalman_tracker *self);
void kalman_tracker_step(kalman_tracker *self);

#endif
