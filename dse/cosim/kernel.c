/* The co-simulation master's hot loop: one call per run, fixed communication step, Jacobi.
 *
 * At t = k*step, for k = 0 … steps: read all outputs, record them, write all inputs, let every element step.
 * dse/cosim/reference.py is the same algorithm in plain Python and must agree with this one bit for bit. */
#include "convert.h"
#include "kernel.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const int64_t dse_layout[8] = {sizeof(Progress), sizeof(Log),    sizeof(Group),  sizeof(Element),
                               sizeof(Failure),  sizeof(System), sizeof(Request), LOG_LINES *LOG_WIDTH};

/* Kept apart from the loop, which is measurably faster without them in between. */
#if defined(__GNUC__)
#define RARE __attribute__((cold, noinline))
#else
#define RARE
#endif

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

/* The block is in memory before the FMU runs: no compiler may hold a store to it back past an unknown function. */
static inline void enter(System *system, Place place)
{
    system->progress->place = place;
}

static inline void enter_call(System *system, int64_t element, int64_t call)
{
    enter(system, (Place){element, call});
}

RARE static bool fail(System *system, int64_t kind, int64_t status, int64_t position, double value)
{
    system->failure = (Failure){kind, status, *system->progress, position, value};
    return false;
}

static inline bool is_good(int status)
{
    return (unsigned)status <= FMI_WARNING;
}

static inline bool accept(System *system, int status)
{
    return is_good(status) ? true : fail(system, BAD_STATUS, status, 0, 0);
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
    enter_call(system, 0, IDLE);
    return succeeded ? 0 : 1;
}

/* ---- reading and writing variables ---- */

static inline int call_accessor(const Group *group)
{
    const size_t count = (size_t)group->count;
    return group->version == 2
               ? ((Fmi2Access)group->access)(group->instance, group->references, count, group->room)
               : ((Fmi3Access)group->access)(group->instance, group->references, count, group->room, count);
}

static bool read_converted(System *system, const Group *group)
{
    enter(system, group->place);
    if (!accept(system, call_accessor(group)))
        return false;
    int64_t good = widen(group);
    return good == group->count ||
           fail(system, TOO_LARGE, 0, group->values + good - system->values, group->values[good]);
}

RARE static bool fail_unfit(System *system, const Group *group, int64_t kind, int64_t position)
{
    /* The variable's position among all start values, or among all inputs. */
    const double *first = kind == UNFIT_START ? system->starts : system->staged;
    return fail(system, kind, 0, group->values + position - first, group->values[position]);
}

static bool write_converted(System *system, const Group *group, int64_t unfit)
{
    enter(system, group->place);
    int64_t good = narrow(group);
    return good == group->count ? accept(system, call_accessor(group)) : fail_unfit(system, group, unfit, good);
}

/* Reals need no conversion, their accessors work on the table of values itself. */
static inline bool access_reals(System *system, const Group *fmi2, const Group *fmi3, const Group *end)
{
    int status = FMI_OK;
    for (; fmi2 < fmi3; fmi2++) {
        enter(system, fmi2->place);
        status = ((Fmi2Access)fmi2->access)(fmi2->instance, fmi2->references, (size_t)fmi2->count, fmi2->values);
        if (!is_good(status))
            return fail(system, BAD_STATUS, status, 0, 0);
    }
    for (; fmi3 < end; fmi3++) {
        const size_t count = (size_t)fmi3->count;
        enter(system, fmi3->place);
        status = ((Fmi3Access)fmi3->access)(fmi3->instance, fmi3->references, count, fmi3->values, count);
        if (!is_good(status))
            return fail(system, BAD_STATUS, status, 0, 0);
    }
    return true;
}

static inline bool read_groups(System *system, const Groups *groups)
{
    if (!access_reals(system, groups->first, groups->fmi3_reals, groups->others))
        return false;
    for (const Group *group = groups->others; group < groups->end; group++)
        if (!read_converted(system, group))
            return false;
    return true;
}

static inline bool write_groups(System *system, const Groups *groups, int64_t unfit)
{
    if (!access_reals(system, groups->first, groups->fmi3_reals, groups->others))
        return false;
    for (const Group *group = groups->others; group < groups->end; group++)
        if (!write_converted(system, group, unfit))
            return false;
    return true;
}

/* to[i] = table[positions[i]]; returns the sum, which tells in one test whether all were finite. */
static inline double gather(double *to, const double *table, const int32_t *positions, int64_t count)
{
    /* By twos: in runs of a few values the loop costs more than the copying. */
    typedef double Pair __attribute__((vector_size(2 * sizeof(double)), aligned(sizeof(double)), may_alias));
    Pair sum = {0.0, 0.0};
    int64_t i = 0;
    for (; i + 1 < count; i += 2) {
        Pair pair = {table[positions[i]], table[positions[i + 1]]};
        *(Pair *)(to + i) = pair;
        sum += pair;
    }
    if (i < count)
        sum[0] += to[i] = table[positions[i]];
    return sum[0] + sum[1];
}

/* Carry outputs along the wires to count inputs, from the first given. */
static inline double stage(const System *system, int64_t first, int64_t count)
{
    return gather(system->staged + first, system->values, system->sources + first, count);
}

RARE static bool all_finite(System *system)
{
    int64_t position = system->n_values;
    for (int64_t i = 0; i < system->n_staged; i++)
        if (system->staged[i] - system->staged[i] != 0.0 && system->sources[i] < position)
            position = system->sources[i];
    return position == system->n_values || fail(system, NOT_FINITE, 0, position, system->values[position]);
}

