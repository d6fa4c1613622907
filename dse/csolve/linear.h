/* Small dense linear systems: LU factors with partial pivoting of equilibrated rows (Golub and Van Loan, 3.4-3.5). */
#ifndef DSE_CSOLVE_LINEAR_H
#define DSE_CSOLVE_LINEAR_H

#include <float.h>
#include <math.h>
#include <stdint.h>

/* Part of a column's largest entry below which a pivot counts as zero with rounding. */
#define DSE_SINGULAR_BELOW (4.0 * DBL_EPSILON)

/* Replace the *size* x *size* matrix, row by row, by its factors. Rows are compared after scaling by *scale*, or
 * unscaled. A pivot must be greater than the *least* of its column, or than zero. Returns nonzero if a pivot is not. */
static inline int dse_eliminate(uint32_t size, double *matrix, uint32_t pivot[], double *scale, const double *least) {
    for (uint32_t step = 0; step < size; step++) {
        uint32_t best = step;
        double largest = -1.0;
        for (uint32_t row = step; row < size; row++) {
            const double entry = fabs(matrix[row * size + step]) * (scale ? scale[row] : 1.0);
            if (entry > largest) {
                largest = entry;
                best = row;
            }
        }
        if (!(largest > (least ? least[step] : 0.0) && largest <= DBL_MAX)) {
            return 1;
        }
        pivot[step] = best;
        if (best != step) {
            for (uint32_t column = 0; column < size; column++) {
                const double kept = matrix[step * size + column];
                matrix[step * size + column] = matrix[best * size + column];
                matrix[best * size + column] = kept;
            }
            if (scale) {
                scale[best] = scale[step];
            }
        }
        const double *top = matrix + step * size;
        for (uint32_t row = step + 1; row < size; row++) {
            double *below = matrix + row * size;
            if (below[step] != 0.0) {
                const double factor = below[step] / top[step];
                below[step] = factor;
                for (uint32_t column = step + 1; column < size; column++) {
                    below[column] -= factor * top[column];
                }
            }
        }
    }
    return 0;
}

/* Replace the *size* x *size* matrix, row by row, by its factors. Rows are scaled by their largest entry; a pivot is
 * compared with the original entries of its column. So the units of the equations and of the unknowns have no effect.
 * Returns nonzero if the matrix is singular up to rounding, or not finite. */
static inline int dse_factorize(uint32_t size, double *matrix, uint32_t pivot[]) {
    double scale[size > 0 ? size : 1], least[size > 0 ? size : 1];
    for (uint32_t row = 0; row < size; row++) {
        double largest = 0.0;
        for (uint32_t column = 0; column < size; column++) {
            const double entry = fabs(matrix[row * size + column]);
            largest = entry > largest || entry != entry ? entry : largest;
        }
        if (!(largest > 0.0 && largest <= DBL_MAX)) {
            return 1;
        }
        scale[row] = 1.0 / largest;
    }
    for (uint32_t column = 0; column < size; column++) {
        double largest = 0.0;
        for (uint32_t row = 0; row < size; row++) {
            largest = fmax(largest, fabs(matrix[row * size + column]) * scale[row]);
        }
        least[column] = DSE_SINGULAR_BELOW * largest;
    }
    return dse_eliminate(size, matrix, pivot, scale, least);
}

/* *right* becomes the solution for the matrix whose factors these are. */
static inline void dse_substitute(uint32_t size, const double *factors, const uint32_t pivot[], double right[]) {
    for (uint32_t row = 0; row < size; row++) {
        const double kept = right[pivot[row]];
        right[pivot[row]] = right[row];
        right[row] = kept;
    }
    for (uint32_t row = 1; row < size; row++) {
        double sum = right[row];
        for (uint32_t column = 0; column < row; column++) {
            sum -= factors[row * size + column] * right[column];
        }
        right[row] = sum;
    }
    for (uint32_t row = size; row-- > 0;) {
        double sum = right[row];
        for (uint32_t column = row + 1; column < size; column++) {
            sum -= factors[row * size + column] * right[column];
        }
        right[row] = sum / factors[row * size + row];
    }
}

/* *right* becomes the solution; *matrix* is overwritten. Nonzero if the matrix is singular: *right* is unchanged. */
static inline int dse_solve(uint32_t size, double *matrix, double right[]) {
    uint32_t pivot[size > 0 ? size : 1];
    if (dse_factorize(size, matrix, pivot)) {
        return 1;
    }
    dse_substitute(size, matrix, pivot, right);
    return 0;
}

#endif
