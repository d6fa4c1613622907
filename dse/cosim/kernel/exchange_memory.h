/* What the kernel knows of a model exchange FMU: its functions, where its integration stands, the room the solvers work
 * in. dse/cosim/binding/exchange_layout.py mirrors the structures, field by field, and sets the room up. */
#ifndef DSE_COSIM_EXCHANGE_MEMORY_H
#define DSE_COSIM_EXCHANGE_MEMORY_H

#include "access.h"

/* Why an integration stopped; the failure's value is the time, its position as told. */
enum {
    CHATTERS = 32,      /* event indicator, or -1 if none has changed */
    TOO_INACCURATE,     /* no step is small enough for the tolerance */
    TOO_MANY_STEPS,
    EVENTS_UNSETTLED,   /* the event iteration finds no end */
    SLOPE_NOT_FINITE,   /* derivative of this state */
    INDICATOR_NOT_FINITE, /* event indicator */
    STATE_NOT_FINITE,   /* state, as the FMU returned it */
    COUNT_DIFFERS,      /* of states (position 0) or event indicators (1); status: the FMU's count */
    SINGULAR,           /* the stiff solver's matrix */
    EVENT_NEVER         /* the time of the next event is not a number */
};

enum { STAGES = 8, SAMPLES = STAGES + 2, DENSE = 4 };

/* Where the integration stands between two communication points. */
typedef struct {
    double time;         /* of the FMU */
    double next_event;   /* infinite if the FMU has told of none */
    double next_width;   /* of a solver's step, proposed by the error control; 0 without experience */
    double error_before; /* of the last accepted step, for the controller */
    double last_event;   /* time of the last event that was not one of the inputs */
    int64_t events_close; /* events in a row with next to no time between them */
    int64_t in_event_mode;
    int64_t is_stiff;        /* which solver is at work */
    int64_t signs_of_other;  /* steps in a row after which the other solver would be better */
    int64_t signs_of_this;   /* steps in a row that spoke for the present one */
    int64_t steps, rejected, evaluations, jacobians, events; /* counted for tests and reports */
} Standing;

typedef struct {
    int64_t kind, status, position, call;
} Refusal;

typedef struct {
    FmiFunction instantiate, enter_event_mode, update_discrete_states, enter_continuous_time, set_time, set_states,
        get_states, get_derivatives, get_indicators, completed_step, get_nominals, count_states, count_indicators;
    const uint32_t *state_references, *derivative_references; /* one pair per variable */
    int64_t n_references, n_states, n_indicators;
    int64_t needs_completed_step, has_inputs, can_be_stiff;
    double tolerance;
    Standing now, kept;

    /* At now.time; n_kept doubles one after another, which *kept_values* has room for. */
    double *states, *slope, *indicators, *nominals;
    double *kept_values;
    int64_t n_kept;

    /* The last step went from *start* over *width*, and ends at *end*: less than start + width if there was an event.
     * Its states are on the dense output. */
    double start, width, end, span;
    double *from, *to, *trial, *found, *time_slope;
    double *stage[STAGES], *dense[DENSE];
    double *jacobian, *factors;
    uint32_t *pivot;
    double *sample[SAMPLES]; /* indicators at the solver's stages, in the order of time */
    double sample_at[SAMPLES];
    double *low_indicators, *high_indicators, *seen_indicators;
    int64_t samples, has_suspicion, has_event, has_jacobian, is_at_end, is_at_border, was_stiff;
    Refusal refusal; /* why the FMU could not be evaluated at the last point that was tried */
} Exchange;

/* Whether the FMU can be evaluated at a point; if not, another may be tried. FAILED: system->failure tells why. */
typedef enum { DONE, REFUSED, FAILED } Answer;

static inline void copy_values(double *to, const double *from, int64_t count)
{
    for (int64_t i = 0; i < count; i++)
        to[i] = from[i];
}

static inline int64_t number_of(const System *system, const Element *element)
{
    return element - system->elements;
}

#endif
