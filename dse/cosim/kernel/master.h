/* The loop over communication points for systems that are not plain. */
#ifndef DSE_COSIM_MASTER_H
#define DSE_COSIM_MASTER_H

#include "adaptive.h"
#include "fused.h"

/* A hash of the values that every element shows. */
RARE static void digest(const System *system, uint64_t *digests)
{
    for (int64_t e = 0; e < system->n_elements; e++) {
        const Element *element = &system->elements[e];
        uint64_t hash = 0x9E3779B97F4A7C15u;
        for (int64_t i = element->first_value; i < element->first_value + element->n_values; i++) {
            uint64_t bits;
            memcpy(&bits, &system->values[i], sizeof bits);
            hash = (hash ^ bits) * 0xD6E8FEB86659FD93u;
            hash ^= hash >> 32;
        }
        digests[e] = hash;
    }
}

static void record(System *system, const Request *request, int64_t k)
{
    const Plan *plan = system->plan;
    double *row = request->out + k * request->n_record;
    gather(row, system->values, request->record, request->n_record);
    for (const BondColumn *place = plan->bond_columns; place < plan->bond_columns + plan->n_bond_columns; place++)
        row[place->column] = plan->energies[place->bond];
    for (const CountColumn *place = plan->count_columns; place < plan->count_columns + plan->n_count_columns; place++)
        row[place->column] = (double)*place->counter;
    system->rows = k + 1;
    if (request->digests)
        digest(system, request->digests + k * system->n_elements);
}

/* Discard the data of the previous run. */
static void forget(const Plan *plan)
{
    memset(plan->past, 0, (size_t)plan->n_past * sizeof(double));
    for (const CountColumn *place = plan->count_columns; place < plan->count_columns + plan->n_count_columns; place++)
        *place->counter = 0;
    if (plan->tolerance > 0.0)
        memset(plan->magnitudes, 0, (size_t)plan->n_compared * sizeof(double));
}

APART static bool simulate_by_plan(System *system, const Request *request)
{
    Plan *plan = system->plan;
    int64_t level = 0, k = system->fused_steps = 0;
    double length = 0.0;
    forget(plan);
    system->may_roll_back = plan->tolerance > 0.0;
    system->now = 0.0;
    if (system->fused && plan->is_sequential && !request->digests && !system->watches) {
        if (!simulate_fused_in_turn(system, request, &k))
            return false;
    } else {
        for (int64_t e = 0; e < system->n_elements; e++)
            if (!read_element(system, &system->elements[e], &system->elements[e].outputs))
                return false;
    }
    for (;; k++) {
        system->progress->step = plan->k = k;
        const double time = (double)k * request->step;
        if (plan->n_groups && !tick_all(system, time)) {
            /* A requested end here applies to all elements: they have reached this row. */
            if (!k || !is_asked_to_end(system))
                return false;
            system->has_ended = true;
        }
        if (!meet(system, time, length))
            return false;
        record(system, request, k);
        if (k == request->steps || system->has_ended)
            return true;
        if (plan->tolerance > 0.0) {
            note_magnitudes(system);
            if (!advance_adaptively(system, time, request->step, &level, &length))
                return false;
        } else {
            length = request->step;
            if (!advance(system, time, length, (double)(k + 1) * length))
                return false;
        }
    }
}

#endif
