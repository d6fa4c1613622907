/* Textbook Kalman filter of up to three measurements. Its states are place and velocity, and for each of two sensors the
 * error of scale and of azimuth that its measurements have in common. */
#ifndef KALMAN_FILTER_H
#define KALMAN_FILTER_H

#include <stdint.h>

#define FILTER_MEASURED 3
#define FILTER_MOVING 4
#define FILTER_STATES 8

typedef struct {
    int32_t count;
    double value[FILTER_MEASURED];
    double row[FILTER_MEASURED][FILTER_STATES];     /* H */
    double noise[FILTER_MEASURED][FILTER_MEASURED]; /* R */
} filter_measurement;

/* Estimate and covariance. */
typedef struct {
    double state[FILTER_STATES], cov[FILTER_STATES][FILTER_STATES];
} filter;

/* state = F state + shift, cov = F cov F' + Q of place and velocity, for the car's turn by *angle* and move by (dx, dy). */
void filter_predict(filter *self, double T, double dx, double dy, double angle, double sigma);

/* The measured point may be another point of the body: adds to the covariance of its place that of a uniform
 * distribution on length by width, along (c, s): extent^2/12. */
void filter_spread(filter *self, double length, double width, double c, double s);

/* Squared Mahalanobis distance of a measurement. */
double filter_distance(const filter *self, const filter_measurement *measured);

void filter_update(filter *self, const filter_measurement *measured);

/* One step of state *at*, a Gauss-Markov process of *deviation*; *fade* as in sensing_drifted. */
void filter_fade(filter *self, int32_t at, double fade, double deviation);

#endif
