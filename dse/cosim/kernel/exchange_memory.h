/* The kernel's data of a model exchange FMU: its functions, the state of its integration, the solvers' work space.
 * dse/cosim/binding/exchange_layout.py mirrors the structures, field by field, and allocates the work space. */
#ifndef DSE_COSIM_EXCHANGE_MEMORY_H
#define DSE_COSIM_EXCHANGE_MEMORY_H

#include "kernel.h"

/* Why an integration stopped; the failure's value is the time, its position as listed. */
enum {
    CHATTERS = 32,      /* event indicator, or -1 if none has changed */
    TOO_INACCURATE,     /* no step is small enough for the tolerance */
    TOO_MANY_STEPS,
    EVENTS_UNSETTLED,   /* the event iteration does not end */
    SLOPE_NOT_FINITE,   /* derivative of this state */
    INDICATOR_NOT_FINITE, /* event indicator */
    STATE_NOT_FINITE,   /* state, as the FMU returned it */
    COUNT_DIFFERS,      /* of states (position 0) or event indicators (1); status: the FMU's count */
    SINGULAR,           /* the stiff solver's matrix */
    EVENT_NEVER         /* the time of the next event is not a number */
};

/* Why the FMU could not be evaluated at the last tried point. */
typedef struct {
    int64_t kind, status, position, call;
} dse_reason;

#define DSE_OF_STATES(name) *name
#define DSE_OF_MATRIX(name) *name
#define DSE_OF_LOOK(name) *name
#include "csolve/memory.h"

/* State of the integration between two communication points. */
typedef struct {
    double time;       /* of the FMU */
    double next_event; /* infinite if the FMU has none */
    int64_t in_event_mode;
} Standing;

typedef struct {
    FmiFunction instantiate, enter_event_mode, update_discrete_states, enter_continuous_time, set_time, set_states,
        get_states, get_derivatives, get_indicators, completed_step, get_nominals, count_states, count_indicators;
    const uint32_t *state_references, *derivative_references; /* one pair per variable */
    int64_t n_references, n_states, n_indicators;
    int64_t needs_completed_step, has_inputs, can_be_stiff;
    Standing now, kept;
    struct dse_past kept_past;
    double *nominals;
    /* States, slope, nominals and indicators at now.time are stored one after another, in n_kept doubles. */
    double *kept_values;
    int64_t n_kept;
    struct dse_solver solver;
} Exchange;

/* Its data for the solvers. */
typedef const Element dse_problem;

static inline Exchange *exchange_of(const Element *element)
{
    return element->exchange;
}

#define DSE_STATE_COUNT(p) exchange_of(p)->n_states
#define DSE_CROSSING_COUNT(p) exchange_of(p)->n_indicators
#define DSE_LOOK_SIZE(p) exchange_of(p)->n_indicators
#define DSE_NOMINAL(p, k) exchange_of(p)->nominals[k]
#define DSE_ABSOLUTE 0.01 /* as FMI 2.0.4 proposes in its text on nominals */
#define DSE_HAS_STIFF true
#define DSE_MAY_CHOOSE(p) exchange_of(p)->can_be_stiff
/* The explicit solver's region of stability ends at 3.3, but the error control already limits it to 2.7; where accuracy
 * decides, the product is 1 or less. */
#define DSE_STIFF_FROM 2.0
#include "csolve/problem.h"

static inline int64_t number_of(const System *system, const Element *element)
{
    return element - system->elements;
}

#endif
