/* How a system is initialized and, unless it is a plain one, simulated: tables of operations that dse/cosim/plan.py
 * compiles. plan_layout.py mirrors every structure, field by field.
 *
 * Words: an element *shows* its outputs at the end of its own step; what it shows stays until it shows again. Values
 * *meet* at communication points. */
#ifndef DSE_COSIM_PLAN_H
#define DSE_COSIM_PLAN_H

#include "element.h"
#include "floating.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { READ, WRITE, SOLVE };

/* What an input does during a step. */
enum { HELD, MIDDLE, SLOPED };

typedef struct Loop Loop;

typedef struct {
    int64_t kind, element;
    Groups groups;
    int64_t first, count; /* WRITE: its part of the plan's staged inputs */
    Loop *loop;           /* SOLVE */
} Operation;

typedef struct {
    const Operation *begin, *end;
} Walk;

/* Outputs that depend on each other. From the torn ones the walk computes all, the torn ones again. */
struct Loop {
    Walk walk;
    const int32_t *torn; /* positions among the values, those of continuous numbers first */
    int64_t n_reals, n_torn;
    int64_t walks; /* so many settle a loop that is none in truth */
    int64_t number, has_texts;
    const double *nominals; /* of the real ones */
    double *room;           /* 6 n_torn + n_reals (n_reals + 2) doubles */
};

/* An element's own step: *parts* of them in one of the run's, or one in *every* of them. */
typedef struct {
    int64_t every, parts, has_slopes;
    Operation inputs; /* all of them */
} Pace;

/* Power between two elements: two values and the inputs they end at. */
typedef struct {
    int64_t effort, flow, effort_used, flow_used;
} Bond;

typedef struct {
    int64_t column, bond;
} BondColumn;

typedef struct {
    Walk initial, meeting;
    int64_t is_sequential;
    const Pace *paces;     /* one per element */
    const int32_t *owners; /* the element of each value */
    double *staged, *slopes; /* inputs as their sources have them, and how fast they change */
    const int32_t *sources;  /* staged[i] comes from values[sources[i]] */
    const int32_t *moves;    /* HELD, MIDDLE or SLOPED */
    double *used;            /* what each staged input was on average in the last step */
    const int32_t *watched; /* values that must stay finite and within their limits */
    int64_t n_watched;
    const double *nominals; /* of the watched ones */
    double *limits;
    const Bond *bonds;
    int64_t n_bonds;
    const BondColumn *bond_columns; /* where their energies are recorded */
    int64_t n_bond_columns;
    /* The past: what a rollback restores besides the values. */
    double *past;
    int64_t n_past;
    double *before;        /* the values shown before the present ones */
    double *shown, *spans; /* when each element showed its outputs, and how long after the time before */
    double *energies;
    /* Error control; *tolerance* is 0 without. */
    double tolerance, absolute, smallest;
    const int32_t *compared;
    int64_t n_compared;
    double *magnitudes, *coarse; /* of the compared ones: largest so far, found by one step */
    double *kept;                /* n_values + n_past */
    int64_t reads_again;         /* after a rollback: texts are not among the values */
    int64_t k;                   /* communication point */
} Plan;

static bool solve(System *system, Loop *loop);

/* ---- operations ---- */

static bool do_walk(System *system, Walk walk)
{
    const Plan *plan = system->plan;
    for (const Operation *operation = walk.begin; operation < walk.end; operation++) {
        if (operation->kind == SOLVE) {
            if (!solve(system, operation->loop))
                return false;
            continue;
        }
        /* In the middle of its own step an element is ahead of the others: it neither takes nor shows anything. */
        if (plan->k % plan->paces[operation->element].every)
            continue;
        Element *element = &system->elements[operation->element];
        if (operation->kind == READ) {
            if (!read_element(system, element, &operation->groups))
                return false;
            continue;
        }
        gather(plan->staged + operation->first, system->values, plan->sources + operation->first, operation->count);
        if (!write_element(system, element, &operation->groups))
            return false;
    }
    return true;
}

/* ---- one element ---- */

/* The slope of the line through the last two values that were shown, per second; 0 before there are two. */
static double slope_of(const System *system, int32_t position)
{
    const Plan *plan = system->plan;
    const double span = plan->spans[plan->owners[position]];
    return span > 0.0 ? (system->values[position] - plan->before[position]) / span : 0.0;
}

/* Stage inputs for a step of *length* at *time*, and their slopes. */
static void move_along(const System *system, const Operation *inputs, double time, double length)
{
    const Plan *plan = system->plan;
    for (int64_t i = inputs->first; i < inputs->first + inputs->count; i++) {
        const int32_t position = plan->sources[i];
        plan->staged[i] = system->values[position];
        if (plan->moves[i] == HELD)
            continue;
        const double slope = slope_of(system, position), ahead = time - plan->shown[plan->owners[position]];
        plan->staged[i] += slope * (plan->moves[i] == MIDDLE ? ahead + 0.5 * length : ahead);
        plan->slopes[i] = plan->moves[i] == SLOPED ? slope : 0.0;
    }
}

