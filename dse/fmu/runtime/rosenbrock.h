/* One stiff step: Rodas5P, a Rosenbrock method of order 5(4), L-stable and stiffly accurate, with dense output of order
 * 4 (Steinebach: Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia
 * Differential Equations package, BIT Numer. Math. 63:27, 2023). The Jacobian is made of differences. */
#ifndef DSE_ROSENBROCK_H
#define DSE_ROSENBROCK_H

#include "crossings.h"
#include "linear.h"

#define DSE_RO_ORDER 5.0

#if DSE_HAS_STIFF
static const double dse_ro_gamma = 0.21193756319429014;
static const double dse_ro_node[8] = {
    0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0};
static const double dse_ro_time[8] = {0.21193756319429014, -0.42387512638858027, -0.3384627126235924,
    1.8046452872882734, 2.325825639765069, 0.0, 0.0, 0.0};
static const double dse_ro_weight[8][7] = {
    {0.0},
    {3.0},
    {2.849394379747939, 0.45842242204463923},
    {-6.954028509809101, 2.489845061869568, -10.358996098473584},
    {2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641},
    {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946},
    {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946, 1.0},
    {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946, 1.0, 1.0},
};
static const double dse_ro_shift[8][7] = {
    {0.0},
    {-14.155112264123755},
    {-17.97296035885952, -2.859693295451294},
    {147.12150275711716, -1.41221402718213, 71.68940251302358},
    {165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306},
    {24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471},
    {30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623,
        -28.087943162872662},
    {37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047, -40.06618937091002,
        -54.66780262877968, -9.48861652309627},
};
static const double dse_ro_dense[3][8] = {
    {25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204, 0.524948541321073,
        1.1241088310450404, 0.4272876194431874, -0.17202221070155493},
    {-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796, 20.176138334709044,
        15.98066361424651, -6.789040303419874, -6.710236069923372},
    {11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643, -52.072871366152654,
        -59.78993625266729, -0.15582684282751913, 4.883087185713722},
};

/* Derivatives of the slope by the states and by time, at s->start; each difference leads the way the state goes,
 * or the other where the model has no values there. */
static bool dse_ro_differentiate(dse_component *m) {
    struct dse_solver *s = &m->solver;
    double slope[DSE_N];
    memcpy(s->trial, s->from, sizeof s->from);
    for (int column = 0; column < DSE_STATES; column++) {
        double size = sqrt(DBL_EPSILON) * fmax(fabs(s->from[column]), 1e-3 * dse_nominals[column]);
        size = s->slope[column] < 0.0 ? -size : size;
        s->trial[column] = s->from[column] + size;
        if (!dse_slope(m, s->start, s->trial, slope)) {
            dse_forgive(m);
            s->trial[column] = s->from[column] - size;
            if (!dse_slope(m, s->start, s->trial, slope)) {
                return false;
            }
        }
        const double moved = s->trial[column] - s->from[column];
        for (int row = 0; row < DSE_STATES; row++) {
            s->jacobian[row * DSE_STATES + column] = (slope[row] - s->slope[row]) / moved;
        }
        s->trial[column] = s->from[column];
    }
    const double later = s->start + sqrt(DBL_EPSILON * fmax(1e-5, fabs(s->start)));
    if (!dse_slope(m, later, s->from, slope)) {
        return false;
    }
    for (int row = 0; row < DSE_STATES; row++) {
        s->time_slope[row] = (slope[row] - s->slope[row]) / (later - s->start);
    }
    s->has_jacobian = 1;
    s->jacobians++;
    return true;
}

/* As dse_dp_try; in the end v is that of s->to, and its derivatives are s->stage[0]. */
static void dse_ro_try(dse_component *m, double *error) {
    struct dse_solver *s = &m->solver;
    const double width = s->width;
    double slope[DSE_N];
    *error = INFINITY;
    if (!s->has_jacobian && !dse_ro_differentiate(m)) {
        return;
    }
    for (int k = 0; k < DSE_STATES * DSE_STATES; k++) {
        s->factors[k] = -s->jacobian[k];
    }
    for (int k = 0; k < DSE_STATES; k++) {
        s->factors[k * DSE_STATES + k] += 1.0 / (dse_ro_gamma * width);
    }
    if (dse_factorize(DSE_STATES, s->factors, s->pivot)) {
        (void)dse_trouble(m, DSE_SINGULAR, 0);
        return;
    }
    for (uint32_t j = 0; j < 8; j++) {
        const double *at = s->slope;
        if (j > 0) {
            for (int k = 0; k < DSE_STATES; k++) {
                double sum = s->from[k];
                for (uint32_t i = 0; i < j; i++) {
                    sum += dse_ro_weight[j][i] * s->stage[i][k];
                }
                s->trial[k] = sum;
            }
            if (!dse_slope(m, j < 5 ? s->start + dse_ro_node[j] * width : s->end, s->trial, slope)) {
                return;
            }
            if (j < 6 && !dse_sample(m, dse_ro_node[j])) {
                return;
            }
            at = slope;
        }
        for (int k = 0; k < DSE_STATES; k++) {
            double sum = 0.0;
            for (uint32_t i = 0; i < j; i++) {
                sum += dse_ro_shift[j][i] * s->stage[i][k];
            }
            s->stage[j][k] = at[k] + sum / width + width * dse_ro_time[j] * s->time_slope[k];
        }
        dse_substitute(DSE_STATES, s->factors, s->pivot, s->stage[j]);
    }
    for (int k = 0; k < DSE_STATES; k++) {
        s->to[k] = s->trial[k] + s->stage[7][k];
    }
    *error = dse_error_norm(m, s->stage[7]);
}

static void dse_ro_prepare(dse_component *m) {
    struct dse_solver *s = &m->solver;
    for (int k = 0; k < DSE_STATES; k++) {
        for (uint32_t row = 0; row < 3; row++) {
            double sum = 0.0;
            for (uint32_t i = 0; i < 8; i++) {
                sum += dse_ro_dense[row][i] * s->stage[i][k];
            }
            s->dense[row][k] = sum;
        }
        s->dense[3][k] = s->to[k] - s->from[k]; /* an event moves s->to */
    }
}

static inline void dse_ro_states(const dse_component *m, double part, double states[]) {
    const struct dse_solver *s = &m->solver;
    const double rest = 1.0 - part;
    for (int k = 0; k < DSE_STATES; k++) {
        const double bend = s->dense[0][k] + part * (s->dense[1][k] + part * s->dense[2][k]);
        states[k] = s->from[k] + part * (s->dense[3][k] + rest * bend);
    }
}

#if DSE_SOLVER == DSE_AUTO_SOLVER
/* h times a bound of the fastest mode's rate: the lesser of the greatest sums of a row and of a column. */
static double dse_ro_stiffness(const dse_component *m) {
    const struct dse_solver *s = &m->solver;
    double by_row = 0.0, by_column = 0.0;
    for (int k = 0; k < DSE_STATES; k++) {
        double row = 0.0, column = 0.0;
        for (int j = 0; j < DSE_STATES; j++) {
            const double scale = dse_nominals[j] / dse_nominals[k];
            row += fabs(s->jacobian[k * DSE_STATES + j]) * scale;
            column += fabs(s->jacobian[j * DSE_STATES + k]) / scale;
        }
        by_row = fmax(by_row, row);
        by_column = fmax(by_column, column);
    }
    return s->width * fmin(by_row, by_column);
}
#endif
#endif

#endif
