/* One stiff step of Rodas5P. The Jacobian comes from the FMU if it provides directional derivatives, else from
 * differences. */
#ifndef DSE_COSIM_EXCHANGE_STIFF_H
#define DSE_COSIM_EXCHANGE_STIFF_H

#include "../../fmu/runtime/linear.h"
#include "../../fmu/runtime/rosenbrock_tableau.h"
#include "exchange_explicit.h"

#include <float.h>

static void put_column(Exchange *x, int64_t column, double moved)
{
    const int64_t n = x->n_states;
    for (int64_t row = 0; row < n; row++)
        x->jacobian[row * n + column] = (x->found[row] - x->slope[row]) / moved;
}

/* The difference leads the way the state goes, or the other where the FMU has no values there. */
static Answer difference_column(System *system, const Element *element, int64_t column)
{
    Exchange *x = element->exchange;
    const double size = sqrt(DBL_EPSILON) * fmax(fabs(x->from[column]), 1e-3 * x->nominals[column]);
    Answer answer = REFUSED;
    for (int64_t turn = 0; turn < 2 && answer == REFUSED; turn++) {
        x->trial[column] = x->from[column] + ((x->slope[column] < 0.0) == (turn == 0) ? -size : size);
        answer = find_slope(system, element, x->start, x->trial, x->found);
    }
    if (answer == DONE)
        put_column(x, column, x->trial[column] - x->from[column]);
    x->trial[column] = x->from[column];
    return answer;
}

static Answer told_column(System *system, const Element *element, int64_t column)
{
    Exchange *x = element->exchange;
    const size_t n = (size_t)x->n_states, count = (size_t)x->n_references;
    memset(x->time_slope, 0, n * sizeof(double));
    x->time_slope[column] = 1.0;
    if (!directional_derivative(system, element, x->derivative_references, count, x->state_references, count,
                                x->time_slope, n, x->found, n)) {
        const bool is_refused = system->failure.kind == BAD_STATUS && system->failure.status == FMI_DISCARD;
        return is_refused ? refuse(system, x, BAD_STATUS, FMI_DISCARD, 0) : FAILED;
    }
    for (size_t row = 0; row < n; row++) {
        if (!isfinite(x->found[row]))
            return refuse(system, x, SLOPE_NOT_FINITE, 0, (int64_t)row);
        x->jacobian[row * n + (size_t)column] = x->found[row];
    }
    return DONE;
}

/* Derivatives of the slope by the states and by time, at *start*. */
static Answer differentiate(System *system, const Element *element)
{
    Exchange *x = element->exchange;
    const int64_t n = x->n_states;
    const bool is_told = element->abilities & CAN_DIRECTIONAL;
    Answer answer = DONE;
    copy_values(x->trial, x->from, n);
    if (is_told)
        answer = put_point(system, element, x->start, x->from);
    for (int64_t column = 0; answer == DONE && column < n; column++)
        answer = is_told ? told_column(system, element, column) : difference_column(system, element, column);
    const double later = x->start + sqrt(DBL_EPSILON * fmax(1e-5, fabs(x->start)));
    if (answer == DONE)
        answer = find_slope(system, element, later, x->from, x->found);
    if (answer != DONE)
        return answer;
    for (int64_t row = 0; row < n; row++)
        x->time_slope[row] = (x->found[row] - x->slope[row]) / (later - x->start);
    x->has_jacobian = 1;
    x->now.jacobians++;
    return DONE;
}

static bool factorize(Exchange *x)
{
    const int64_t n = x->n_states;
    for (int64_t k = 0; k < n * n; k++)
        x->factors[k] = -x->jacobian[k];
    for (int64_t k = 0; k < n; k++)
        x->factors[k * n + k] += 1.0 / (dse_ro_gamma * x->width);
    return !dse_factorize((uint32_t)n, x->factors, x->pivot);
}

/* As try_explicit; in the end the FMU stands close to *to*, not there. */
static Answer try_stiff(System *system, const Element *element, double *error)
{
    Exchange *x = element->exchange;
    const double width = x->width;
    if (!x->has_jacobian) {
        const Answer answer = differentiate(system, element);
        if (answer != DONE)
            return answer;
    }
    if (!factorize(x))
        return refuse(system, x, SINGULAR, 0, 0);
    for (int64_t j = 0; j < 8; j++) {
        const double *at = x->slope;
        if (j > 0) {
            for (int64_t k = 0; k < x->n_states; k++) {
                double sum = x->from[k];
                for (int64_t i = 0; i < j; i++)
                    sum += dse_ro_weight[j][i] * x->stage[i][k];
                x->trial[k] = sum;
            }
            const double time = j < 5 ? x->start + dse_ro_node[j] * width : x->end;
            Answer answer = find_slope(system, element, time, x->trial, x->found);
            if (answer == DONE && j < 6)
                answer = sample(system, element, dse_ro_node[j]);
            if (answer != DONE)
                return answer;
            at = x->found;
        }
        for (int64_t k = 0; k < x->n_states; k++) {
            double sum = 0.0;
            for (int64_t i = 0; i < j; i++)
                sum += dse_ro_shift[j][i] * x->stage[i][k];
            x->stage[j][k] = at[k] + sum / width + width * dse_ro_time[j] * x->time_slope[k];
        }
        dse_substitute((uint32_t)x->n_states, x->factors, x->pivot, x->stage[j]);
    }
    for (int64_t k = 0; k < x->n_states; k++)
        x->to[k] = x->trial[k] + x->stage[7][k];
    *error = error_norm(x, x->stage[7]);
    return DONE;
}

static void prepare_stiff(Exchange *x)
{
    for (int64_t k = 0; k < x->n_states; k++) {
        for (int64_t row = 0; row < 3; row++) {
            double sum = 0.0;
            for (int64_t i = 0; i < 8; i++)
                sum += dse_ro_dense[row][i] * x->stage[i][k];
            x->dense[row][k] = sum;
        }
        x->dense[3][k] = x->to[k] - x->from[k]; /* an event moves *to* */
    }
}

static void stiff_states(const Exchange *x, double part, double *states)
{
    const double rest = 1.0 - part;
    for (int64_t k = 0; k < x->n_states; k++) {
        const double bend = x->dense[0][k] + part * (x->dense[1][k] + part * x->dense[2][k]);
        states[k] = x->from[k] + part * (x->dense[3][k] + rest * bend);
    }
}

/* h times a bound of the fastest mode's rate: the lesser of the greatest sums of a row and of a column. */
static double stiff_stiffness(const Exchange *x)
{
    const int64_t n = x->n_states;
    double by_row = 0.0, by_column = 0.0;
    for (int64_t k = 0; k < n; k++) {
        double row = 0.0, column = 0.0;
        for (int64_t j = 0; j < n; j++) {
            const double scale = x->nominals[j] / x->nominals[k];
            row += fabs(x->jacobian[k * n + j]) * scale;
            column += fabs(x->jacobian[j * n + k]) / scale;
        }
        by_row = fmax(by_row, row);
        by_column = fmax(by_column, column);
    }
    return x->width * fmin(by_row, by_column);
}

#endif