/* What inputs are on average over [time, time + length], for the bonds. */
static void note_used(const System *system, const Operation *inputs, double time, double length)
{
    const Plan *plan = system->plan;
    for (int64_t i = inputs->first; i < inputs->first + inputs->count; i++) {
        const int32_t position = plan->sources[i];
        plan->used[i] = system->values[position];
        if (plan->moves[i] != HELD)
            plan->used[i] += slope_of(system, position) * (time - plan->shown[plan->owners[position]] + 0.5 * length);
    }
}

/* Give the element its inputs and let it go from *time* over *length*, in as many steps of its own as it wants. */
static bool drive(System *system, int64_t e, double time, double length)
{
    const Plan *plan = system->plan;
    Element *element = &system->elements[e];
    const Pace *pace = &plan->paces[e];
    const double step = length / (double)pace->parts;
    if (plan->n_bonds)
        note_used(system, &pace->inputs, time, length);
    for (int64_t part = 0; part < pace->parts; part++) {
        const double begin = system->now = time + (double)part * step;
        move_along(system, &pace->inputs, begin, step);
        if (!write_element(system, element, &pace->inputs.groups) ||
            (pace->has_slopes && !give_slopes(system, element, &pace->inputs.groups, begin)) ||
            !step_element(system, element, begin, step) || (system->watches && !keeps_floating_mode(system)))
            return false;
    }
    return true;
}

/* Take the element's outputs at *time*. */
static bool show(System *system, int64_t e, double time)
{
    const Plan *plan = system->plan;
    Element *element = &system->elements[e];
    memcpy(plan->before + element->first_value, system->values + element->first_value,
           (size_t)element->n_values * sizeof(double));
    plan->spans[e] = time - plan->shown[e];
    plan->shown[e] = system->now = time;
    return read_element(system, element, &element->outputs);
}

/* ---- all elements ---- */

/* From *time* to *end*, which is *length* later; elements whose own step is *every* times as long begin or end it
 * where the number k of the communication point tells. */
static bool advance(System *system, double time, double length, double end)
{
    const Plan *plan = system->plan;
    for (int64_t e = 0; e < system->n_elements; e++) {
        const int64_t every = plan->paces[e].every;
        if (plan->k % every == 0 && !drive(system, e, time, (double)every * length))
            return false;
        if (plan->is_sequential && (plan->k + 1) % every == 0 && !show(system, e, end))
            return false;
    }
    if (!plan->is_sequential)
        for (int64_t e = 0; e < system->n_elements; e++)
            if ((plan->k + 1) % plan->paces[e].every == 0 && !show(system, e, end))
                return false;
    return true;
}

static bool all_watched_finite(System *system)
{
    const Plan *plan = system->plan;
    for (int64_t i = 0; i < plan->n_watched; i++) {
        const double value = system->values[plan->watched[i]];
        if (!(fabs(value) <= DBL_MAX))
            return fail(system, NOT_FINITE, 0, plan->watched[i], value);
    }
    return true;
}

/* A double does not tell changes of the size of a variable's nominal value any more beyond 2^53 times that value: no
 * variable means anything there. One that begins with such a value is judged by its beginning. */
static void set_limits(System *system)
{
    const Plan *plan = system->plan;
    for (int64_t i = 0; i < plan->n_watched; i++) {
        const double begin = fabs(system->values[plan->watched[i]]);
        plan->limits[i] = EXACT_INTEGER * (begin > plan->nominals[i] ? begin : plan->nominals[i]);
    }
}

/* Looked at once, at the end of a run: what has left its limits does not come back, or it was none of our business. */
static bool within_limits(System *system)
{
    const Plan *plan = system->plan;
    for (int64_t i = 0; i < plan->n_watched; i++) {
        const double value = system->values[plan->watched[i]];
        if (fabs(value) > plan->limits[i])
            return fail(system, DIVERGED, 0, plan->watched[i], value);
    }
    return true;
}

/* Carry values on at the communication point at *time*, after a step of *length* (0 for none). */
static bool meet(System *system, double time, double length)
{
    const Plan *plan = system->plan;
    system->now = time;
    if (!all_watched_finite(system))
        return false;
    if (plan->meeting.begin < plan->meeting.end && (!do_walk(system, plan->meeting) || !all_watched_finite(system)))
        return false;
    for (int64_t i = 0; i < plan->n_bonds; i++) {
        const Bond *bond = &plan->bonds[i];
        plan->energies[i] += length * (plan->used[bond->effort_used] * system->values[bond->flow] -
                                       system->values[bond->effort] * plan->used[bond->flow_used]);
    }
    return true;
}

#endif
