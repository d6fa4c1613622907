/* Tables over one and two axes, and their derivatives.
 *
 * Not smooth: linear between the points. Smooth over one axis: monotone cubic Hermite (Fritsch and Butland, SIAM J.
 * Sci. Stat. Comput. 5(2), 1984, 300-304). Smooth over two: cubic Hermite in x over cubic Hermite in y with three-point
 * parabolic slopes, linear in the values. Two points on an axis are joined by a line.
 */
#ifndef DSE_TABLES_H
#define DSE_TABLES_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* Outside the axis: the end's value; its slope continued; an error. */
enum { DSE_HOLD = 1, DSE_LINEAR = 2, DSE_NOTHING = 3 };

/* Nonzero unless there are two points or more, all finite and each greater than the one before. */
static inline int dse_axis(const double *xs, size_t count) {
    bool is_axis = count >= 2 && isfinite(xs[0]);
    for (size_t k = 1; is_axis && k < count; k++) {
        is_axis = isfinite(xs[k]) && xs[k] > xs[k - 1];
    }
    return !is_axis;
}

/* The interval that contains x; the last one includes its right end. */
static inline size_t dse_interval(double x, const double *xs, size_t count) {
    size_t low = 0, high = count - 1;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (x >= xs[middle]) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Weights of the left and right value and of the left and right slope at the part *s* of an interval. */
static inline void dse_hermite(int order, double s, double width, double basis[4]) {
    const double rest = 1.0 - s;
    if (order == 0) {
        basis[0] = (1.0 + 2.0 * s) * rest * rest;
        basis[1] = s * s * (3.0 - 2.0 * s);
        basis[2] = width * s * rest * rest;
        basis[3] = -width * s * s * rest;
    } else if (order == 1) {
        basis[0] = -6.0 * s * rest / width;
        basis[1] = -basis[0];
        basis[2] = rest * (1.0 - 3.0 * s);
        basis[3] = s * (3.0 * s - 2.0);
    } else {
        basis[0] = (12.0 * s - 6.0) / (width * width);
        basis[1] = -basis[0];
        basis[2] = (6.0 * s - 4.0) / width;
        basis[3] = (6.0 * s - 2.0) / width;
    }
}

/* Order and place where *x* may be outside: value = f(order, at) + f(1, at) * beyond, or nothing. */
struct dse_reach {
    double at, beyond;
    int order;
    bool is_zero, is_refused;
};

static inline struct dse_reach dse_reached(int order, double x, const double *xs, size_t count, int extrapolation) {
    struct dse_reach reach = {x, 0.0, order, false, false};
    if (x >= xs[0] && x <= xs[count - 1]) {
        return reach;
    }
    if (x != x || extrapolation == DSE_NOTHING) {
        reach.is_refused = true;
        return reach;
    }
    reach.at = x < xs[0] ? xs[0] : xs[count - 1];
    if (extrapolation == DSE_HOLD) {
        reach.is_zero = order > 0;
    } else {
        reach.is_zero = order > 1;
        reach.beyond = order == 0 ? x - reach.at : 0.0;
    }
    return reach;
}

static inline double dse_monotone_slope(double width, double next_width, double chord, double next_chord) {
    if (chord * next_chord <= 0.0) {
        return 0.0;
    }
    const double by_left = 2.0 * next_width + width, by_right = next_width + 2.0 * width;
    return (by_left + by_right) / (by_left / chord + by_right / next_chord);
}

static inline double dse_monotone_end(double width, double next_width, double chord, double next_chord) {
    const double slope = ((2.0 * width + next_width) * chord - width * next_chord) / (width + next_width);
    if (slope * chord <= 0.0) {
        return 0.0;
    }
    return chord * next_chord < 0.0 && fabs(slope) > 3.0 * fabs(chord) ? 3.0 * chord : slope;
}

static inline double dse_inside1(int order, double x, const double *xs, size_t count, const double *ys, int smooth) {
    const size_t k = dse_interval(x, xs, count);
    const double width = xs[k + 1] - xs[k], s = (x - xs[k]) / width;
    const double chord = (ys[k + 1] - ys[k]) / width;
    if (!smooth || count == 2) {
        return order == 0 ? (1.0 - s) * ys[k] + s * ys[k + 1] : order == 1 ? chord : 0.0;
    }
    double left, right, basis[4];
    const double width_before = k > 0 ? xs[k] - xs[k - 1] : 0.0;
    const double width_after = k + 2 < count ? xs[k + 2] - xs[k + 1] : 0.0;
    const double chord_before = k > 0 ? (ys[k] - ys[k - 1]) / width_before : 0.0;
    const double chord_after = k + 2 < count ? (ys[k + 2] - ys[k + 1]) / width_after : 0.0;
    left = k > 0 ? dse_monotone_slope(width_before, width, chord_before, chord)
                 : dse_monotone_end(width, width_after, chord, chord_after);
    right = k + 2 < count ? dse_monotone_slope(width, width_after, chord, chord_after)
                          : dse_monotone_end(width, width_before, chord, chord_before);
    dse_hermite(order, s, width, basis);
    return basis[0] * ys[k] + basis[1] * ys[k + 1] + basis[2] * left + basis[3] * right;
}

/* *y* becomes the value, or the derivative of *order* 1 or 2, at *x*; nonzero, and NaN, if x is outside and that is an
 * error, or not a number. */
static inline int dse_table1(
    double *y, int order, double x, const double *xs, size_t count, const double *ys, int smooth, int extrapolation) {
    const struct dse_reach reach = dse_reached(order, x, xs, count, extrapolation);
    if (reach.is_refused) {
        *y = NAN;
        return 1;
    }
    *y = reach.is_zero ? 0.0 : dse_inside1(reach.order, reach.at, xs, count, ys, smooth);
    if (reach.beyond != 0.0) {
        *y += dse_inside1(1, reach.at, xs, count, ys, smooth) * reach.beyond;
    }
    return 0;
}

/* Weights of the values at up to four neighbouring points of an axis. */
struct dse_stencil {
    size_t first, count;
    double weight[4];
};

/* The parabola's slope at the point *at* of three, *share* times of it, added to their weights. */
static inline void dse_add_slope(double share, const double *xs, int at, double weight[]) {
    const double left = xs[1] - xs[0], right = xs[2] - xs[1], both = left + right;
    const double by_left = (at == 0 ? left + both : at == 1 ? right : -right) / both;
    const double by_right = 1.0 - by_left;
    weight[0] -= share * by_left / left;
    weight[1] += share * (by_left / left - by_right / right);
    weight[2] += share * by_right / right;
}

static inline void dse_add_weights(
    struct dse_stencil *stencil, double share, int order, double x, const double *xs, size_t count, int smooth) {
    const size_t k = dse_interval(x, xs, count);
    const double width = xs[k + 1] - xs[k], s = (x - xs[k]) / width;
    double *weight = stencil->weight;
    double basis[4];
    if (!smooth || count == 2) {
        stencil->first = k;
        stencil->count = 2;
        weight[0] += share * (order == 0 ? 1.0 - s : order == 1 ? -1.0 / width : 0.0);
        weight[1] += share * (order == 0 ? s : order == 1 ? 1.0 / width : 0.0);
        return;
    }
    const size_t has_left = k > 0, has_right = k + 2 < count;
    dse_hermite(order, s, width, basis);
    stencil->first = k - has_left;
    stencil->count = 2 + has_left + has_right;
    weight[has_left] += share * basis[0];
    weight[has_left + 1] += share * basis[1];
    dse_add_slope(share * basis[2], xs + stencil->first, has_left ? 1 : 0, weight);
    if (has_right) {
        dse_add_slope(share * basis[3], xs + k, 1, weight + has_left);
    } else {
        dse_add_slope(share * basis[3], xs + k - 1, 2, weight);
    }
}

static inline int dse_weigh(struct dse_stencil *stencil, int order, double x, const double *xs, size_t count,
    int smooth, int extrapolation) {
    const struct dse_reach reach = dse_reached(order, x, xs, count, extrapolation);
    memset(stencil, 0, sizeof *stencil);
    if (reach.is_refused) {
        return 1;
    }
    if (!reach.is_zero) {
        dse_add_weights(stencil, 1.0, reach.order, reach.at, xs, count, smooth);
    }
    if (reach.beyond != 0.0) {
        dse_add_weights(stencil, reach.beyond, 1, reach.at, xs, count, smooth);
    }
    return 0;
}

/* *z* becomes the value, or the derivative of these orders, at (x, y) of the values zs[i * y_count + j] at (xs[i],
 * ys[j]); nonzero, and NaN, if the point is outside and that is an error, or not a number. */
static inline int dse_table2(double *z, int order_x, int order_y, double x, double y, const double *xs, size_t x_count,
    const double *ys, size_t y_count, const double *zs, int smooth, int extrapolation) {
    struct dse_stencil by_x, by_y;
    if (dse_weigh(&by_x, order_x, x, xs, x_count, smooth, extrapolation)
        || dse_weigh(&by_y, order_y, y, ys, y_count, smooth, extrapolation)) {
        *z = NAN;
        return 1;
    }
    double sum = 0.0;
    for (size_t i = 0; i < by_x.count; i++) {
        const double *row = zs + (by_x.first + i) * y_count + by_y.first;
        double along = 0.0;
        for (size_t j = 0; j < by_y.count; j++) {
            along += by_y.weight[j] * row[j];
        }
        sum += by_x.weight[i] * along;
    }
    *z = sum;
    return 0;
}

#endif
