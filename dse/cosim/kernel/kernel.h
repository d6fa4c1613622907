/* The tables of the co-simulation kernel. dse/cosim/binding/layout.py mirrors every structure, field by field. */
#ifndef DSE_COSIM_KERNEL_H
#define DSE_COSIM_KERNEL_H

#if !defined(_WIN32) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L /* nanosleep */
#endif

#include "fmi.h"

#if defined(_WIN32)
#define DSE_API __declspec(dllexport)
#else
#define DSE_API __attribute__((visibility("default")))
#endif

/* How a group's accessor passes its variables. Every number is a double in the table of values. */
enum {
    FLOAT64, FLOAT32, INT8, UINT8, INT16, UINT16, INT32, UINT32, INT64, UINT64, BOOLEAN, FMI2_BOOLEAN, STRING, BINARY,
    FMI1_BOOLEAN, OSMP /* a binary in FMI 2: integers for the halves of its address and for its size */
};

/* The FMI function of the present call; GET and SET have the group's type added. */
enum {
    IDLE, INSTANTIATE, FREE_INSTANCE, RESET, SETUP_EXPERIMENT, ENTER_INITIALIZATION, EXIT_INITIALIZATION, DO_STEP,
    TERMINATE, GET_STATUS, GET_REAL_STATUS, GET_BOOLEAN_STATUS, SET_INPUT_DERIVATIVES, ENTER_CONFIGURATION,
    EXIT_CONFIGURATION, ENTER_STEP_MODE, GET_STATE, SET_STATE, FREE_STATE, GET_DIRECTIONAL_DERIVATIVE,
    ENTER_EVENT_MODE = 32, UPDATE_DISCRETE_STATES, /* of model exchange only: */
    ENTER_CONTINUOUS_TIME, SET_TIME, SET_CONTINUOUS_STATES, GET_CONTINUOUS_STATES, GET_DERIVATIVES,
    GET_EVENT_INDICATORS, COMPLETED_INTEGRATOR_STEP, GET_NOMINALS, GET_STATE_COUNT, GET_INDICATOR_COUNT, /* clocks: */
    GET_CLOCK, SET_CLOCK, GET_INTERVAL_DECIMAL, GET_INTERVAL_FRACTION, GET_SHIFT_DECIMAL, GET_SHIFT_FRACTION,
    GET = 64, SET = 96
};

/* Why a run stopped. */
enum {
    NOTHING, BAD_STATUS, NO_INSTANCE, NOT_SETTLED, NOT_FINITE, TOO_LARGE, UNFIT_START, UNFIT_INPUT, STEP_CUT_SHORT,
    NO_ITEM, NO_ITEM_START, NO_ITEM_INPUT, NO_TEXT, LONG_TEXT, ENDLESS_EVENTS, FLOATING_CHANGED,
    NOT_SOLVED = 16, DIVERGED, STEP_TOO_SHORT, NEARLY_SINGULAR, MISLED,
    ENDLESS_STEPS, /* with NOT_SETTLED: the algorithms */
    ENDLESS_TICKS, BAD_INTERVAL, BETWEEN_POINTS, /* clocks, up to 30: position is the clock's, -1 for none */
    NO_FUNCTION = 31 /* from 32: exchange.h */
};

/* Capabilities of an element, in Element.abilities. */
enum {
    CAN_VARY_STEP = 1, CAN_SAVE = 2, TAKES_DERIVATIVES = 4, /* FMI 1 and 2: of inputs */
    HAS_EVENTS = 8, CAN_RETURN_EARLY = 16, ASKS_BETWEEN = 32, /* FMI 3: event mode, intermediate update */
    CAN_DIRECTIONAL = 64,
    TICKS = 128 /* clocks.h controls its event mode */
};

/* Element.mode */
enum { CREATED, SET_UP, INITIALIZING, RUNNING };

/* Position of the simulation: written before every FMI call, so that a supervisor can read it after a crash. */
typedef struct {
    int64_t element, call;
} Place;

typedef struct {
    Place place;
    int64_t step, run; /* step is -1 outside the stepping phase */
} Progress;

enum { LOG_LINES = 16, LOG_WIDTH = 512, LONGEST_TEXT = 16 << 20 };

/* The last lines an FMU logged; line i of all *count* is stored in lines[i % LOG_LINES]. */
typedef struct {
    uint64_t count;
    char lines[LOG_LINES][LOG_WIDTH];
} Log;

/* outside = factor * inside + offset, or by *pairs* (inside, outside). */
typedef struct {
    double factor, offset;
    const double *pairs;
    int64_t n_pairs;
} Conversion;

/* Variables of one element that one accessor call reads or writes; members for the loop are first. */
typedef struct {
    FmiFunction access;
    void *instance; /* the element's, set when a run begins */
    const uint32_t *references;
    void *room;       /* n_values in the accessor's type; the values themselves if they need no conversion */
    int64_t count;    /* of references */
    int64_t n_values; /* greater than count for arrays */
    Place place;
    double *values; /* n_values in a table: outputs, staged inputs or starts; for inputs also an output's room */
    const Conversion *conversions; /* between inside and outside of the FMU: n_values of them, or NULL */
    const Conversion *transforms;  /* of the wires to these inputs: n_values of them, or NULL */
    const double *slopes;          /* of the values, per second, if these inputs can follow slopes, or NULL */
    double *scratch;               /* room for n_values, if there are conversions, transforms or slopes */
    const int32_t *orders;         /* 1, *count* times, if there are slopes */
    int64_t version, type;
    int64_t id;       /* its number among all groups */
    /* For inputs that can only be set in event mode, one variable: the life of the element in which the FMU last got
     * it, then its value as in room, then space to save both. All groups of that variable share it. Else NULL. */
    int64_t *given;
} Group;

