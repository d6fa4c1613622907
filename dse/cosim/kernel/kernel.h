/* The tables the co-simulation kernel works on. dse/cosim/binding/layout.py mirrors every structure, field by field. */
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

/* How a group of variables is passed, as its accessor has it. Every number is a double in the table of values. */
enum {
    FLOAT64, FLOAT32, INT8, UINT8, INT16, UINT16, INT32, UINT32, INT64, UINT64, BOOLEAN, FMI2_BOOLEAN, STRING, BINARY,
    FMI1_BOOLEAN, OSMP /* a binary in FMI 2: integers for the halves of its address and for its size */
};

/* The FMI function that is being called; GET and SET have the group's type added. */
enum {
    IDLE, INSTANTIATE, FREE_INSTANCE, RESET, SETUP_EXPERIMENT, ENTER_INITIALIZATION, EXIT_INITIALIZATION, DO_STEP,
    TERMINATE, GET_STATUS, GET_REAL_STATUS, GET_BOOLEAN_STATUS, SET_INPUT_DERIVATIVES, ENTER_CONFIGURATION,
    EXIT_CONFIGURATION, ENTER_STEP_MODE, GET_STATE, SET_STATE, FREE_STATE, GET_DIRECTIONAL_DERIVATIVE,
    ENTER_EVENT_MODE = 32, UPDATE_DISCRETE_STATES, /* of model exchange alone: */
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

/* What an element is able to do; in Element.abilities. */
enum {
    CAN_VARY_STEP = 1, CAN_SAVE = 2, TAKES_DERIVATIVES = 4, /* FMI 1 and 2: of inputs */
    HAS_EVENTS = 8, CAN_RETURN_EARLY = 16, ASKS_BETWEEN = 32, /* FMI 3: event mode, intermediate update */
    CAN_DIRECTIONAL = 64,
    TICKS = 128 /* its event mode belongs to clocks.h */
};

/* Element.mode */
enum { CREATED, SET_UP, INITIALIZING, RUNNING };

/* Where the simulation is: written before every FMI call, so that a supervisor can read it after a crash. */
typedef struct {
    int64_t element, call;
} Place;

typedef struct {
    Place place;
    int64_t step, run; /* step is -1 outside the stepping phase */
} Progress;

enum { LOG_LINES = 16, LOG_WIDTH = 512, LONGEST_TEXT = 16 << 20 };

/* The last lines an FMU logged; line i of all *count* lies in lines[i % LOG_LINES]. */
typedef struct {
    uint64_t count;
    char lines[LOG_LINES][LOG_WIDTH];
} Log;

/* outside = factor * inside + offset, or with *pairs* (inside, outside) what they say. */
typedef struct {
    double factor, offset;
    const double *pairs;
    int64_t n_pairs;
} Conversion;

/* Variables of one element that one accessor call reads or writes; what the loop needs comes first. */
typedef struct {
    FmiFunction access;
    void *instance; /* the element's, filled in when a run begins */
    const uint32_t *references;
    void *room;       /* n_values as the accessor has them; the values themselves if these need no conversion */
    int64_t count;    /* of references */
    int64_t n_values; /* more than references where there are arrays */
    Place place;
    double *values; /* n_values in a table: outputs, staged inputs or starts; for inputs also an output's room */
    const Conversion *conversions; /* between inside and outside of the FMU: n_values of them, or NULL */
    const Conversion *transforms;  /* what wires do to inputs on their way: n_values of them, or NULL */
    const double *slopes;          /* of the values, per second, if these inputs can follow them, or NULL */
    double *scratch;               /* room for n_values, where there are conversions, transforms or slopes */
    const int32_t *orders;         /* count times 1, where there are slopes */
    int64_t version, type;
    int64_t id;       /* its number among all groups */
    /* Inputs that are only set in event mode, one variable: the life of the element in which the FMU got it, and behind
     * it what it got, as in room; behind that room for the same again, to save it. Shared by all groups of that
     * variable. Else NULL. */
    int64_t *given;
} Group;

/* A string or binary, with a zero after its bytes. */
typedef struct {
    char *bytes;
    size_t size, room; /* room is 0 if the bytes are somebody else's */
    uint64_t print;    /* of the bytes: tells in one comparison whether they are others */
    char *before;      /* the text before it: who was given its address may still hand it on */
    size_t room_before;
} Text;

/* Strings or binaries of one element that one accessor call reads or writes. */
typedef struct {
    FmiFunction access;
    void *instance;
    const uint32_t *references;
    const void **pointers; /* n_values as the accessor takes and leaves them */
    size_t *sizes;         /* of binaries */
    Text **texts;          /* where they are copied to, or come from */
    int64_t count, n_values, version, type;
    Place place;
    int64_t id;
    int64_t *given; /* as of a Group: the life, and behind it the prints of the texts that the FMU has; twice */
} TextGroup;

/* One Boolean output of FMI 2. */
typedef struct {
    int32_t *room;
    double *value;
} Truth;

/* Groups in the order they are accessed, those of FMI 1 and 2 first. What needs conversion is told besides: Boolean
 * outputs of FMI 2 one by one in truths, all else in converted, up to a NULL. */
typedef struct {
    Group *fmi2, *fmi3, *end;
    Group **converted;
    Truth *truths, *no_truths;
    TextGroup *texts, *no_texts; /* not looked at in the loop */
} Groups;

struct System;

typedef struct {
    int64_t version; /* what the loop needs comes first */
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
    int64_t takes_slopes;          /* whether it can do anything with slopes of its inputs */
    const Groups *moving;          /* the inputs that follow slopes at present, or NULL */
    double moving_from;            /* the time at which they lay at their staged values */
    void *exchange;                /* model exchange: the solver's memory (exchange.h), else NULL */
    void *saved;                   /* the FMU's own state */
    double stop, tolerance, next_event, saved_next_event; /* tolerance: what the FMU is told, 0 for nothing */
    int64_t mode;
    int64_t life;     /* counts up when the FMU may have forgotten what it was given */
    int64_t finished; /* FMI 1 and 2: what the FMU called back with after an asynchronous step, -1 before */
    int64_t finished_at; /* in which of the run's steps it did */
    int64_t asked;    /* FMI 3: how often it asked for values in between */
    int64_t broken;   /* a call made from within do_step failed */
    struct System *system;
} Element;

typedef struct {
    int64_t kind, status; /* STEP_CUT_SHORT: status tells whether to end the simulation, value then when, or NaN */
    Progress progress;
    int64_t group, position; /* the value's place in the group with that id; NOT_FINITE: in the table of values */
    double value, time;
} Failure;

typedef struct System {
    Element *elements;
    Groups outputs, inputs; /* of all elements */
    double *values;            /* all outputs */
    double *starts;            /* all start values */
    double *staged;            /* all inputs but those that are passed on as they were read */
    double *slopes;            /* of staged[i], per second */
    const int32_t *sources;    /* staged[i] is values[sources[i]] */
    Text *texts;               /* all strings and binaries that are read */
    const Groups *tables;      /* all groups that are there, to be told the instances */
    int64_t n_tables, n_texts;
    int64_t texts_changed; /* how often any text has changed */
    int64_t n_elements, n_values, n_staged;
    int64_t is_plain;      /* whether the short loop is enough */
    int64_t may_roll_back; /* whether elements may be set back to a saved state */
    Progress *progress;
    Progress unwatched;
    double now; /* simulated time in seconds, NaN outside the stepping phase */
    Failure failure;
    void *plan;        /* how it is simulated: a Plan of plan.h */
    FmiFunction fused; /* the loop that was compiled for this system, or NULL */
    int64_t fused_steps; /* how many steps it made in the last run */
    int64_t watches;     /* whether each step is looked at for a change of the floating-point mode */
    int64_t rows;        /* how many were recorded */
    int64_t has_ended;   /* an FMU asked to end the simulation, as *failure* tells: there is no row after these */
    int64_t takes_end;   /* whether all others can get to where an element asks for the end: a next row */
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

/* Free every instance there is. */
DSE_API void dse_free(System *system);

/* A logger of FMI 2 for callers that cannot read a variable number of arguments: *environment* is a function that takes
 * the finished line. */
DSE_API void dse_tell_line(void *environment, const char *name, int status, const char *category, const char *format,
                           ...);

/* Free what was allocated for texts. */
DSE_API void dse_forget_texts(System *system);

/* A fingerprint of the sources this was compiled from, which hatch_build.py defines: a binding with others must not go
 * on. */
DSE_API extern const char dse_sources[];

#endif
