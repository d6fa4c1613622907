/* One explicit step of Dormand and Prince's pair. */
#ifndef DSE_COSIM_EXCHANGE_EXPLICIT_H
#define DSE_COSIM_EXCHANGE_EXPLICIT_H

#include "../../fmu/runtime/dormand_prince_tableau.h"
#include "exchange_crossings.h"

/* How large an error of state *k* may be; the absolute part is what FMI 2.0.4 proposes where it speaks of nominals. */
static inline double allowed(const Exchange *x, int64_t k, double one, double other)
{
    return x->tolerance * (0.01 * x->nominals[k] + fmax(fabs(one), fabs(other)));
}

/* Largest of the errors, in parts of what is allowed; infinite if one is not a number. */
static double error_norm(const Exchange *x, const double *error)
{
    double largest = 0.0;
    for (int64_t k = 0; k < x->n_states; k++) {
        const double part = fabs(error[k]) / allowed(x, k, x->from[k], x->to[k]);
        if (isnan(part))
            return INFINITY;
        largest = fmax(largest, part);
    }
    return largest;
}

/* From *from*, whose derivatives are *slope*, over *width* to *to*, where the FMU then stands. *error* in parts of
 * what is allowed. */
static Answer try_explicit(System *system, const Element *element, double *error)
{
    Exchange *x = element->exchange;
    const double width = x->width;
    copy_values(x->stage[0], x->slope, x->n_states);
    for (int64_t j = 1; j < 7; j++) {
        double *states = j == 6 ? x->to : x->trial;
        for (int64_t k = 0; k < x->n_states; k++) {
            double sum = 0.0;
            for (int64_t i = 0; i < j; i++)
                sum += dse_dp_weight[j][i] * x->stage[i][k];
            states[k] = x->from[k] + width * sum;
        }
        const double time = j < 5 ? x->start + dse_dp_node[j] * width : x->end;
        Answer answer = find_slope(system, element, time, states, x->stage[j]);
        if (answer == DONE)
            answer = sample(system, element, dse_dp_node[j]);
        if (answer != DONE)
            return answer;
    }
    for (int64_t k = 0; k < x->n_states; k++) {
        double sum = 0.0;
        for (int64_t i = 0; i < 7; i++)
            sum += dse_dp_error[i] * x->stage[i][k];
        x->found[k] = width * sum;
    }
    *error = error_norm(x, x->found);
    return DONE;
}

/* |h lambda| of the fastest mode, from the last two stages (Hairer, Wanner II, IV.2, 2.26); trial is the sixth. */
static double explicit_stiffness(const Exchange *x)
{
    double above = 0.0, below = 0.0;
    for (int64_t k = 0; k < x->n_states; k++) {
        const double scale = allowed(x, k, x->from[k], x->to[k]);
        const double slopes = (x->stage[6][k] - x->stage[5][k]) / scale, states = (x->to[k] - x->trial[k]) / scale;
        above += slopes * slopes;
        below += states * states;
    }
    return below > 0.0 ? x->width * sqrt(above / below) : 0.0;
}

static void prepare_explicit(Exchange *x)
{
    const double width = x->width;
    for (int64_t k = 0; k < x->n_states; k++) {
        const double gain = x->to[k] - x->from[k], bend = width * x->stage[0][k] - gain;
        double sum = 0.0;
        for (int64_t i = 0; i < 7; i++)
            sum += dse_dp_dense[i] * x->stage[i][k];
        x->dense[0][k] = gain;
        x->dense[1][k] = bend;
        x->dense[2][k] = gain - width * x->stage[6][k] - bend;
        x->dense[3][k] = width * sum;
    }
}

static void explicit_states(const Exchange *x, double part, double *states)
{
    const double rest = 1.0 - part;
    for (int64_t k = 0; k < x->n_states; k++)
        states[k] =
            x->from[k] +
            part * (x->dense[0][k] + rest * (x->dense[1][k] + part * (x->dense[2][k] + rest * x->dense[3][k])));
}

#endif
