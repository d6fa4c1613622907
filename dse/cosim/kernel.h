/* The tables the co-simulation kernel works on. dse/cosim/layout.py mirrors every structure, field by field. */
#ifndef DSE_COSIM_KERNEL_H
#define DSE_COSIM_KERNEL_H

#include "fmi.h"

#if defined(_WIN32)
#define DSE_API __declspec(dllexport)
#else
#define DSE_API __attribute__((visibility("default")))
#endif

/* Type of a group of variables, as its accessor has it. Everything is a double in the table of values. */
enum { FLOAT64, FLOAT32, INT8, UINT8, INT16, UINT16, INT32, UINT32, INT64, UINT64, BOOLEAN, FMI2_BOOLEAN };

/* The FMI function that is being called; GET and SET have the group's type added. */
enum {
    IDLE, INSTANTIATE, FREE_INSTANCE, RESET, SETUP_EXPERIMENT, ENTER_INITIALIZATION, EXIT_INITIALIZATION, DO_STEP,
    TERMINATE, GET = 16, SET = 32
};

/* Why a run stopped. */
enum { NOTHING, BAD_STATUS, NO_INSTANCE, NOT_SETTLED, NOT_FINITE, TOO_LARGE, UNFIT_START, UNFIT_INPUT, STEP_CUT_SHORT };

/* Where the simulation is: written before every FMI call, so that a supervisor can read it after a crash. */
typedef struct {
    int64_t element, call;
} Place;

typedef struct {
    Place place;
    int64_t step, run; /* step is -1 outside the stepping phase */
} Progress;

enum { LOG_LINES = 16, LOG_WIDTH = 512 };

/* The last lines an FMU logged; line i of all *count* lies in lines[i % LOG_LINES]. */
typedef struct {
    uint64_t count;
    char lines[LOG_LINES][LOG_WIDTH];
} Log;

/* Variables of one element that one accessor call reads or writes. */
typedef struct {
    FmiFunction access;
    void *instance; /* the element's, filled in when a run begins */
    const uint32_t *references;
    void *room;     /* count values as the accessor has them; the values themselves if these need no conversion */
    double *values; /* count values in a table: outputs, staged inputs or starts; for inputs also an output's room */
    int64_t count;
    int64_t version, type;
    Place place;
} Group;

/* One Boolean output of FMI 2. */
typedef struct {
    int32_t *room;
    double *value;
} Truth;

/* Groups in the order they are accessed, those of FMI 2 first. What needs conversion is told besides: Boolean outputs
 * of FMI 2 one by one in truths, all else in converted, up to a NULL. */
typedef struct {
    Group *fmi2, *fmi3, *end;
    Group **converted;
    Truth *truths, *no_truths;
} Groups;

typedef struct {
    int64_t version; /* 2 or 3 */
    const char *name, *token, *resources;
    FmiFunction instantiate, free_instance, reset, setup_experiment, enter_initialization, exit_initialization, do_step,
        terminate;
    void *instance;
    Place stepping; /* in do_step */
    Log *log;
    Fmi2Callbacks callbacks;
    Groups starts, inputs, outputs;
    int64_t first_value, n_values; /* the element's part of system->values */
    int64_t first_staged, n_staged;
} Element;

typedef struct {
    int64_t kind, status; /* STEP_CUT_SHORT: status tells whether to end the simulation */
    Progress progress;
    int64_t position; /* of the variable among values, starts (UNFIT_START) or staged (UNFIT_INPUT) */
    double value;
} Failure;

typedef struct {
    Element *elements;
    Groups outputs, inputs; /* of all elements */
    double *values, *previous; /* all outputs, now and one sweep before */
    double *starts;            /* all start values */
    double *staged;            /* all inputs but those that are passed on as they were read */
    const int32_t *sources;    /* staged[i] is values[sources[i]] */
    int64_t n_elements, n_values, n_staged;
    int64_t sweeps; /* most sweeps the initialization may take */
    Progress *progress;
    Progress unwatched;
    Failure failure;
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

/* sizeof of the structures above in their order: a binding that disagrees must not go on. */
DSE_API extern const int64_t dse_layout[9];

#endif
