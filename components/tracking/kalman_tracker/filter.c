#include "filter.h"

#include <math.h>

#define M FILTER_MEASURED
#define MOVING FILTER_MOVING
#define N FILTER_STATES

void filter_predict(filter *self, double T, double dx, double dy, double angle, double sigma) {
    double c = cos(angle), s = sin(angle);
    double f[4][4] = {{c, s, c * T, s * T}, {-s, c, -s * T, c * T}, {0, 0, c, s}, {0, 0, -s, c}};
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

/* With W = P H' L'^-1: state + W L^-1 error, cov - W W', which stays symmetric. */
void filter_update(filter *self, const filter_measurement *measured) {
    innovation found = innovate(self, measured);
    solve(&found, measured->count, found.error);
    for (int32_t i = 0; i < N; ++i) solve(&found, measured->count, found.across[i]);
    for (int32_t i = 0; i < N; ++i) {
        for (int32_t m = 0; m < measured->count; ++m) self->state[i] += found.across[i][m] * found.error[m];
        for (int32_t j = 0; j < N; ++j) {
            for (int32_t m = 0; m < measured->count; ++m) self->cov[i][j] -= found.across[i][m] * found.across[j][m];
        }
    }
}

void filter_fade(filter *self, int32_t at, double fade, double deviation) {
    self->state[at] *= fade;
    for (int32_t i = 0; i < N; ++i) {
        self->cov[i][at] *= fade;
        self->cov[at][i] *= fade;
    }
    self->cov[at][at] += (1 - fade * fade) * deviation * deviation;
}
