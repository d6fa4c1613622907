/* What the solvers remember from step to step; a part of the component, so that it is saved and restored with it. */
#ifndef DSE_SOLVER_MEMORY_H
#define DSE_SOLVER_MEMORY_H

#define DSE_N DSE_ROOM(DSE_STATES)
#define DSE_HAS_STIFF (DSE_SOLVER != DSE_EXPLICIT_SOLVER)
#define DSE_SQUARE (DSE_HAS_STIFF ? DSE_N * DSE_N : 1)
#define DSE_STAGES 8
#define DSE_SAMPLES (DSE_STAGES + 2)

/* Why a simulation cannot go on. Positive codes are those of the model's own functions. */
enum {
    DSE_NO_TROUBLE = 0,
    DSE_NOT_FINITE = -1,     /* derivative of state number *subject* */
    DSE_SINGULAR = -2,       /* the stiff solver's matrix */
    DSE_TOO_INACCURATE = -3, /* no step is small enough for the tolerance */
    DSE_TOO_MANY_STEPS = -4,
    DSE_CHATTERS = -5,   /* relation number *subject* */
    DSE_UNSETTLED = -6,  /* the event iteration finds no end */
    DSE_VIOLATED = -7,   /* an assert; it has told its text */
    DSE_TERMINATED_BY_MODEL = -8
};

struct dse_trouble {
    int32_t code;
    uint32_t subject;
    double time;
};

/* The last step went from *start* over *width*; it may reach beyond the current time, and ends at *end*, which is
 * less than start + width if an event was found in it. */
struct dse_solver {
    double tolerance;
    double start, width, end;
    double next_width;   /* proposed by the error control; 0 if there is no experience */
    double error_before; /* of the last accepted step, for the controller */
    double span;         /* last communication step */
    double last_event;   /* time of the last state event */
    double from[DSE_N], to[DSE_N];
    double slope[DSE_N]; /* derivatives at *to* if has_slope */
    double trial[DSE_N]; /* a stage's states */
    double stage[DSE_STAGES][DSE_N];
    double dense[5][DSE_N];
    double jacobian[DSE_SQUARE], factors[DSE_SQUARE];
    double time_slope[DSE_N];
    double at_start[DSE_ROOM(DSE_RELATIONS)]; /* crossing functions at *to*, where the next step starts */
    double sample_at[DSE_SAMPLES]; /* parts of the step at which the stages saw the crossing functions */
    double sample[DSE_SAMPLES][DSE_ROOM(DSE_RELATIONS)];
    uint32_t pivot[DSE_N];
    uint32_t samples;
    struct dse_trouble trouble;
    uint32_t events_close;  /* state events in a row with next to no time between them */
    uint32_t signs_of_other; /* steps in a row after which the other solver would be better */
    uint32_t signs_of_this;  /* steps in a row that spoke for the present one */
    uint8_t is_stiff;       /* which solver is at work */
    uint8_t has_slope;
    uint8_t has_step;  /* the dense output is valid */
    uint8_t has_event; /* at *end* */
    uint8_t has_suspicion;
    uint8_t has_jacobian; /* at *from* */
    uint8_t will_be_stiff; /* from the next step on */
    uint8_t is_at_end;     /* v stands at *end* */
    uint8_t is_at_border;  /* at *end* the equations before the event cannot be evaluated any more */
    int64_t steps, rejected, evaluations, jacobians, events; /* counted for tests and reports */
};

#endif
