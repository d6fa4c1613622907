/* States that are selected during the run (Mattsson, Olsson and Elmqvist, Dynamic selection of states in Dymola, Modelica
 * Workshop 2000). A choice is as good as the determinant of its matrix: of the coefficients, in the differentiated
 * equations, of what is no state. The best choice is found by elimination with complete pivoting. The choice is made
 * anew at an accepted point; values beyond the limit are refused like those of a loop without a solution, so that no
 * step leaps over a singularity. */
#ifndef DSE_SELECTION_H
#define DSE_SELECTION_H

#include "model.h"

#define DSE_SELECT_BELOW 0.5 /* of the best choice */
#define DSE_EVENT_BELOW 0.4  /* the same for importers, some of which look at event indicators only */
#define DSE_REFUSE_BELOW 0.1 /* of the best choice; for the best, of the product of the rows' largest entries, a row */

#if DSE_SELECTIONS > 0
/* The determinant of *s*, relative to the rows' largest entries, without the columns *barred*; *is_picked*: its columns.
 */
static double dse_select(
    const dse_component *m, const struct dse_selection *s, const uint8_t barred[], uint8_t is_picked[]) {
    double a[s->rows * s->columns], product = 1.0;
    memset(is_picked, 0, s->count);
    for (uint32_t row = 0; row < s->rows; row++) {
        double *line = a + row * s->columns, largest = 0.0;
        for (uint32_t k = 0; k < s->columns; k++) {
            line[k] = m->v[s->matrix[row * s->columns + k]] * s->weights[k];
            largest = fmax(largest, fabs(line[k]));
        }
        for (uint32_t k = 0; k < s->columns; k++) {
            line[k] /= largest;
        }
    }
    for (uint32_t done = 0; done < s->rows; done++) {
        double *top = a + done * s->columns, largest = 0.0;
        uint32_t best = 0, pivot = done;
        for (uint32_t row = done; row < s->rows; row++) {
            for (uint32_t k = 0; k < (done < s->never ? s->never : s->count); k++) {
                const double size = fabs(a[row * s->columns + k]);
                if (size > largest && !is_picked[k] && !barred[k]) {
                    largest = size;
                    best = k;
                    pivot = row;
                }
            }
        }
        if (!(largest > 0.0 && largest <= DBL_MAX)) {
            return 0.0;
        }
        product *= a[pivot * s->columns + best] * (pivot == done ? 1.0 : -1.0);
        for (uint32_t k = best; k < s->count; k++) {
            product = is_picked[k] ? -product : product; /* the columns change places too */
        }
        is_picked[best] = 1;
        for (uint32_t k = 0; k < s->columns; k++) {
            const double kept = top[k];
            top[k] = a[pivot * s->columns + k];
            a[pivot * s->columns + k] = kept;
        }
        for (uint32_t row = done + 1; row < s->rows; row++) {
            double *line = a + row * s->columns;
            const double factor = line[best] / top[best];
            for (uint32_t k = 0; k < s->columns; k++) {
                line[k] -= factor * top[k];
            }
        }
    }
    return product;
}

/* How good the present choice of *s* is, relative to the *best* one, whose columns are *is_picked*. Its sign is that of
 * the determinant: it changes only where the choice is singular. */
static double dse_share_of_best(
    const dse_component *m, const struct dse_selection *s, double *best, uint8_t is_picked[]) {
    const uint32_t states = s->count - s->rows, free = s->count - s->never;
    uint8_t barred[s->count];
    memset(barred, 0, s->count);
    const double whole = dse_select(m, s, barred, is_picked);
    *best = fabs(whole);
    for (uint32_t k = 0; k < states * free; k++) {
        barred[s->never + k % free] |= m->v[s->shares[k]] != 0.0;
    }
    if (!(*best > 0.0)) {
        return 1.0;
    }
    return (states == 0 ? whole : dse_select(m, s, barred, is_picked + s->count)) / *best;
}

/* Negative where the states of selection *number* have to be selected anew. */
static double dse_selection_indicator(const dse_component *m, uint32_t number) {
    uint8_t is_picked[2 * dse_selections[number].count];
    double best;
    return fabs(dse_share_of_best(m, dse_selections + number, &best, is_picked)) - DSE_EVENT_BELOW;
}

/* 0 if the states are well chosen for the values in v, on the side of the singularities where the last accepted point
 * is; else the failure. */
static int dse_selection_failure(const dse_component *m) {
    for (uint32_t k = 0; k < DSE_SELECTIONS; k++) {
        const struct dse_selection *s = dse_selections + k;
        uint8_t is_picked[2 * s->count];
        double best;
        const double share = dse_share_of_best(m, s, &best, is_picked);
        if (!(fabs(share) >= DSE_REFUSE_BELOW && best >= pow(DSE_REFUSE_BELOW, s->rows)) || m->side[k] * share < 0.0) {
            return s->failure;
        }
    }
    return 0;
}

/* The values in v are accepted. */
static void dse_keep_sides(dse_component *m) {
    for (uint32_t k = 0; k < DSE_SELECTIONS; k++) {
        uint8_t is_picked[2 * dse_selections[k].count];
        double best;
        m->side[k] = dse_share_of_best(m, dse_selections + k, &best, is_picked) < 0.0 ? -1.0 : 1.0;
    }
}

/* Whether another choice is due for the values in v; with *is_made* it is made, and the states get its values. */
static bool dse_is_selection_due(dse_component *m, bool is_made) {
    bool is_due = false;
    for (const struct dse_selection *s = dse_selections; s < dse_selections + DSE_SELECTIONS; s++) {
        const uint32_t states = s->count - s->rows, free = s->count - s->never;
        uint8_t is_picked[2 * s->count];
        double best;
        if (!(fabs(dse_share_of_best(m, s, &best, is_picked)) < DSE_SELECT_BELOW)) {
            continue;
        }
        is_due = true;
        for (uint32_t k = s->never, state = 0; is_made && k < s->count; k++) {
            if (is_picked[k]) {
                continue;
            }
            for (uint32_t other = 0; other < free; other++) {
                m->v[s->shares[state * free + other]] = s->never + other == k ? 1.0 / s->units[k] : 0.0;
            }
            for (uint32_t level = 0; level < s->levels; level++) {
                m->v[s->states[level * states + state]] = m->v[s->candidates[level * s->count + k]] / s->units[k];
            }
            state++;
        }
    }
    return is_due;
}
#else
static inline double dse_selection_indicator(const dse_component *m, uint32_t number) {
    (void)m, (void)number;
    return 1.0;
}

static inline int dse_selection_failure(const dse_component *m) {
    (void)m;
    return 0;
}

static inline void dse_keep_sides(dse_component *m) { (void)m; }

static inline bool dse_is_selection_due(dse_component *m, bool is_made) {
    (void)m, (void)is_made;
    return false;
}
#endif

#endif
