/* Data that the solvers keep between steps: only numbers, unless an includer stores its arrays elsewhere.
 *
 * The includer defines before:
 *   DSE_OF_STATES(name)   declarator of one number for each state: an array, or a pointer to room for them
 *   DSE_OF_MATRIX(name)   of a square matrix of the states, row by row
 *   DSE_OF_LOOK(name)     of one set of values of the crossing functions
 *   dse_reason            type: why the model could not be evaluated */
#ifndef DSE_CSOLVE_MEMORY_H
#define DSE_CSOLVE_MEMORY_H

#include <stdint.h>

#define DSE_STAGES 8
#define DSE_SAMPLES (DSE_STAGES + 2)
#define DSE_DENSE 4

/* Data that outlives a step. */
struct dse_past {
    double next_width;       /* proposed by the error control; 0 without experience */
    double error_before;     /* of the last accepted step, for the controller */
    double last_event;       /* time of the last event, to detect chattering */
    int64_t events_close;    /* consecutive events with almost no time between them */
    int64_t will_be_stiff;   /* which solver makes the next step */
    int64_t signs_of_other;  /* consecutive steps after which the other solver would be better */
    int64_t signs_of_this;   /* consecutive steps in favour of the present one */
    int64_t steps, rejected, evaluations, jacobians, events; /* counted for tests and reports */
};

/* The last step went from *start* over *width*; it ends at *end*, which is less than start + width if an event was
 * found in it. */
struct dse_solver {
    double tolerance;
    double start, width, end;
    double span; /* of a communication step */
    struct dse_past past;
    double DSE_OF_STATES(to);    /* at *end* */
    double DSE_OF_STATES(slope); /* derivatives at *to*, unless there is an event */
    double DSE_OF_LOOK(at_end);  /* crossing functions at *to*, unless there is an event */
    double DSE_OF_STATES(from);
    double DSE_OF_STATES(trial); /* a stage's states */
    double DSE_OF_STATES(found); /* and their derivatives */
    double DSE_OF_STATES(stage[DSE_STAGES]);
    double DSE_OF_STATES(dense[DSE_DENSE]);
    double DSE_OF_STATES(time_slope);
    double DSE_OF_MATRIX(jacobian);
    double DSE_OF_MATRIX(factors);
    uint32_t DSE_OF_STATES(pivot);
    double DSE_OF_LOOK(sample[DSE_SAMPLES]);
    double sample_at[DSE_SAMPLES]; /* parts of the step at which they were sampled, in order */
    int64_t sample_row[DSE_SAMPLES];
    double DSE_OF_LOOK(low);
    double DSE_OF_LOOK(high);
    double DSE_OF_LOOK(seen);
    int64_t samples;
    int64_t is_stiff; /* which solver is at work */
    int64_t has_step; /* the dense output is valid */
    int64_t has_event; /* at *end* */
    int64_t has_suspicion;
    int64_t has_jacobian; /* at *from* */
    int64_t is_at_end;    /* *end* is the model's present point */
    int64_t is_at_border; /* at *end* the equations before the event cannot be evaluated any more */
    dse_reason trouble;   /* of the last evaluation, if that was not possible */
};

#endif
