/* The relations of the equations: where their crossing functions stand, and whether they are still what they were. */
#ifndef DSE_RELATIONS_H
#define DSE_RELATIONS_H

#include "evaluate.h"

/* The truth of the relations in a look at them. */
static inline uint8_t *dse_truth_in(double look[]) { return (uint8_t *)(look + DSE_RELATIONS); }

/* Look at the relations, from what stands in v. */
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

/* As large as the crossing function, positive as long as the relation is what the equations hold it for, and never
 * zero: it changes its sign when, and only when, there is an event. */
static inline double dse_indicator(const dse_component *m, uint32_t relation, const double look[]) {
    const double size = fmax(fabs(look[relation]), DBL_MIN);
    return dse_is_other(m, look, relation) ? -size : size;
}

#endif
