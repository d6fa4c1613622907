/* The co-simulation master: one call per run. The initialization follows a plan (plan.h), as does the simulation,
 * except for the plain case, which has a tight loop here: fixed communication step, Jacobi.
 *
 * At t = k*step, for k = 0 … steps: read all outputs, record them, write all inputs, let every element step.
 * tests/oracle/reference.py does the same in plain Python; its results must be identical to the last bit. */
#include "master.h"
#include "exchange_alone.h"
#include "fused.h"

const char dse_sources[] = DSE_SOURCES;

/* ---- the beginning and the end of a call ---- */

static void begin(System *system)
{
    if (!system->progress)
        system->progress = &system->unwatched;
    system->progress->step = -1;
    system->now = NAN;
    system->failure = (Failure){0};
    system->rows = system->has_ended = 0;
    make_floating_default();
    for (int64_t e = 0; e < system->n_elements; e++)
        system->elements[e].log->count = 0;
}

static int end(System *system, bool succeeded)
{
    make_floating_default();
    enter_call(system, 0, IDLE);
    return succeeded ? 0 : 1;
}

/* ---- the phases of a run ---- */

static bool start(System *system, double stop)
{
    for (int64_t e = 0; e < system->n_elements; e++)
        if (!set_up(system, e, stop) || !keeps_floating_mode(system))
            return false;
    return true;
}

static bool leave_all(System *system)
{
    for (int64_t e = 0; e < system->n_elements; e++)
        if (!leave_initialization(system, e) || !keeps_floating_mode(system))
            return false;
    return true;
}

/* Elements step in their order, with any version; elements before *mixed* all use FMI 2. */
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
                                    : step_fmi3(system, (Element *)element, time, step)))
            return false;
    return true;
}

/* The same, with a check for changes of the floating-point mode. */
RARE static bool step_all_watched(System *system, double time, double step)
{
    for (int64_t e = 0; e < system->n_elements; e++)
        if (!step_element(system, &system->elements[e], time, step) || !keeps_floating_mode(system))
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

APART static bool simulate(System *system, const Request *request)
{
    /* Copies: otherwise the compiler would reload them after every call, as an FMU might change them. */
    Progress *const progress = system->progress;
    const Groups outputs = system->outputs, inputs = system->inputs;
    const Element *const mixed = first_not_fmi2(system);
    const double *const values = system->values;
    double *const staged = system->staged;
    const int32_t *const sources = system->sources;
    const int64_t n_staged = system->n_staged, n_record = request->n_record, steps = request->steps;
    const double step = request->step;
    const bool watches = system->watches;
    int64_t k = system->fused_steps = 0;
    system->takes_end = true;
    if (system->fused && !request->digests && !watches) {
        if (!simulate_fused(system, request))
            return false;
        k = progress->step;
    }
    for (double *row = request->out + k * n_record;; k++, row += n_record) {
        progress->step = k;
        if (!read_groups(system, progress, &outputs))
            return false;
        gather(row, values, request->record, n_record);
        system->rows = k + 1;
        if (request->digests)
            digest(system, request->digests + k * system->n_elements);
        const double sum = gather(staged, values, sources, n_staged);
        if (sum - sum != 0.0 && !all_finite(system))
            return false;
        if (k == steps || system->has_ended)
            return true;
        if (!write_groups(system, progress, &inputs, UNFIT_INPUT))
            return false;
        /* Never accumulated: 6000 steps of 10 ms end at 60 s, not at 59.9999999999966 s. */
        const double time = (double)k * step;
        if (!(watches ? step_all_watched(system, time, step) : step_all(system, progress, mixed, time, step)))
            return false;
    }
}

/* To the end, or to the end that an FMU requests: the rows before it are the result. */
static bool simulate_on(System *system, const Request *request)
{
    const bool went = system->is_plain ? simulate(system, request) : simulate_by_plan(system, request);
    system->has_ended |= !went && is_asked_to_end(system) && system->rows;
    return went || (system->has_ended && is_asked_to_end(system));
}

static bool terminate_all(System *system)
{
    for (int64_t e = 0; e < system->n_elements; e++)
        if (!terminate_element(system, e) || !keeps_floating_mode(system))
            return false;
    return true;
}

/* ---- functions for the binding ---- */

int dse_run(System *system, const Request *request)
{
    begin(system);
    bind(system);
    system->progress->run++;
    if (!start(system, request->stop) || !initialize(system) || !start_clocks(system, request->step) ||
        !leave_all(system))
        return end(system, false);
    set_limits(system);
    return end(system, simulate_on(system, request) && within_limits(system) && terminate_all(system));
}

int dse_instantiate(System *system)
{
    begin(system);
    for (int64_t e = 0; e < system->n_elements; e++)
        if (!make_instance(system, e))
            return end(system, false);
    return end(system, true);
}

int dse_reset(System *system)
{
    begin(system);
    for (int64_t e = 0; e < system->n_elements; e++)
        if (!reset_element(system, e))
            return end(system, false);
    return end(system, true);
}

void dse_free(System *system)
{
    if (!system->progress)
        system->progress = &system->unwatched;
    system->progress->step = -1;
    for (int64_t e = 0; e < system->n_elements; e++)
        free_instance(system, e);
    enter_call(system, 0, IDLE);
    calling = NULL;
}

void dse_tell_line(void *environment, const char *name, int status, const char *category, const char *format, ...)
{
    (void)name, (void)status, (void)category;
    char line[LOG_WIDTH];
    va_list values;
    if (!environment || !format)
        return;
    va_start(values, format);
    vsnprintf(line, sizeof line, format, values);
    va_end(values);
    ((void (*)(const char *))environment)(line);
}

void dse_forget_texts(System *system)
{
    forget_texts(system);
}
