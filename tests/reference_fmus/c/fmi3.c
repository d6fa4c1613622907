/* FMI 3.0, co-simulation and model exchange. */
#include "fmi3Functions.h"

#include "model.h"

static bool complain(Instance *m, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (m->log)
        ((fmi3LogMessageCallback)m->log)(m->environment, fmi3Error, "logStatusError", text);
    return false;
}

#define MUST(phases)                                                                                                   \
    Instance *m = c;                                                                                                   \
    if (!m)                                                                                                            \
        return fmi3Error;                                                                                              \
    if (!allowed(m, phases, __func__))                                                                                 \
        return fmi3Error

static fmi3Status status_of(bool fine) { return fine ? fmi3OK : fmi3Error; }

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    (void)n, (void)categories;
    MUST(ANY_PHASE);
    m->logging = on;
    return fmi3OK;
}

static Instance *make(fmi3String name, fmi3String token, fmi3String resources, fmi3InstanceEnvironment environment,
                      fmi3LogMessageCallback log)
{
    if (!name || !*name || !token || strcmp(token, TOKEN)) {
        if (log)
            log(environment, fmi3Error, "logStatusError", "wrong instantiation token or no instance name");
        return NULL;
    }
    Instance *m = calloc(1, sizeof *m);
    m->name = strcpy(malloc(strlen(name) + 1), name);
    m->resources = strcpy(malloc((resources ? strlen(resources) : 0) + 1), resources ? resources : "");
    m->environment = environment;
    m->log = (void *)log;
    begin(m);
    return m;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log)
{
    (void)visible;
    Instance *m = make(name, token, resources, environment, log);
    if (m)
        m->interface = MODEL_EXCHANGE, m->logging = logging;
    return m;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
                                         const fmi3ValueReference intermediate_variables[], size_t n_intermediate,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback intermediate)
{
    (void)visible, (void)intermediate_variables, (void)n_intermediate;
    Instance *m = make(name, token, resources, environment, log);
    if (m) {
        m->interface = CO_SIMULATION, m->logging = logging;
        m->event_mode = event_mode, m->early_return = early_return;
        m->intermediate = (void *)intermediate;
    }
    return m;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update_clock, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
    (void)update_clock, (void)lock, (void)unlock;
    return NULL;
}

void fmi3FreeInstance(fmi3Instance c)
{
    Instance *m = c;
    if (!m)
        return;
    free(m->name);
    free(m->resources);
    free(m);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop)
{
    (void)has_tolerance, (void)tolerance;
    MUST(INSTANTIATED);
    if (has_stop && !(stop > start))
        return status_of(complain(m, "the stop time must be after the start time"));
    m->state.values.time = start;
    m->state.phase = INITIALIZING;
    m->state.stale = true;
    return status_of(initialize(m));
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    MUST(INITIALIZING);
    if (!initialize(m))
        return fmi3Error;
    if (m->interface == MODEL_EXCHANGE || m->event_mode)
        m->state.phase = HANDLING;
    else {
        m->ends |= handle_events(&m->state);
        m->state.phase = STEPPING;
    }
    return fmi3OK;
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    MUST(INSTANTIATED);
    m->state.phase = CONFIGURING;
    return fmi3OK;
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    MUST(CONFIGURING);
#ifdef HAS_RESIZED
    resized(&m->state.values);
#endif
    m->state.phase = INSTANTIATED;
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance c)
{
    MUST(STEPPING | HANDLING | CONTINUOUS_TIME);
    m->state.phase = ENDED;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance c)
{
    MUST(ANY_PHASE);
    begin(m);
    return fmi3OK;
}

enum { WRITABLE = INSTANTIATED | CONFIGURING | INITIALIZING | STEPPING | HANDLING | CONTINUOUS_TIME };

#define ACCESS(Name, slot_type)                                                                                        \
    fmi3Status fmi3Get##Name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3##Name values[],             \
                             size_t n_values)                                                                          \
    {                                                                                                                  \
        MUST(READABLE);                                                                                                \
        return status_of(get_numbers(m, slot_type, vr, n, values, n_values));                                          \
    }                                                                                                                  \
    fmi3Status fmi3Set##Name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3##Name values[],       \
                             size_t n_values)                                                                          \
    {                                                                                                                  \
        MUST(WRITABLE);                                                                                                \
        return status_of(set_numbers(m, slot_type, vr, n, values, n_values));                                          \
    }

ACCESS(Float64, FLOAT64)
ACCESS(Float32, FLOAT32)
ACCESS(Int8, INT8)
ACCESS(UInt8, UINT8)
ACCESS(Int16, INT16)
ACCESS(UInt16, UINT16)
ACCESS(Int32, INT32)
ACCESS(UInt32, UINT32)
ACCESS(UInt64, UINT64)
ACCESS(Boolean, BOOLEAN)

