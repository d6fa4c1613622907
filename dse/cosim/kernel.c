/* The co-simulation master's hot loop: one call per run, fixed communication step, Jacobi.
 *
 * At t = k*step, for k = 0 … steps: read all outputs, record them, write all inputs, let every element step.
 * dse/cosim/reference.py is the same algorithm in plain Python and must agree with this one bit for bit. */
#include "kernel.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXACT_INTEGER 9007199254740992.0 /* 2^53: beyond it a double no longer tells integers apart */

const int64_t dse_layout[8] = {sizeof(Progress), sizeof(Log),    sizeof(Group),  sizeof(Element),
                               sizeof(Failure),  sizeof(System), sizeof(Request), LOG_LINES *LOG_WIDTH};

/* ---- the FMU's log ---- */

static char *next_line(Log *log)
{
    /* FMUs log from threads of their own: a line may be overwritten, never the memory beside it. */
    return log->lines[__atomic_fetch_add(&log->count, 1, __ATOMIC_RELAXED) % LOG_LINES];
}

static void keep_fmi2_line(void *environment, const char *name, int status, const char *category,
                           const char *format, ...)
{
    (void)name, (void)status, (void)category;
    if (!environment || !format)
        return;
    va_list values;
    va_start(values, format);
    vsnprintf(next_line(environment), LOG_WIDTH, format, values);
    va_end(values);
}

static void keep_fmi3_line(void *environment, int status, const char *category, const char *message)
{
    (void)status, (void)category;
    if (environment && message)
        snprintf(next_line(environment), LOG_WIDTH, "%s", message);
}

/* ---- failures and the place they happen at ---- */

static inline void enter(System *system, int64_t element, int64_t call)
{
    volatile Progress *progress = system->progress; /* must be in memory when the FMU crashes */
    progress->element = element;
    progress->call = call;
}

static bool fail(System *system, int64_t kind, int64_t status, int64_t position, double value)
{
    system->failure = (Failure){kind, status, *system->progress, position, value};
    return false;
}

static inline bool accept(System *system, int status)
{
    return (unsigned)status <= FMI_WARNING ? true : fail(system, BAD_STATUS, status, 0, 0);
}

static void begin(System *system)
{
    if (!system->progress)
        system->progress = &system->unwatched;
    system->progress->step = -1;
    system->failure = (Failure){0};
    for (int64_t e = 0; e < system->n_elements; e++)
        system->elements[e].log->count = 0;
}

static int end(System *system, bool succeeded)
{
    enter(system, 0, IDLE);
    return succeeded ? 0 : 1;
}

/* ---- reading and writing variables ---- */

/* Convert values[count] as the accessor returned them to double; returns the first that is too large, or count. */
static int64_t widen(const Group *group, double *values)
{
    int64_t i = 0;
    switch (group->type) {
#define PLAIN(TYPE, C_TYPE)                                                                                           \
    case TYPE:                                                                                                        \
        for (; i < group->count; i++)                                                                                 \
            values[i] = (double)((const C_TYPE *)group->room)[i];                                                     \
        break;
#define CHECKED(TYPE, C_TYPE)                                                                                         \
    case TYPE:                                                                                                        \
        for (; i < group->count; i++) {                                                                               \
            values[i] = (double)((const C_TYPE *)group->room)[i];                                                     \
            if (values[i] > EXACT_INTEGER || values[i] < -EXACT_INTEGER ||                                            \
                (C_TYPE)values[i] != ((const C_TYPE *)group->room)[i])                                                \
                return i;                                                                                             \
        }                                                                                                             \
        break;
        PLAIN(FLOAT32, float)
        PLAIN(INT8, int8_t)
        PLAIN(UINT8, uint8_t)
        PLAIN(INT16, int16_t)
        PLAIN(UINT16, uint16_t)
        PLAIN(INT32, int32_t)
        PLAIN(UINT32, uint32_t)
        CHECKED(INT64, int64_t)
        CHECKED(UINT64, uint64_t)
    case BOOLEAN:
        for (; i < group->count; i++)
            values[i] = ((const bool *)group->room)[i] ? 1.0 : 0.0;
        break;
    case FMI2_BOOLEAN:
        for (; i < group->count; i++)
            values[i] = ((const int32_t *)group->room)[i] ? 1.0 : 0.0;
        break;
    }
    return group->count;
}