/* A string or binary, with a zero after its bytes. */
typedef struct {
    char *bytes;
    size_t size, room; /* room is 0 if the bytes are not owned */
    uint64_t print;    /* hash of the bytes: one comparison detects a change */
    char *before;      /* the previous text: an FMU that got its address may still pass it on */
    size_t room_before;
} Text;

/* Strings or binaries of one element that one accessor call reads or writes. */
typedef struct {
    FmiFunction access;
    void *instance;
    const uint32_t *references;
    const void **pointers; /* n_values in the accessor's format */
    size_t *sizes;         /* of binaries */
    Text **texts;          /* their destinations, or their sources */
    int64_t count, n_values, version, type;
    Place place;
    int64_t id;
    int64_t *given; /* as in a Group: the life, then the hashes of the FMU's texts; twice */
} TextGroup;

/* One Boolean output of FMI 2. */
typedef struct {
    int32_t *room;
    double *value;
} Truth;

/* Groups in the order of access, those of FMI 1 and 2 first. Groups with conversion are listed again: Boolean outputs
 * of FMI 2 one by one in truths, all others in converted, which ends with NULL. */
typedef struct {
    Group *fmi2, *fmi3, *end;
    Group **converted;
    Truth *truths, *no_truths;
    TextGroup *texts, *no_texts; /* not used in the loop */
} Groups;

struct System;

typedef struct {
    int64_t version; /* members for the loop are first */
    FmiFunction do_step;
    void *instance;
    Place stepping; /* in do_step */
    int64_t abilities;
    const char *name, *token, *resources;
    FmiFunction instantiate, free_instance, reset, setup_experiment, enter_initialization, exit_initialization,
        terminate, get_status, get_real_status, get_boolean_status, set_input_derivatives, enter_configuration,
        exit_configuration, enter_step_mode, get_state, set_state, free_state, get_directional_derivative,
        enter_event_mode, update_discrete_states;
    Log *log;
    Fmi2Callbacks callbacks;
    Groups configuration, starts, inputs, outputs;
    int64_t first_value, n_values; /* the element's part of system->values */
    int64_t first_staged, n_staged;
    const uint32_t *intermediate;  /* FMI 3: references of the inputs that can be set within a step */
    int64_t n_intermediate;
    int64_t takes_slopes;          /* whether it can use slopes of its inputs */
    const Groups *moving;          /* the inputs that presently follow slopes, or NULL */
    double moving_from;            /* the time of their staged values */
    void *exchange;                /* model exchange: the solver's memory (exchange.h), else NULL */
    void *saved;                   /* the FMU's own state */
    double stop, tolerance, next_event, saved_next_event; /* tolerance: as given to the FMU, 0 for none */
    int64_t mode;
    int64_t life;     /* incremented when the FMU may have lost its inputs */
    int64_t finished; /* FMI 1 and 2: the status of the callback after an asynchronous step, -1 before */
    int64_t finished_at; /* the run's step of that callback */
    int64_t asked;    /* FMI 3: number of its requests for intermediate values */
    int64_t broken;   /* a call made from within do_step failed */
    struct System *system;
} Element;

typedef struct {
    int64_t kind, status; /* STEP_CUT_SHORT: status is nonzero to end the simulation, value is the end time or NaN */
    Progress progress;
    int64_t group, position; /* the value's place in the group with that id; NOT_FINITE: in the table of values */
    double value, time;
} Failure;

typedef struct System {
    Element *elements;
    Groups outputs, inputs; /* of all elements */
    double *values;            /* all outputs */
    double *starts;            /* all start values */
    double *staged;            /* all inputs except those that are passed on as they were read */
    double *slopes;            /* of staged[i], per second */
    const int32_t *sources;    /* staged[i] is values[sources[i]] */
    Text *texts;               /* all strings and binaries that are read */
    const Groups *tables;      /* all groups, which get the instances */
    int64_t n_tables, n_texts;
    int64_t texts_changed; /* number of changes of all texts */
    int64_t n_elements, n_values, n_staged;
    int64_t is_plain;      /* whether the short loop suffices */
    int64_t may_roll_back; /* whether elements may be reset to a saved state */
    Progress *progress;
    Progress unwatched;
    double now; /* simulated time in seconds, NaN outside the stepping phase */
    Failure failure;
    void *plan;        /* the simulation method: a Plan of plan.h */
    FmiFunction fused; /* the loop that was compiled for this system, or NULL */
    int64_t fused_steps; /* number of its steps in the last run */
    int64_t watches;     /* whether each step is checked for a change of the floating-point mode */
    int64_t rows;        /* number of recorded rows */
    int64_t has_ended;   /* an FMU requested the end of the simulation, see *failure*: no rows follow */
    int64_t takes_end;   /* whether all others can also step to a requested end: the next row */
} System;

typedef struct {
    double stop, step;
    int64_t steps;
    const int32_t *record;
    int64_t n_record;
    double *out;       /* [steps + 1][n_record] */
    uint64_t *digests; /* [steps + 1][n_elements], or NULL */
} Request;

/* All return 0, or 1 with system->failure filled in. */
DSE_API int dse_instantiate(System *system);
DSE_API int dse_reset(System *system);
DSE_API int dse_run(System *system, const Request *request);

/* Free all instances. */
DSE_API void dse_free(System *system);

/* A logger of FMI 2 for callers that cannot read variadic arguments: *environment* is a function that takes the
 * formatted line. */
DSE_API void dse_tell_line(void *environment, const char *name, int status, const char *category, const char *format,
                           ...);

/* Free the memory of texts. */
DSE_API void dse_forget_texts(System *system);

/* A hash of the sources of this library, which hatch_build.py defines: a binding with another hash must stop. */
DSE_API extern const char dse_sources[];

#endif