/* Enumerations are Int64 too: one variable at a time. */
static bool is_enumeration(unsigned reference)
{
    const Slot *slot = slot_of(reference);
    return slot && slot->type == ENUMERATION;
}

static size_t size_of(const Instance *m, unsigned reference)
{
    const Slot *slot = slot_of(reference);
    return slot ? count_of(&m->state.values, slot->extent) : 1;
}

fmi3Status fmi3GetInt64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Int64 values[], size_t n_values)
{
    MUST(READABLE);
    size_t used = 0;
    for (size_t i = 0; i < n; i++) {
        size_t count = size_of(m, vr[i]);
        if (used + count > n_values)
            return status_of(complain(m, "the variables have more values than the %zu asked for", n_values));
        if (!get_numbers(m, is_enumeration(vr[i]) ? ENUMERATION : INT64, vr + i, 1, values + used, count))
            return fmi3Error;
        used += count;
    }
    return status_of(used == n_values);
}

fmi3Status fmi3SetInt64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Int64 values[],
                        size_t n_values)
{
    MUST(WRITABLE);
    size_t used = 0;
    for (size_t i = 0; i < n; i++) {
        size_t count = size_of(m, vr[i]);
        if (used + count > n_values)
            return status_of(complain(m, "the variables have more values than the %zu given", n_values));
        if (!set_numbers(m, is_enumeration(vr[i]) ? ENUMERATION : INT64, vr + i, 1, values + used, count))
            return fmi3Error;
        used += count;
    }
    return status_of(used == n_values);
}

/* Strings and binaries: sizes is NULL for strings. */
static bool get_texts(Instance *m, Type type, const unsigned *vr, size_t n, size_t *sizes, const char **values,
                      size_t n_values)
{
    size_t used = 0;
    for (size_t i = 0, count; i < n; i++) {
        const Text *texts = texts_of(m, type, vr[i], false, &count);
        if (!texts)
            return false;
        if (used + count > n_values)
            return complain(m, "the variables have more values than the %zu asked for", n_values);
        for (size_t k = 0; k < count; k++, used++) {
            values[used] = texts[k].data;
            if (sizes)
                sizes[used] = texts[k].size;
        }
    }
    return used == n_values || complain(m, "the variables have fewer values than the %zu asked for", n_values);
}

static bool set_texts(Instance *m, Type type, const unsigned *vr, size_t n, const size_t *sizes,
                      const char *const *values, size_t n_values)
{
    size_t used = 0;
    for (size_t i = 0, count; i < n; i++) {
        Text *texts = texts_of(m, type, vr[i], true, &count);
        if (!texts)
            return false;
        if (used + count > n_values)
            return complain(m, "the variables have more values than the %zu given", n_values);
        for (size_t k = 0; k < count; k++, used++) {
            if (!values[used] && !(sizes && !sizes[used]))
                return complain(m, "a text is missing");
            if (!set_text(&texts[k], values[used] ? values[used] : "", sizes ? sizes[used] : strlen(values[used])))
                return complain(m, "the text is longer than %d bytes", TEXT_ROOM - 1);
        }
    }
    return used == n_values || complain(m, "the variables have fewer values than the %zu given", n_values);
}

fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3String values[], size_t n_values)
{
    MUST(READABLE);
    return status_of(get_texts(m, STRING, vr, n, NULL, values, n_values));
}

fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3String values[],
                         size_t n_values)
{
    MUST(WRITABLE);
    return status_of(set_texts(m, STRING, vr, n, NULL, values, n_values));
}

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, size_t sizes[], fmi3Binary values[],
                         size_t n_values)
{
    MUST(READABLE);
    return status_of(get_texts(m, BINARY, vr, n, sizes, (const char **)values, n_values));
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const size_t sizes[],
                         const fmi3Binary values[], size_t n_values)
{
    MUST(WRITABLE);
    return status_of(set_texts(m, BINARY, vr, n, sizes, (const char *const *)values, n_values));
}

