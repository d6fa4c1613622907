#include "filter.h"

#include <math.h>

#define M FILTER_MEASURED

void filter_predict(double state[4], double cov[4][4], double T, double dx, double dy, double angle, double sigma) {
    double c = cos(angle), s = sin(angle);
    double f[4][4] = {{c, s, c * T, s * T}, {-s, c, -s * T, c * T}, {0, 0, c, s}, {0, 0, -s, c}};
    double from[4] = {state[0] - dx, state[1] - dy, state[2], state[3]}, half[4][4];
    for (int32_t i = 0; i < 4; ++i) {
        state[i] = 0;
        for (int32_t j = 0; j < 4; ++j) {
            state[i] += f[i][j] * from[j];
            half[i][j] = 0;
            for (int32_t k = 0; k < 4; ++k) half[i][j] += f[i][k] * cov[k][j];
        }
    }
    double q = sigma * sigma, place = q * T * T * T * T / 4, both = q * T * T * T / 2, speed = q * T * T;
    for (int32_t i = 0; i < 4; ++i) {
        for (int32_t j = 0; j < 4; ++j) {
            cov[i][j] = i == j ? (i < 2 ? place : speed) : (i - j == 2 || j - i == 2) ? both : 0;
            for (int32_t k = 0; k < 4; ++k) cov[i][j] += half[i][k] * f[j][k];
        }
    }
}

void filter_spread(double cov[4][4], double length, double width, double c, double s) {
    double along = length * length / 12, across = width * width / 12;
    cov[0][0] += c * c * along + s * s * across;
    cov[1][1] += s * s * along + c * c * across;
    cov[0][1] += c * s * (along - across);
    cov[1][0] += c * s * (along - across);
}

/* Innovation, P H', and the lower triangle L of S = H P H' + R = L L'. */
typedef struct {
    double error[M], across[4][M], root[M][M];
} innovation;

static innovation innovate(const double state[4], double cov[4][4], const filter_measurement *measured) {
    innovation found;
    for (int32_t m = 0; m < measured->count; ++m) {
        found.error[m] = measured->value[m];
        for (int32_t i = 0; i < 4; ++i) {
            found.error[m] -= measured->row[m][i] * state[i];
            found.across[i][m] = 0;
            for (int32_t k = 0; k < 4; ++k) found.across[i][m] += cov[i][k] * measured->row[m][k];
        }
    }
    for (int32_t m = 0; m < measured->count; ++m) {
        for (int32_t n = 0; n <= m; ++n) {
            double sum = measured->noise[m][n];
            for (int32_t i = 0; i < 4; ++i) sum += measured->row[m][i] * found.across[i][n];
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

double filter_distance(const double state[4], double cov[4][4], const filter_measurement *measured) {
    innovation found = innovate(state, cov, measured);
    solve(&found, measured->count, found.error);
    double sum = 0;
    for (int32_t m = 0; m < measured->count; ++m) sum += found.error[m] * found.error[m];
    return sum;
}

/* With W = P H' L'^-1: state + W L^-1 error, cov - W W', which stays symmetric. */
void filter_update(double state[4], double cov[4][4], const filter_measurement *measured) {
    innovation found = innovate(state, cov, measured);
    solve(&found, measured->count, found.error);
    for (int32_t i = 0; i < 4; ++i) solve(&found, measured->count, found.across[i]);
    for (int32_t i = 0; i < 4; ++i) {
        for (int32_t m = 0; m < measured->count; ++m) state[i] += found.across[i][m] * found.error[m];
        for (int32_t j = 0; j < 4; ++j) {
            for (int32_t m = 0; m < measured->count; ++m) cov[i][j] -= found.across[i][m] * found.across[j][m];
        }
    }
}