/* ---- the phases of a run ---- */

static void bind_groups(const Groups *groups, const Element *elements)
{
    for (Group *group = groups->first; group < groups->end; group++)
        group->instance = elements[group->place.element].instance;
}

static void bind(System *system)
{
    const Element *elements = system->elements;
    bind_groups(&system->outputs, elements);
    bind_groups(&system->inputs, elements);
    for (int64_t e = 0; e < system->n_elements; e++) {
        bind_groups(&elements[e].starts, elements);
        bind_groups(&elements[e].inputs, elements);
        bind_groups(&elements[e].outputs, elements);
    }
}

static bool start(System *system, double stop)
{
    for (int64_t e = 0; e < system->n_elements; e++) {
        const Element *element = &system->elements[e];
        bool is_fmi2 = element->version == 2;
        if (is_fmi2) {
            enter_call(system, e, SETUP_EXPERIMENT);
            Fmi2SetupExperiment set_up = (Fmi2SetupExperiment)element->setup_experiment;
            if (!accept(system, set_up(element->instance, 0, 0.0, 0.0, 1, stop)))
                return false;
        }
        if (!write_groups(system, &element->starts, UNFIT_START))
            return false;
        enter_call(system, e, ENTER_INITIALIZATION);
        if (!accept(system, is_fmi2 ? ((FmiPlain)element->enter_initialization)(element->instance)
                                    : ((Fmi3EnterInitialization)element->enter_initialization)(
                                          element->instance, false, 0.0, 0.0, true, stop)))
            return false;
    }
    return true;
}

/* Carry values along the wires until no output changes any more, bit for bit. */
static bool settle(System *system)
{
    size_t size = (size_t)system->n_values * sizeof(double);
    if (!read_groups(system, &system->outputs))
        return false;
    for (int64_t sweep = 0; sweep < system->sweeps; sweep++) {
        memcpy(system->previous, system->values, size);
        for (const Element *element = system->elements; element < system->elements + system->n_elements; element++) {
            stage(system, element->first_staged, element->n_staged);
            if (!write_groups(system, &element->inputs, UNFIT_INPUT) ||
                !read_groups(system, &element->outputs))
                return false;
        }
        if (memcmp(system->previous, system->values, size) == 0)
            return true;
    }
    return fail(system, NOT_SETTLED, 0, 0, 0);
}

static bool leave_initialization(System *system)
{
    for (int64_t e = 0; e < system->n_elements; e++) {
        enter_call(system, e, EXIT_INITIALIZATION);
        if (!accept(system, ((FmiPlain)system->elements[e].exit_initialization)(system->elements[e].instance)))
            return false;
    }
    return true;
}

static inline bool do_step(System *system, const Element *element, double time, double step)
{
    enter(system, element->stepping);
    if (element->version == 2)
        return accept(system, ((Fmi2DoStep)element->do_step)(element->instance, time, step, 1));
    bool event_needed = false, terminate = false, early_return = false;
    double reached = time + step;
    if (!accept(system, ((Fmi3DoStep)element->do_step)(element->instance, time, step, true, &event_needed, &terminate,
                                                       &early_return, &reached)))
        return false;
    return terminate || early_return ? fail(system, STEP_CUT_SHORT, terminate, 0, reached) : true;
}

RARE static void digest(const System *system, uint64_t *digests)
{
    for (int64_t e = 0; e < system->n_elements; e++) {
        const Element *element = &system->elements[e];
        uint64_t hash = 0x9E3779B97F4A7C15u;
        for (int64_t i = element->first_value; i < element->first_value + element->n_values; i++) {
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
        system->progress->step = k;
        if (!read_groups(system, &system->outputs))
            return false;
        gather(row, system->values, request->record, n_record);
        if (request->digests)
            digest(system, request->digests + k * n_elements);
        double sum = stage(system, 0, system->n_staged);
        if (sum - sum != 0.0 && !all_finite(system))
            return false;
        if (k == request->steps)
            return true;
        if (!write_groups(system, &system->inputs, UNFIT_INPUT))
            return false;
        /* Never accumulated: 6000 steps of 10 ms end at 60 s, not at 59.9999999999966 s. */
        const double time = (double)k * request->step;
        for (const Element *element = system->elements, *end = element + n_elements; element < end; element++)
            if (!do_step(system, element, time, request->step))
                return false;
    }
}

static bool terminate_all(System *system)
{
    for (int64_t e = 0; e < system->n_elements; e++) {
        enter_call(system, e, TERMINATE);
        if (!accept(system, ((FmiPlain)system->elements[e].terminate)(system->elements[e].instance)))
            return false;
    }
    return true;
}

/* ---- what the binding calls ---- */

int dse_run(System *system, const Request *request)
{
    begin(system);
    bind(system);
    system->progress->run++;
    return end(system, start(system, request->stop) && settle(system) && leave_initialization(system) &&
                           simulate(system, request) && terminate_all(system));
}

int dse_instantiate(System *system)
{
    begin(system);
    for (int64_t e = 0; e < system->n_elements; e++) {
        Element *element = &system->elements[e];
        enter_call(system, e, INSTANTIATE);
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
        enter_call(system, e, RESET);
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
        enter_call(system, e, FREE_INSTANCE);
        ((FmiFree)element->free_instance)(element->instance);
        element->instance = NULL;
    }
    enter_call(system, 0, IDLE);
}