/* Gather a group's values as its accessor wants them; returns the first that does not fit, or count. */
static inline int64_t narrow(const Group *group, const double *from)
{
    int64_t i = 0;
    switch (group->type) {
    case FLOAT64:
        for (; i < group->count; i++)
            ((double *)group->room)[i] = from[group->sources[i]];
        break;
    case FLOAT32:
        for (; i < group->count; i++)
            ((float *)group->room)[i] = (float)from[group->sources[i]];
        break;
#define WHOLE(TYPE, C_TYPE, LOW, HIGH)                                                                                \
    case TYPE:                                                                                                        \
        for (; i < group->count; i++) {                                                                               \
            double value = from[group->sources[i]];                                                                   \
            if (!(value >= (LOW) && value <= (HIGH)) || (double)(int64_t)value != value)                              \
                return i;                                                                                             \
            ((C_TYPE *)group->room)[i] = (C_TYPE)value;                                                               \
        }                                                                                                             \
        break;
        WHOLE(INT8, int8_t, INT8_MIN, INT8_MAX)
        WHOLE(UINT8, uint8_t, 0, UINT8_MAX)
        WHOLE(INT16, int16_t, INT16_MIN, INT16_MAX)
        WHOLE(UINT16, uint16_t, 0, UINT16_MAX)
        WHOLE(INT32, int32_t, INT32_MIN, INT32_MAX)
        WHOLE(UINT32, uint32_t, 0, UINT32_MAX)
        WHOLE(INT64, int64_t, -EXACT_INTEGER, EXACT_INTEGER)
        WHOLE(UINT64, uint64_t, 0, EXACT_INTEGER)
        WHOLE(BOOLEAN, bool, 0, 1)
        WHOLE(FMI2_BOOLEAN, int32_t, 0, 1)
    }
    return group->count;
}

static inline int call_accessor(const Element *element, const Group *group, void *room)
{
    return element->version == 2
               ? ((Fmi2Access)group->access)(element->instance, group->references, (size_t)group->count, room)
               : ((Fmi3Access)group->access)(element->instance, group->references, (size_t)group->count, room,
                                             (size_t)group->count);
}

static inline bool read_outputs(System *system, int64_t e)
{
    const Element *element = &system->elements[e];
    for (const Group *group = element->outputs; group < element->outputs + element->n_outputs; group++) {
        double *values = system->values + group->first;
        bool direct = group->type == FLOAT64;
        enter(system, e, GET + group->type);
        if (!accept(system, call_accessor(element, group, direct ? (void *)values : group->room)))
            return false;
        int64_t good = direct ? group->count : widen(group, values);
        if (good < group->count)
            return fail(system, TOO_LARGE, 0, group->first + good, values[good]);
    }
    return true;
}

static inline bool write_groups(System *system, int64_t e, const Group *groups, int64_t n_groups, const double *from,
                                int64_t unfit)
{
    for (const Group *group = groups; group < groups + n_groups; group++) {
        enter(system, e, SET + group->type);
        int64_t good = narrow(group, from);
        if (good < group->count)
            return fail(system, unfit, group - groups, good, from[group->sources[good]]);
        if (!accept(system, call_accessor(&system->elements[e], group, group->room)))
            return false;
    }
    return true;
}

static inline bool write_inputs(System *system, int64_t e)
{
    const Element *element = &system->elements[e];
    return write_groups(system, e, element->inputs, element->n_inputs, system->values, UNFIT_INPUT);
}

static bool all_finite(System *system)
{
    bool bad = false;
    for (int64_t i = 0; i < system->n_finite; i++) {
        double value = system->values[system->finite[i]];
        bad |= value - value != 0.0;
    }
    if (!bad)
        return true;
    for (int64_t i = 0; i < system->n_values; i++)
        for (int64_t j = 0; j < system->n_finite; j++)
            if (system->finite[j] == i && system->values[i] - system->values[i] != 0.0)
                return fail(system, NOT_FINITE, 0, i, system->values[i]);
    return true;
}

/* ---- the phases of a run ---- */

static bool start(System *system, const Request *request)
{
    for (int64_t e = 0; e < system->n_elements; e++) {
        const Element *element = &system->elements[e];
        bool is_fmi2 = element->version == 2;
        if (is_fmi2) {
            enter(system, e, SETUP_EXPERIMENT);
            if (!accept(system, ((Fmi2SetupExperiment)element->setup_experiment)(element->instance, 0, 0.0, 0.0, 1,
                                                                                 request->stop)))
                return false;
        }
        if (!write_groups(system, e, element->starts, element->n_starts, request->starts, UNFIT_START))
            return false;
        enter(system, e, ENTER_INITIALIZATION);
        if (!accept(system, is_fmi2 ? ((FmiPlain)element->enter_initialization)(element->instance)
                                    : ((Fmi3EnterInitialization)element->enter_initialization)(
                                          element->instance, false, 0.0, 0.0, true, request->stop)))
            return false;
    }
    return true;
}

/* Carry values along the wires until no output changes any more, bit for bit. */
static bool settle(System *system)
{
    size_t size = (size_t)system->n_values * sizeof(double);
    for (int64_t e = 0; e < system->n_elements; e++)
        if (!read_outputs(system, e))
            return false;
    for (int64_t sweep = 0; sweep < system->sweeps; sweep++) {
        memcpy(system->previous, system->values, size);
        for (int64_t e = 0; e < system->n_elements; e++)
            if (!write_inputs(system, e) || !read_outputs(system, e))
                return false;
        if (memcmp(system->previous, system->values, size) == 0)
            return true;
    }
    return fail(system, NOT_SETTLED, 0, 0, 0);
}

