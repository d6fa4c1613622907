/* Textbook Kalman filter of four states and up to three measurements. */
#ifndef KALMAN_FILTER_H
#define KALMAN_FILTER_H

#include <stdint.h>

#define FILTER_MEASURED 3

typedef struct {
    int32_t count;
    double value[FILTER_MEASURED];
    double row[FILTER_MEASURED][4];               /* H */
    double noise[FILTER_MEASURED][FILTER_MEASURED]; /* R */
} filter_measurement;

/* state = F state + shift, cov = F cov F' + Q, for the car's turn by *angle* and move by (dx, dy). */
void filter_predict(double state[4], double cov[4][4], double T, double dx, double dy, double angle, double sigma);

/* The measured point may be another point of the body: adds to the covariance of its place that of a uniform
 * distribution on length by width, along (c, s): extent^2/12. */
void filter_spread(double cov[4][4], double length, double width, double c, double s);

/* Squared Mahalanobis distance of a measurement. */
double filter_distance(const double state[4], double cov[4][4], const filter_measurement *measured);

void filter_update(double state[4], double cov[4][4], const filter_measurement *measured);

#endif
