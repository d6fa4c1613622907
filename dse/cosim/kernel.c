/* The co-simulation master's hot loop: one call per run, fixed communication step, Jacobi.
 *
 * At t = k*step, for k = 0 … steps: read all outputs, record them, write all inputs, let every element step.
 * dse/cosim/reference.py is the same algorithm in plain Python and must agree with this one bit for bit. */
#include "access.h"
#include "kernel.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const int64_t dse_layout[9] = {sizeof(Progress), sizeof(Log),    sizeof(Group),   sizeof(Truth),         sizeof(Element),
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

/* ---- the beginning and the end of a call ---- */

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

/* ---- the phases of a run ---- */

static void bind_groups(const Groups *groups, const Element *elements)
{
    for (Group *group = groups->fmi2; group < groups->end; group++)
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
        if (!write_some(system, &element->starts, UNFIT_START))
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
    if (!read_some(system, &system->outputs))
        return false;
    for (int64_t sweep = 0; sweep < system->sweeps; sweep++) {
        memcpy(system->previous, system->values, size);
        for (const Element *element = system->elements; element < system->elements + system->n_elements; element++) {
            stage(system, element->first_staged, element->n_staged);
            if (!write_some(system, &element->inputs, UNFIT_INPUT) || !read_some(system, &element->outputs))
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

static bool step_fmi3(System *system, const Element *element, double time, double step)
{
    system->progress->place = element->stepping;
    bool event_needed = false, terminate = false, early_return = false;
    double reached = time + step;
    const int status = ((Fmi3DoStep)element->do_step)(element->instance, time, step, true, &event_needed, &terminate,
                                                      &early_return, &reached);
    if (!is_good(status))
        return fail_status(system, status);
    return terminate || early_return ? fail(system, STEP_CUT_SHORT, terminate, 0, reached) : true;
}

HOT bool step_fmi2(System *system, Progress *progress, const Element *element, double time, double step)
{
    progress->place = element->stepping;
    const int status = ((Fmi2DoStep)element->do_step)(element->instance, time, step, 1);
    return is_good(status) ? true : fail_status(system, status);
}

/* Elements step in their order, whatever their version; before *mixed* all are of FMI 2. */
HOT bool step_all(System *system, Progress *progress, const Element *mixed, double time, double step)
{
    const Element *element = system->elements, *const end = element + system->n_elements;
    for (; mixed - element >= 4; element += 4)
        if (!step_fmi2(system, progress, element, time, step) ||
            !step_fmi2(system, progress, element + 1, time, step) ||
            !step_fmi2(system, progress, element + 2, time, step) ||
            !step_fmi2(system, progress, element + 3, time, step))
            return false;
    for (; element < end; element++)
        if (!(element->version == 2 ? step_fmi2(system, progress, element, time, step)
                                    : step_fmi3(system, element, time, step)))
            return false;
    return true;
}

static const Element *first_not_fmi2(const System *system)
{
    const Element *element = system->elements, *const end = element + system->n_elements;
    while (element < end && element->version == 2)
        element++;
    return element;
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

APART static bool simulate(System *system, const Request *request)
{
    /* Copies: the compiler would read them again after every call, as it cannot know what an FMU changes. */
    Progress *const progress = system->progress;
    const Groups outputs = system->outputs, inputs = system->inputs;
    const Element *const mixed = first_not_fmi2(system);
    const double *const values = system->values;
    double *const staged = system->staged;
    const int32_t *const sources = system->sources;
    const int64_t n_staged = system->n_staged, n_record = request->n_record, steps = request->steps;
    const double step = request->step;
    double *row = request->out;
    for (int64_t k = 0;; k++, row += n_record) {
        progress->step = k;
        if (!read_groups(system, progress, &outputs))
            return false;
        gather(row, values, request->record, n_record);
        if (request->digests)
            digest(system, request->digests + k * system->n_elements);
        const double sum = gather(staged, values, sources, n_staged);
        if (sum - sum != 0.0 && !all_finite(system))
            return false;
        if (k == steps)
            return true;
        if (!write_groups(system, progress, &inputs, UNFIT_INPUT))
            return false;
        /* Never accumulated: 6000 steps of 10 ms end at 60 s, not at 59.9999999999966 s. */
        const double time = (double)k * step;
        if (!step_all(system, progress, mixed, time, step))
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
