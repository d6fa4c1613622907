/* The interface between a model made from Modelica and this runtime. Generated model.h contains, in this order:
 *
 *   the sizes   #define DSE_MODEL 1
 *               DSE_VALUES      variables, parameters, derivatives: doubles in v; Boolean 0/1, an enumeration from 1
 *               DSE_STATES      continuous states
 *               DSE_RELATIONS   event-generating comparisons
 *               DSE_CONDITIONS  conditions of when-clauses
 *               DSE_TRIGGERS    when-clauses
 *               DSE_CLOCKS      sample(phase, period)
 *               DSE_PRE         discrete variables of which pre is used
 *               DSE_DISCRETES   discrete variables; may be left out if all are in DSE_PRE
 *               DSE_ROOTS       unknowns of the nonlinear loops that derivatives and relations need;
 *                               may be left out, and dse_root with it, if there are none
 *               DSE_SELECTIONS  sets of states that are selected during the run;
 *                               may be left out, and dse_selections with it, if there are none
 *               DSE_CHECKS      asserts and terminates
 *               DSE_DATA        doubles of tables that are made from parameters: m->data
 *               DSE_LARGEST_SYSTEM     unknowns of the largest Newton or linear system
 *               DSE_SOLVER             DSE_AUTO_SOLVER, DSE_EXPLICIT_SOLVER or DSE_STIFF_SOLVER
 *               DSE_DEFAULT_TOLERANCE  relative; the absolute one of a state is this times its nominal value
 *               Any size may be 0; an array then has one unused element.
 *   #include "modelica.h"
 *   the data    static const uint32_t dse_state[], dse_derivative[];      places in v, one each a state
 *               static const uint32_t dse_root[];                         of the loops' unknowns
 *               static const char *const dse_state_names[];
 *               static const uint32_t dse_discrete[];                     place in v of pre[k]
 *               static const char *const dse_failure[];    message when a function returns 1 + index
 *               static const char *const dse_relations[];  "file:line: h <= 0", one each a relation
 *               static const struct dse_clock dse_clocks[];
 *               static const struct dse_selection dse_selections[];
 *               #define DSE_SLOT_COUNT ...u
 *               static const struct dse_slot dse_slots[] = {DSE_VALUE(place, kind, role, items), ...};
 *               static const char *const dse_names[];      the position is the value reference
 *   the functions, all static; int: 0, or 1 + index into dse_failure:
 *     int model_parameters(m)    dependent parameters and m->data from the set ones; checks the tables' axes
 *     int model_guess(m)         unknowns, states and discretes before the initialization
 *     int model_initial(m)       one pass of the initial blocks, discretes and conditions (is_true) included
 *     int model_derivatives(m)   from time, states, inputs, parameters, discretes, held: data for states and relations
 *     int model_outputs(m)       the rest, after model_derivatives
 *     void model_aliases(m)      negated aliases into their places, after model_outputs
 *     int model_event(m)         one pass of the event blocks, given pre, held, was_true, ticks: all values, continuous
 *                                and discrete; is_true and is_active
 *     int model_reinitialize(m)  after each pass: reinit of active triggers; 1 if a state was written, else 0; negative
 *                                after an error. All values are computed before the first is written
 *     int model_relations(m, double crossing[], uint8_t truth[])     left - right, and the comparisons themselves
 *     int model_check(m, tell)        asserts, at accepted points, after model_outputs; 0 ok, 1 error, 2 terminate
 *     int model_event_check(m, tell)  the same for those under a trigger, after each pass
 *
 * A second file, start.c, does not use any of this. Its data may change without compiling the model again:
 *     const char dse_token[80] = "{...}";  const double dse_starts[] = {...};  const double dse_nominals[] = {...};
 */
#ifndef DSE_MODELICA_H
#define DSE_MODELICA_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "csolve/linear.h"
#include "slot.h"
#include "random.h"
#include "tables.h"

#ifndef DSE_DISCRETES
#define DSE_DISCRETES DSE_PRE
#endif

#ifndef DSE_ROOTS
#define DSE_ROOTS 0
static const uint32_t dse_root[] = {0};
#endif

#ifndef DSE_SELECTIONS
#define DSE_SELECTIONS 0
#endif
#define DSE_INDICATORS (DSE_RELATIONS + DSE_SELECTIONS)

#define DSE_AUTO_SOLVER 0
#define DSE_EXPLICIT_SOLVER 1
#define DSE_STIFF_SOLVER 2

#define DSE_TOKEN dse_token
#define DSE_TOKEN_SIZE 80
extern const char dse_token[DSE_TOKEN_SIZE];
extern const double dse_starts[];   /* of everything in v */
extern const double dse_nominals[]; /* of the states */

/* Tick k = 0, 1, ... is at (phase + k * period) / denominator seconds, never summed up, of the time or since the
 * initialization. Each number is less than 2^31,
 * so the sum is exact for 2^32 ticks. */
struct dse_clock {
    int64_t period, phase, denominator, is_from_start;
};

/* As many of *candidates* as there are *rows* of *matrix* are not states; the first *never* ones never are. The others
 * over their *units* are the states: each state has a row of *shares* in the candidates behind the first *never*. The
 * matrix has the coefficients of the candidates, and of other states behind them, to be multiplied by *weights*.
 * Candidates and states are followed by their derivatives, *levels* altogether. All but the last two are places in v;
 * *failure* is 1 + index into dse_failure. */
