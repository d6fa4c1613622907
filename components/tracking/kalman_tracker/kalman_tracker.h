/* A Kalman filter for each object: constant velocity over ground, seen from the moving car (Bar-Shalom, Li, Kirubarajan:
 * Estimation with applications to tracking and navigation, 2001: discrete white noise acceleration, section 6.3.2;
 * converted measurements, section 10.4.3, without their bias, which is small for the angles of these sensors).
 *
 * State: place from the car's centre of gravity, velocity over ground, both along the car's axes; for each sensor the
 * errors of scale and azimuth that the scan declares (a constant, or a Gauss-Markov process with its deviation and
 * correlation time; each track estimates them by itself). So a scale error that nothing else reveals stays in the
 * covariance of place and velocity instead of being averaged away, and another sensor reveals it. In a step the car
 * moves by d and turns by a, from the means of its motion at both ends: p' = R(-a) (p + v T - d), v' = R(-a) v.
 * Measured: place, with the deviations of range and azimuth that the sensor reports as white noise, and the speed along the ray if
 * there is Doppler (rate_deviation > 0).
 *
 * A scan reports its age. Its detections are turned and moved by the car's motion since, and measure the object's place
 * at that time: p - v age; the noise of its acceleration since then is neglected.
 *
 * A scan is read once, when its number changes. Of all pairs of track and detection within the gate (squared
 * Mahalanobis distance) the nearest is taken, repeatedly. A sensor reports one point of a body, and another point when
 * it sees another face; so do several sensors. So the rest is paired again as if the point might be any point of a body of
 * the track's class: the covariance of its place grows by that of a uniform distribution on length by width,
 * extent^2/12 each, along its velocity (slower than 2 m/s or two of its deviations: along the car). Such a pair moves
 * the place, but hardly the velocity; the width reported for the other face applies, and until there is one, the side
 * that is nearer to the car stays. A detection without a track starts one. The track is reported once the sensor that
 * started it has hit it in *confirm* of its first *of* scans. It is deleted otherwise, or after *coast* without a hit.
 * The nearest are reported, with the covariance of place and velocity.
 *
 * Acceleration along the car: what the filter's innovations have in common (Friedland, filter.h), as a Gauss-Markov process
 * of acceleration_deviation and acceleration_time. It does not change place and velocity, which lag behind.
 *
 * Existence: a new track exists with probability *birth*. Each scan of the sensor that started it multiplies the odds by
 * detection_rate / false_rate with a hit, by (1 - detection_rate) / (1 - false_rate) without one (Bayes), and each hit of
 * another sensor by the first. A miss of another sensor counts nothing: it may not see that far. At most 0.999, so
 * that an object that is gone is doubted soon. */
#ifndef KALMAN_TRACKER_H
#define KALMAN_TRACKER_H

#include "../tracker/tracker.h"
#include "filter.h"

#define KALMAN_TRACKER_KEPT 24 /* tracks, confirmed or not */

typedef struct {
    int32_t id, class; /* id 0: free */
    filter estimate;   /* x, y, vx, vy; scale and azimuth of each sensor, in the order of the ports */
    filter_bias acceleration; /* along the car */
    double existence, width, age, missed; /* s since the last hit */
    int32_t widths;            /* measured so far */
    int32_t sensor, looks, hits;
    bool confirmed;
} kalman_tracker_kept;

typedef struct {
    tracker_in in;
    tracker_out out;
    struct {
        double acceleration_noise; /* m/s2, standard deviation over a step */
        double acceleration_deviation, acceleration_time; /* m/s2, s: of an acceleration that lasts */
        double speed_deviation;    /* m/s, of a new track relative to standstill */
        double gate;               /* squared */
        int32_t confirm, of;
        double coast; /* s */
        double birth, detection_rate, false_rate;
    } par;
    kalman_tracker_kept kept[KALMAN_TRACKER_KEPT];
    tracker_history history;
    int32_t read[TRACKER_SCANS]; /* numbers of the last read scans */
    int32_t next_id;
} kalman_tracker;

void kalman_tracker_init(kalman_tracker *self);
void kalman_tracker_step(kalman_tracker *self);

#endif
