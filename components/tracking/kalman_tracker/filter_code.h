/* The filter for TRACKER_SCANS sensors, as kalman_tracker_code.h. */
#include "filter.h"

#include <math.h>
#include <string.h>

#define M FILTER_MEASURED
#define MOVING FILTER_MOVING
#define N FILTER_STATES

/* p' = R(-angle) (p + v T), v' = R(-angle) v. */
static void transition(double f[4][4], double T, double angle) {
    double c = cos(angle), s = sin(angle);
    double of[4][4] = {{c, s, c * T, s * T}, {-s, c, -s * T, c * T}, {0, 0, c, s}, {0, 0, -s, c}};
    memcpy(f, of, sizeof of);
}

void filter_predict(filter *self, double T, double dx, double dy, double angle, double sigma) {
    double f[4][4];
    transition(f, T, angle);
    double from[4] = {self->state[0] - dx, self->state[1] - dy, self->state[2], self->state[3]}, half[4][N];
    for (int32_t i = 0; i < MOVING; ++i) {
        self->state[i] = 0;
        for (int32_t j = 0; j < MOVING; ++j) self->state[i] += f[i][j] * from[j];
        for (int32_t j = 0; j < N; ++j) {
            half[i][j] = 0;
            for (int32_t k = 0; k < MOVING; ++k) half[i][j] += f[i][k] * self->cov[k][j];
        }
    }
    double q = sigma * sigma, place = q * T * T * T * T / 4, both = q * T * T * T / 2, speed = q * T * T;
    for (int32_t i = 0; i < MOVING; ++i) {
        for (int32_t j = MOVING; j < N; ++j) self->cov[i][j] = self->cov[j][i] = half[i][j];
        for (int32_t j = 0; j < MOVING; ++j) {
            double *cov = &self->cov[i][j];
            *cov = i == j ? (i < 2 ? place : speed) : (i - j == 2 || j - i == 2) ? both : 0;
            for (int32_t k = 0; k < MOVING; ++k) *cov += half[i][k] * f[j][k];
        }
    }
}

void filter_bias_predict(filter_bias *self, double T, double angle, double fade, double deviation) {
    double f[4][4], from[4] = {self->error[0] - 0.5 * T * T, self->error[1], self->error[2] + T, self->error[3]};
    transition(f, T, angle);
    for (int32_t i = 0; i < MOVING; ++i) {
        self->error[i] = 0;
        for (int32_t j = 0; j < MOVING; ++j) self->error[i] += f[i][j] * from[j];
    }
    self->value *= fade;
    self->variance = fade * fade * self->variance + (1 - fade * fade) * deviation * deviation;
}

void filter_spread(filter *self, double length, double width, double c, double s) {
    double along = length * length / 12, across = width * width / 12;
    self->cov[0][0] += c * c * along + s * s * across;
    self->cov[1][1] += s * s * along + c * c * across;
    self->cov[0][1] += c * s * (along - across);
    self->cov[1][0] += c * s * (along - across);
}

/* Innovation, P H', and the lower triangle L of S = H P H' + R = L L'. */
typedef struct {
    double error[M], across[N][M], root[M][M];
} innovation;

static innovation innovate(const filter *self, const filter_measurement *measured) {
    innovation found;
    for (int32_t m = 0; m < measured->count; ++m) {
        found.error[m] = measured->value[m];
        for (int32_t i = 0; i < N; ++i) {
            found.error[m] -= measured->row[m][i] * self->state[i];
            found.across[i][m] = 0;
            for (int32_t k = 0; k < N; ++k) found.across[i][m] += self->cov[i][k] * measured->row[m][k];
        }
    }
    for (int32_t m = 0; m < measured->count; ++m) {
        for (int32_t n = 0; n <= m; ++n) {
            double sum = measured->noise[m][n];
            for (int32_t i = 0; i < N; ++i) sum += measured->row[m][i] * found.across[i][n];
            for (int32_t k = 0; k < n; ++k) sum -= found.root[m][k] * found.root[n][k];
            found.root[m][n] = m == n ? sqrt(sum) : sum / found.root[n][n];
        }
    }
    return found;
}

/* L^-1 of a column, in place. */
static void solve(const innovation *found, int32_t count, double column[M]) {
    for (int32_t m = 0; m < count; ++m) {
        for (int32_t k = 0; k < m; ++k) column[m] -= found->root[m][k] * column[k];
        column[m] /= found->root[m][m];
    }
}

double filter_distance(const filter *self, const filter_measurement *measured) {
    innovation found = innovate(self, measured);
    solve(&found, measured->count, found.error);
    double sum = 0;
    for (int32_t m = 0; m < measured->count; ++m) sum += found.error[m] * found.error[m];
    return sum;
}

/* The part g of L^-1 error that is due to a bias of 1. */
static void bias_in(const filter_bias *bias, const filter_measurement *measured, const innovation *found, double g[M]) {
    for (int32_t m = 0; m < measured->count; ++m) {
        g[m] = measured->accelerated[m];
        for (int32_t i = 0; i < N; ++i) g[m] += measured->row[m][i] * bias->error[i];
    }
    solve(found, measured->count, g);
}

/* The least squares of L^-1 error - g value. */
static void learn(filter_bias *bias, const double error[M], const double g[M], int32_t count) {
    double information = 1 / bias->variance, sum = 0;
    for (int32_t m = 0; m < count; ++m) {
        information += g[m] * g[m];
        sum += g[m] * (error[m] - g[m] * bias->value);
    }
    bias->variance = 1 / information;
    bias->value += bias->variance * sum;
}

/* With W = P H' L'^-1: state + W L^-1 error, cov - W W', which stays symmetric. */
void filter_update(filter *self, filter_bias *bias, const filter_measurement *measured) {
    innovation found = innovate(self, measured);
    double g[M] = {0};
    solve(&found, measured->count, found.error);
    for (int32_t i = 0; i < N; ++i) solve(&found, measured->count, found.across[i]);
    if (bias) {
        bias_in(bias, measured, &found, g);
        learn(bias, found.error, g, measured->count);
    }
    for (int32_t i = 0; i < N; ++i) {
        for (int32_t m = 0; m < measured->count; ++m) {
            self->state[i] += found.across[i][m] * found.error[m];
            if (bias) bias->error[i] -= found.across[i][m] * g[m];
        }
        for (int32_t j = 0; j < N; ++j) {
            for (int32_t m = 0; m < measured->count; ++m) self->cov[i][j] -= found.across[i][m] * found.across[j][m];
        }
    }
}

void filter_fade(filter *self, filter_bias *bias, int32_t at, double fade, double deviation) {
    self->state[at] *= fade;
    bias->error[at] *= fade;
    for (int32_t i = 0; i < N; ++i) {
        self->cov[i][at] *= fade;
        self->cov[at][i] *= fade;
    }
    self->cov[at][at] += (1 - fade * fade) * deviation * deviation;
}
