#include "riccati.h"

#include <math.h>

#define N 4

typedef double matrix[N][N];

static void product(const matrix a, const matrix b, matrix result) {
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) {
            double sum = 0;
            for (int k = 0; k < N; ++k) sum += a[i][k] * b[k][j];
            result[i][j] = sum;
        }
    }
}

static void transpose(const matrix a, matrix result) {
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) result[i][j] = a[j][i];
    }
}

/* x of a x = b, by elimination with the largest pivot of each column. */
static void solve(const matrix a, const matrix b, matrix x) {
    double rows[N][2 * N];
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) {
            rows[i][j] = a[i][j];
            rows[i][N + j] = b[i][j];
        }
    }
    for (int k = 0; k < N; ++k) {
        int largest = k;
        for (int i = k + 1; i < N; ++i) {
            if (fabs(rows[i][k]) > fabs(rows[largest][k])) largest = i;
        }
        for (int j = 0; j < 2 * N; ++j) {
            double other = rows[largest][j];
            rows[largest][j] = rows[k][j];
            rows[k][j] = other;
        }
        for (int i = 0; i < N; ++i) {
            if (i == k) continue;
            double factor = rows[i][k] / rows[k][k];
            for (int j = k; j < 2 * N; ++j) rows[i][j] -= factor * rows[k][j];
        }
    }
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) x[i][j] = rows[i][N + j] / rows[i][i];
    }
}

/* One doubling of a, g, h; returns the relative change of h. */
static double doubled(matrix a, matrix g, matrix h) {
    matrix joined, across, steps, spread, turned, work, more;
    product((const double(*)[N])g, (const double(*)[N])h, joined);
    for (int i = 0; i < N; ++i) joined[i][i] += 1;
    solve((const double(*)[N])joined, (const double(*)[N])a, steps);  /* (1 + g h)^-1 a */
    solve((const double(*)[N])joined, (const double(*)[N])g, spread); /* (1 + g h)^-1 g */
    transpose((const double(*)[N])a, turned);
    product((const double(*)[N])turned, (const double(*)[N])h, work);
    product((const double(*)[N])work, (const double(*)[N])steps, more);
    product((const double(*)[N])a, (const double(*)[N])spread, work);
    product((const double(*)[N])work, (const double(*)[N])turned, across);
    product((const double(*)[N])a, (const double(*)[N])steps, work);
    double new = 0, size = 0;
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) {
            a[i][j] = work[i][j];
            g[i][j] += across[i][j];
            h[i][j] += more[i][j];
            new = fmax(new, fabs(more[i][j]));
            size = fmax(size, fabs(h[i][j]));
        }
    }
    return new / size;
}

regulator regulator_of(const double transition[4][4], const double input[4], const double weights[4], double effort) {
    matrix a, g, h;
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) {
            a[i][j] = transition[i][j];
            g[i][j] = input[i] * input[j] / effort;
            h[i][j] = i == j ? weights[i] : 0;
        }
    }
    /* After n doublings h is the cost of 2^n steps. */
    for (int n = 0; n < 40; ++n) {
        if (!(doubled(a, g, h) > 1e-17)) break;
    }
    regulator found;
    double carried[N], stiffness = effort;
    for (int j = 0; j < N; ++j) {
        carried[j] = 0;
        for (int i = 0; i < N; ++i) carried[j] += input[i] * h[i][j];
    }
    for (int i = 0; i < N; ++i) stiffness += carried[i] * input[i];
    for (int j = 0; j < N; ++j) {
        double sum = 0;
        for (int i = 0; i < N; ++i) {
            sum += carried[i] * transition[i][j];
            found.cost[i][j] = h[i][j];
        }
        found.gain[j] = sum / stiffness;
    }
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) {
            found.closed[i][j] = transition[i][j] - input[i] * found.gain[j];
        }
    }
    return found;
}
