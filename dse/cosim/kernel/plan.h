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

#define NOTICED 1e-6 /* of an output's size: far above what FMUs that iterate inside leave, far below what a lie does */

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
    double *room;           /* 5 n_torn doubles */
    double *rows, *order, *way; /* of the real ones: factors, pivots, and what is left to go */
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
    Walk doubtful; /* reads of what was not right in the initial walk if an FMU's dependencies are not true */
    Walk untold;   /* the initial walk that believes no FMU; empty until it is needed */
    const int32_t *doubted; /* where those outputs lie, continuous numbers first */
    int64_t n_doubted_reals, n_doubted;
    const double *doubted_nominals; /* of the continuous ones */
    double *passed_on;              /* room for n_doubted */
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
    double *met; /* effort and flow of each bond where their elements' steps began */
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

/* An FMU discards a step that is too long, and values that are out of its domain. */
static bool is_discarded(const System *system)
{
    return system->failure.kind == BAD_STATUS && system->failure.status == FMI_DISCARD;
}

/* In the middle of its own step an element is ahead of the others: it neither takes nor shows anything. */
static bool is_ahead(const Plan *plan, int64_t element)
{
    return plan->k % plan->paces[element].every != 0;
}

/* The first of *count* values that is not finite fails; positions[i] is where it lies. */
RARE static bool fail_not_finite(System *system, const int32_t *positions, int64_t count)
{
    int64_t i = 0;
    while (i < count - 1 && fabs(system->values[positions[i]]) <= DBL_MAX)
        i++;
    return fail(system, NOT_FINITE, 0, positions[i], system->values[positions[i]]);
}

static bool are_finite(const System *system, const int32_t *positions, int64_t count)
{
    bool are = true;
    for (int64_t i = 0; i < count; i++)
        are &= fabs(system->values[positions[i]]) <= DBL_MAX;
    return are;
}

/* What is passed on must be finite; on the way round a *loop* that is yet to be solved it need not. */
static bool do_walk(System *system, Walk walk, bool in_loop)
{
    const Plan *plan = system->plan;
    for (const Operation *operation = walk.begin; operation < walk.end; operation++) {
        if (operation->kind == SOLVE) {
            const Loop *loop = operation->loop;
            if (!solve(system, operation->loop))
                return false;
            if (!are_finite(system, loop->torn, loop->n_torn))
                return fail_not_finite(system, loop->torn, loop->n_torn);
            continue;
        }
        if (is_ahead(plan, operation->element))
            continue;
        Element *element = &system->elements[operation->element];
        if (operation->kind == READ) {
            if (!read_element(system, element, &operation->groups))
                return false;
            continue;
        }
        const int32_t *sources = plan->sources + operation->first;
        gather(plan->staged + operation->first, system->values, sources, operation->count);
        if (!in_loop && !are_finite(system, sources, operation->count))
            return fail_not_finite(system, sources, operation->count);
        if (!write_element(system, element, &operation->groups))
            return false;
    }
    return true;
}

/* ---- the initialization ---- */

static bool differs(double a, double b, double size)
{
    const double magnitude = fabs(a) > fabs(b) ? fabs(a) : fabs(b);
    return a != b && !(fabs(a - b) <= NOTICED * (magnitude > size ? magnitude : size)) && (a == a || b == b);
}

/* Whether outputs are not what the initial walk passed on: they depend on inputs of which their FMU does not tell. */
static bool look_again(System *system, bool *is_misled)
{
    const Plan *plan = system->plan;
    const int64_t texts = system->texts_changed;
    gather(plan->passed_on, system->values, plan->doubted, plan->n_doubted);
    if (!do_walk(system, plan->doubtful, false))
        return false;
    *is_misled = system->texts_changed != texts;
    for (int64_t i = 0; i < plan->n_doubted; i++) {
        const double value = system->values[plan->doubted[i]];
        *is_misled |= i < plan->n_doubted_reals ? differs(value, plan->passed_on[i], plan->doubted_nominals[i])
                                                : value != plan->passed_on[i];
    }
    return true;
}

/* Carry values along the wires, before t = 0; if an FMU's dependencies prove untrue, once more as if none were told. */
static bool initialize(System *system)
{
    Plan *plan = system->plan;
    bool is_misled = false;
    plan->k = 0;
    if (!do_walk(system, plan->initial, false))
        return false;
    if (plan->doubtful.begin < plan->doubtful.end && !look_again(system, &is_misled))
        return false;
    if (!is_misled)
        return true;
    return plan->untold.begin < plan->untold.end ? do_walk(system, plan->untold, false) : fail(system, MISLED, 0, 0, 0);
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
        /* Gauss and Seidel pass on what nobody has looked at yet; with error control a shorter step may still do. */
        const int32_t *sources = plan->sources + pace->inputs.first;
        if (plan->is_sequential && !(plan->tolerance > 0.0) && !are_finite(system, sources, pace->inputs.count))
            return fail_not_finite(system, sources, pace->inputs.count);
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
 * variable means anything there. One that begins with such a value is judged by its beginning, and one whose FMU
 * declares no nominal value (infinite here) is not judged: nobody knows what is large for it. */
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

/* What the element behind an output did with an input in its step that ends here, if one does: both on average, as at the
 * step's end alone they would differ even if nothing were lost. *met* is the output at the step's beginning. */
static double work(const System *system, int64_t output, int64_t input, double length, double *met)
{
    const Plan *plan = system->plan;
    const int32_t element = plan->owners[output];
    if (is_ahead(plan, element))
        return 0.0;
    const double mean = 0.5 * (*met + system->values[output]);
    *met = system->values[output];
    return (double)plan->paces[element].every * length * plan->used[input] * mean;
}

/* Carry values on at the communication point at *time*, after a step of *length* (0 for none). */
static bool meet(System *system, double time, double length)
{
    const Plan *plan = system->plan;
    system->now = time;
    if (!all_watched_finite(system))
        return false;
    if (plan->meeting.begin < plan->meeting.end && (!do_walk(system, plan->meeting, false) || !all_watched_finite(system)))
        return false;
    for (int64_t i = 0; i < plan->n_bonds; i++) {
        const Bond *bond = &plan->bonds[i];
        plan->energies[i] += work(system, bond->flow, bond->effort_used, length, plan->met + 2 * i + 1);
        plan->energies[i] -= work(system, bond->effort, bond->flow_used, length, plan->met + 2 * i);
    }
    return true;
}

#endif