struct dse_selection {
    uint32_t rows, columns, count, never, levels;
    int32_t failure;
    const uint32_t *matrix, *candidates, *states, *shares;
    const double *units, *weights;
};

/* kind: REAL, INTEGER, BOOLEAN or ENUMERATION. role: INPUT, TUNABLE, FIXED (a parameter that is not tunable, or the
 * start of a state) or OUTPUT (a variable that cannot be set). */
#define DSE_VALUE(place, kind, role, items)                                                                            \
    { 8u * (place), DSE_TYPE_OF_##kind, DSE_##kind, DSE_##role, items, 1, 0, 0 }
#define DSE_TYPE_OF_REAL DSE_F64
#define DSE_TYPE_OF_INTEGER DSE_WHOLE
#define DSE_TYPE_OF_BOOLEAN DSE_WHOLE
#define DSE_TYPE_OF_ENUMERATION DSE_WHOLE

/* C has no empty arrays. */
#define DSE_ROOM(size) ((size) > 0 ? (size) : 1)

/* Why a simulation cannot continue. Positive codes are those of the model's own functions. */
enum {
    DSE_NO_TROUBLE = 0,
    DSE_NOT_FINITE = -1,     /* derivative of state number *subject* */
    DSE_SINGULAR = -2,       /* the stiff solver's matrix */
    DSE_TOO_INACCURATE = -3, /* no step is small enough for the tolerance */
    DSE_TOO_MANY_STEPS = -4,
    DSE_CHATTERS = -5,   /* relation number *subject* */
    DSE_UNSETTLED = -6,  /* the event iteration does not end */
    DSE_VIOLATED = -7,   /* an assert; its text has been reported */
    DSE_TERMINATED_BY_MODEL = -8
};

typedef struct {
    int32_t code;
    uint32_t subject;
    double time;
} dse_reason;

/* The solvers' data is a part of the component, so that it is saved and restored with it. A look at the relations:
 * their crossing functions, followed by their truth values, in bytes. */
#define DSE_HAS_STIFF (DSE_SOLVER != DSE_EXPLICIT_SOLVER)
#define DSE_N DSE_ROOM(DSE_STATES)
#define DSE_LOOK (DSE_ROOM(DSE_RELATIONS) + (DSE_RELATIONS + 7) / 8)
#define DSE_OF_STATES(name) name[DSE_N]
#define DSE_OF_MATRIX(name) name[DSE_HAS_STIFF ? DSE_N * DSE_N : 1]
#define DSE_OF_LOOK(name) name[DSE_LOOK]
#include "csolve/memory.h"

/* Numbers only, so that a copy is a saved state. */
typedef struct {
    double v[DSE_ROOM(DSE_VALUES)]; /* first, so a slot's offset is 8 * place */
    double pre[DSE_ROOM(DSE_PRE)];
    double data[DSE_ROOM(DSE_DATA)];
    double root[DSE_ROOM(DSE_ROOTS)]; /* of the last accepted point */
    double side[DSE_ROOM(DSE_SELECTIONS)]; /* the sign of the determinants of the selections there */
    double settled;                   /* its time */
    double refused;                   /* its distance from a point without values; 0 once a step has covered it */
    double time;
    double started;   /* the time of the initialization */
    double continued; /* during homotopy: its share of the actual expression */
    int64_t next_tick[DSE_ROOM(DSE_CLOCKS)];
    double before_pass[DSE_RELATIONS > 0 ? DSE_ROOM(DSE_VALUES) : 1]; /* v before a pass of the event iteration */
    uint8_t held[DSE_ROOM(DSE_RELATIONS)];      /* truth of the relations as used by the equations */
    uint8_t is_true[DSE_ROOM(DSE_CONDITIONS)];  /* in this iteration */
    uint8_t was_true[DSE_ROOM(DSE_CONDITIONS)]; /* in the iteration before */
    uint8_t is_active[DSE_ROOM(DSE_TRIGGERS)];  /* in this iteration */
    uint8_t ticks[DSE_ROOM(DSE_CLOCKS)];        /* in this iteration */
    uint8_t has_told[DSE_ROOM(DSE_CHECKS)];     /* a warning is reported once */
    struct dse_solver solver;
} dse_component;

typedef void dse_tell(dse_component *m, int check, int is_warning, const char *text);

/* Values as set from outside: all of v, but only values that can be set are read. */
typedef struct {
    double v[DSE_ROOM(DSE_VALUES)];
} dse_settings;

typedef dse_component dse_problem;
#define DSE_VALUES_OF(m) ((m)->v)
/* Newton's method may only have started too far away: a jump is allowed only after very short steps, and at an event,
 * where values that jump leave no way from root to root. */
#define DSE_NO_DISTANCE 1e-6 /* of the first distance without values */
#define DSE_MAY_JUMP(m)                                                                                                \
    ((m)->refused > 0.0 && fabs((m)->time - (m)->settled) <= DSE_NO_DISTANCE * (m)->refused)
#include "csolve/newton.h"

#endif
