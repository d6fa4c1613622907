/* Textbook Kalman filter of up to three measurements. Its states are place and velocity, and for each sensor the
 * error of scale and of azimuth that its measurements have in common. */
#ifndef KALMAN_FILTER_H
#define KALMAN_FILTER_H

#include <stdint.h>

#define FILTER_MEASURED 3
#define FILTER_MOVING 4
#ifndef TRACKER_SCANS
#define TRACKER_SCANS 2
#endif
#define FILTER_STATES (FILTER_MOVING + 2 * TRACKER_SCANS)

typedef struct {
    int32_t count;
    double value[FILTER_MEASURED];
    double row[FILTER_MEASURED][FILTER_STATES];     /* H */
    double noise[FILTER_MEASURED][FILTER_MEASURED]; /* R */
    double accelerated[FILTER_MEASURED];            /* m/(m/s2), 1/s: its error by an acceleration along the car since then */
} filter_measurement;

/* Estimate and covariance. */
typedef struct {
    double state[FILTER_STATES], cov[FILTER_STATES][FILTER_STATES];
} filter;

/* A constant that the filter's model lacks, estimated from its innovations: the acceleration along the car (Friedland:
 * Treatment of bias in recursive filtering, IEEE Trans. Automatic Control 14:359, 1969). The filter itself is not changed
 * by it. */
typedef struct {
    double value, variance;
    double error[FILTER_STATES]; /* of the filter's estimate, per unit of it */
} filter_bias;

/* In *T* s, while the car turns by *angle*; *fade* and *deviation* as in filter_fade. */
void filter_bias_predict(filter_bias *self, double T, double angle, double fade, double deviation);

/* state = F state + shift, cov = F cov F' + Q of place and velocity, for the car's turn by *angle* and move by (dx, dy). */
void filter_predict(filter *self, double T, double dx, double dy, double angle, double sigma);

/* The measured point may be another point of the body: adds to the covariance of its place that of a uniform
 * distribution on length by width, along (c, s): extent^2/12. */
void filter_spread(filter *self, double length, double width, double c, double s);

/* Squared Mahalanobis distance of a measurement. */
double filter_distance(const filter *self, const filter_measurement *measured);

/* Without *bias* (NULL) only the state is estimated. */
void filter_update(filter *self, filter_bias *bias, const filter_measurement *measured);

/* One step of state *at*, with its part of *bias*, a Gauss-Markov process of *deviation*; *fade* as in sensing_drifted. */
void filter_fade(filter *self, filter_bias *bias, int32_t at, double fade, double deviation);

#endif