static bool leave_initialization(System *system)
{
    for (int64_t e = 0; e < system->n_elements; e++) {
        enter(system, e, EXIT_INITIALIZATION);
        if (!accept(system, ((FmiPlain)system->elements[e].exit_initialization)(system->elements[e].instance)))
            return false;
    }
    return true;
}

static inline bool do_step(System *system, int64_t e, double time, double step)
{
    const Element *element = &system->elements[e];
    enter(system, e, DO_STEP);
    if (element->version == 2)
        return accept(system, ((Fmi2DoStep)element->do_step)(element->instance, time, step, 1));
    bool event_needed = false, terminate = false, early_return = false;
    double reached = time + step;
    if (!accept(system, ((Fmi3DoStep)element->do_step)(element->instance, time, step, true, &event_needed, &terminate,
                                                       &early_return, &reached)))
        return false;
    return terminate || early_return ? fail(system, STEP_CUT_SHORT, terminate, 0, reached) : true;
}

static void digest(const System *system, uint64_t *digests)
{
    for (int64_t e = 0; e < system->n_elements; e++) {
        const Element *element = &system->elements[e];
        uint64_t hash = 0x9E3779B97F4A7C15u;
        for (int64_t i = element->first; i < element->first + element->count; i++) {
            uint64_t bits;
            memcpy(&bits, &system->values[i], sizeof bits);
            hash = (hash ^ bits) * 0xD6E8FEB86659FD93u;
            hash ^= hash >> 32;
        }
        digests[e] = hash;
    }
}

static bool simulate(System *system, const Request *request)
{
    const int64_t n_elements = system->n_elements, n_record = request->n_record;
    double *row = request->out;
    for (int64_t k = 0;; k++, row += n_record) {
        ((volatile Progress *)system->progress)->step = k;
        for (int64_t e = 0; e < n_elements; e++)
            if (!read_outputs(system, e))
                return false;
        for (int64_t i = 0; i < n_record; i++)
            row[i] = system->values[request->record[i]];
        if (request->digests)
            digest(system, request->digests + k * n_elements);
        if (!all_finite(system))
            return false;
        if (k == request->steps)
            return true;
        for (int64_t e = 0; e < n_elements; e++)
            if (!write_inputs(system, e))
                return false;
        /* Never accumulated: 6000 steps of 10 ms end at 60 s, not at 59.9999999999966 s. */
        const double time = (double)k * request->step;
        for (int64_t e = 0; e < n_elements; e++)
            if (!do_step(system, e, time, request->step))
                return false;
    }
}

static bool terminate_all(System *system)
{
    for (int64_t e = 0; e < system->n_elements; e++) {
        enter(system, e, TERMINATE);
        if (!accept(system, ((FmiPlain)system->elements[e].terminate)(system->elements[e].instance)))
            return false;
    }
    return true;
}

/* ---- what the binding calls ---- */

int dse_run(System *system, const Request *request)
{
    begin(system);
    system->progress->run++;
    return end(system, start(system, request) && settle(system) && leave_initialization(system) &&
                           simulate(system, request) && terminate_all(system));
}

int dse_instantiate(System *system)
{
    begin(system);
    for (int64_t e = 0; e < system->n_elements; e++) {
        Element *element = &system->elements[e];
        enter(system, e, INSTANTIATE);
        element->callbacks = (Fmi2Callbacks){keep_fmi2_line, calloc, free, NULL, element->log};
        element->instance =
            element->version == 2
                ? ((Fmi2Instantiate)element->instantiate)(element->name, FMI2_CO_SIMULATION, element->token,
                                                          element->resources, &element->callbacks, 0, 0)
                : ((Fmi3Instantiate)element->instantiate)(element->name, element->token, element->resources, false,
                                                          false, false, false, NULL, 0, element->log, keep_fmi3_line,
                                                          NULL);
        if (!element->instance) {
            fail(system, NO_INSTANCE, 0, 0, 0);
            return end(system, false);
        }
    }
    return end(system, true);
}

int dse_reset(System *system)
{
    begin(system);
    for (int64_t e = 0; e < system->n_elements; e++) {
        enter(system, e, RESET);
        if (!accept(system, ((FmiPlain)system->elements[e].reset)(system->elements[e].instance)))
            return end(system, false);
    }
    return end(system, true);
}

void dse_free(System *system)
{
    if (!system->progress)
        system->progress = &system->unwatched;
    system->progress->step = -1;
    for (int64_t e = 0; e < system->n_elements; e++) {
        Element *element = &system->elements[e];
        if (!element->instance)
            continue;
        enter(system, e, FREE_INSTANCE);
        ((FmiFree)element->free_instance)(element->instance);
        element->instance = NULL;
    }
    enter(system, 0, IDLE);
}
