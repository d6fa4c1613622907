/* The relations of the equations: their crossing functions, and whether they have changed. */
#ifndef DSE_RELATIONS_H
#define DSE_RELATIONS_H

#include "evaluate.h"

/* The truth values of the relations in a look. */
static inline uint8_t *dse_truth_in(double look[]) { return (uint8_t *)(look + DSE_RELATIONS); }

/* Evaluate the relations for the values in v. */
static inline bool dse_see(dse_component *m, double look[]) {
    const int code = model_relations(m, look, dse_truth_in(look));
    return code == 0 || dse_trouble(m, code, 0);
}

static inline bool dse_is_other(const dse_component *m, const double look[], int64_t relation) {
    return ((const uint8_t *)(look + DSE_RELATIONS))[relation] != m->held[relation];
}

static inline bool dse_differs(const dse_component *m, const double look[]) {
    return DSE_RELATIONS > 0 && memcmp(look + DSE_RELATIONS, m->held, DSE_RELATIONS) != 0;
}

/* Absolute value of the crossing function, positive while the relation has the value that the equations use, and never
 * zero: its sign changes exactly at events. */
static inline double dse_indicator(const dse_component *m, uint32_t relation, const double look[]) {
    const double size = fmax(fabs(look[relation]), DBL_MIN);
    return dse_is_other(m, look, relation) ? -size : size;
}

/* Event indicator *number*: those of the relations, then of the selections. */
static inline double dse_event_indicator(const dse_component *m, int number, const double look[]) {
    return number < DSE_RELATIONS ? dse_indicator(m, (uint32_t)number, look)
                                  : dse_selection_indicator(m, (uint32_t)(number - DSE_RELATIONS));
}

#endif