#define REFUSED(message, ...)                                                                                          \
    {                                                                                                                  \
        const void *unused[] = {__VA_ARGS__};                                                                          \
        (void)unused;                                                                                                  \
        MUST(ANY_PHASE);                                                                                               \
        return status_of(complain(m, message));                                                                        \
    }

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Clock values[])
{
    (void)n;
    REFUSED("there are no clocks", vr, values)
}
fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Clock values[])
{
    (void)n;
    REFUSED("there are no clocks", vr, values)
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 intervals[],
                                  fmi3IntervalQualifier qualifiers[])
{
    (void)n;
    REFUSED("there are no clocks", vr, intervals, qualifiers)
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3UInt64 counters[],
                                   fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
{
    (void)n;
    REFUSED("there are no clocks", vr, counters, resolutions, qualifiers)
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 shifts[])
{
    (void)n;
    REFUSED("there are no clocks", vr, shifts)
}
fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3UInt64 counters[],
                                fmi3UInt64 resolutions[])
{
    (void)n;
    REFUSED("there are no clocks", vr, counters, resolutions)
}
fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                  const fmi3Float64 intervals[])
{
    (void)n;
    REFUSED("there are no clocks", vr, intervals)
}
fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                   const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)n;
    REFUSED("there are no clocks", vr, counters, resolutions)
}
fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 shifts[])
{
    (void)n;
    REFUSED("there are no clocks", vr, shifts)
}
fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3UInt64 counters[],
                                const fmi3UInt64 resolutions[])
{
    (void)n;
    REFUSED("there are no clocks", vr, counters, resolutions)
}
fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock, (void)time;
    REFUSED("there are no clocks", NULL)
}
fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference vr, size_t *n)
{
    (void)vr;
    REFUSED("dependencies are as the model description says", n)
}
fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent, size_t dependent_elements[],
                                       fmi3ValueReference independents[], size_t independent_elements[],
                                       fmi3DependencyKind kinds[], size_t n)
{
    (void)dependent, (void)n;
    REFUSED("dependencies are as the model description says", dependent_elements, independents, independent_elements,
            kinds)
}
fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t n_unknowns,
                                    const fmi3ValueReference knowns[], size_t n_knowns, const fmi3Float64 seed[],
                                    size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity)
{
    (void)n_unknowns, (void)n_knowns, (void)n_seed, (void)n_sensitivity;
    REFUSED("there are no adjoint derivatives", unknowns, knowns, seed, sensitivity)
}
fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Int32 orders[],
                                    fmi3Float64 values[], size_t n_values)
{
    (void)n, (void)n_values;
    REFUSED("outputs have no derivatives", vr, orders, values)
}
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c)
{
    MUST(INITIALIZING | HANDLING);
    return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state)
{
    MUST(ANY_PHASE);
    if (!*state)
        *state = malloc(sizeof(State));
    memcpy(*state, &m->state, sizeof(State));
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state)
{
    MUST(ANY_PHASE);
    memcpy(&m->state, state, sizeof(State));
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state)
{
    MUST(ANY_PHASE);
    free(*state);
    *state = NULL;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    (void)state;
    MUST(ANY_PHASE);
    *size = sizeof(State);
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    MUST(ANY_PHASE);
    if (size < sizeof(State))
        return status_of(complain(m, "the memory for the state is too small"));
    memcpy(bytes, state, sizeof(State));
    return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    MUST(ANY_PHASE);
    if (size != sizeof(State))
        return status_of(complain(m, "this is no state of mine"));
    if (!*state)
        *state = malloc(sizeof(State));
    memcpy(*state, bytes, sizeof(State));
    return fmi3OK;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t n_unknown,
                                        const fmi3ValueReference known[], size_t n_known, const fmi3Float64 seed[],
                                        size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity)
{
    MUST(READABLE);
#ifdef HAS_PARTIAL
    if (n_seed != n_known || n_sensitivity != n_unknown)
        return status_of(complain(m, "derivatives are by scalars only"));
    for (size_t i = 0; i < n_unknown; i++) {
        sensitivity[i] = 0;
        for (size_t j = 0; j < n_known; j++)
            sensitivity[i] += partial(&m->state.values, unknown[i], known[j]) * seed[j];
    }
    return fmi3OK;
#else
    (void)unknown, (void)n_unknown, (void)known, (void)n_known, (void)seed, (void)sensitivity, (void)n_seed;
    (void)n_sensitivity;
    return status_of(complain(m, "there are no directional derivatives"));
#endif
}

/* Events */

fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
    MUST(CONTINUOUS_TIME | STEPPING);
    if (m->interface == CO_SIMULATION && !m->event_mode)
        return status_of(complain(m, "event mode was not asked for"));
    m->state.phase = HANDLING;
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *ends, fmi3Boolean *nominals,
                                    fmi3Boolean *states_changed, fmi3Boolean *has_next, fmi3Float64 *next)
{
    MUST(HANDLING);
    Update what = {0};
    update(&m->state, &what);
    m->state.stale = true;
    *again = what.again;
    *ends = what.ends;
    *nominals = false;
    *states_changed = what.states_changed;
    *has_next = isfinite(m->state.next_event) != 0;
    *next = *has_next ? m->state.next_event : 0;
    return fmi3OK;
}

fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
    MUST(HANDLING);
    if (m->interface != CO_SIMULATION)
        return status_of(complain(m, "there is no step mode in model exchange"));
    remember_indicators(&m->state);
    m->state.phase = STEPPING;
    return fmi3OK;
}

/* Model exchange */

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c)
{
    MUST(HANDLING);
    if (m->interface != MODEL_EXCHANGE)
        return status_of(complain(m, "there is no continuous-time mode in co-simulation"));
    m->state.phase = CONTINUOUS_TIME;
    return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean no_rollback, fmi3Boolean *enter, fmi3Boolean *ends)
{
    (void)no_rollback;
    MUST(CONTINUOUS_TIME);
    *enter = *ends = false;
    return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time)
{
    MUST(HANDLING | CONTINUOUS_TIME);
    m->state.values.time = time;
    m->state.stale = true;
    return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t n)
{
    MUST(CONTINUOUS_TIME);
    if (n != n_states(&m->state.values))
        return status_of(complain(m, "%zu states were given", n));
    move_states(&m->state.values, 0, (double *)x, true);
    m->state.stale = true;
    return fmi3OK;
}

enum { OF_MODEL_EXCHANGE = INITIALIZING | HANDLING | CONTINUOUS_TIME | ENDED };

static fmi3Status give_states(Instance *m, int which, double x[], size_t n)
{
    if (n != n_states(&m->state.values))
        return status_of(complain(m, "%zu states were asked for", n));
    refresh(&m->state);
    move_states(&m->state.values, which, x, false);
    return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 dx[], size_t n)
{
    MUST(OF_MODEL_EXCHANGE);
    return give_states(m, 1, dx, n);
}

fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t n)
{
    MUST(OF_MODEL_EXCHANGE);
    return give_states(m, 0, x, n);
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t n)
{
    MUST(OF_MODEL_EXCHANGE);
    for (size_t i = 0; i < n; i++)
        x[i] = 1;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n)
{
    MUST(OF_MODEL_EXCHANGE | INSTANTIATED);
    *n = n_states(&m->state.values);
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n)
{
    MUST(OF_MODEL_EXCHANGE | INSTANTIATED);
    *n = N_INDICATORS;
    return fmi3OK;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 z[], size_t n)
{
    MUST(OF_MODEL_EXCHANGE);
    if (n != N_INDICATORS)
        return status_of(complain(m, "%zu event indicators were asked for", n));
    refresh(&m->state);
#if N_INDICATORS
    indicators(&m->state.values, z);
#endif
    (void)z;
    return fmi3OK;
}

/* Co-simulation */

/* Tells the importer where the step has come to; true if it asks to return now. */
static bool reports(Instance *m, double end)
{
    if (!m->intermediate)
        return false;
    bool finished = m->state.values.time >= end, wants = false;
    double at = 0;
    m->state.phase = STEPPING;
    ((fmi3IntermediateUpdateCallback)m->intermediate)(m->environment, m->state.values.time, !finished, true, true,
                                                      m->early_return, &wants, &at);
    return wants && m->early_return && at <= m->state.values.time;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 h, fmi3Boolean no_rollback,
                      fmi3Boolean *event_needed, fmi3Boolean *ends, fmi3Boolean *early, fmi3Float64 *last_time)
{
    (void)no_rollback;
    MUST(STEPPING);
    State *s = &m->state;
    if (fabs(time - s->values.time) > 1e-9 * (1 + fabs(time)))
        return status_of(complain(m, "a step from %.17g was asked for, but it is %.17g", time, s->values.time));
    if (!(h > 0))
        return status_of(complain(m, "the step size must be positive"));
    *event_needed = *early = false;
    *ends = m->ends;
    *last_time = s->values.time;
    if (m->ends)
        return status_of(complain(m, "the simulation has ended"));
    s->values.time = time;
    double end = time + h, slack = 1e-9 * (1 + fabs(end));
    while (s->values.time < end) {
        double middle = s->values.time + LARGEST_STEP;
        bool event = advance_until(s, m->intermediate && middle < end - slack ? middle : end);
        if (event && m->event_mode && (m->early_return || s->values.time >= end - slack)) {
            *event_needed = true;
            break;
        }
        if (event && handle_events(s)) {
            *ends = m->ends = true;
            break;
        }
        if (s->values.time < end && reports(m, end))
            break;
    }
    *early = s->values.time < end - slack;
    *last_time = *early ? s->values.time : end;
    if (!*event_needed)
        remember_indicators(s);
    if (!*early)
        reports(m, end);
    return fmi3OK;
}
