/* FMI 2.0, co-simulation and model exchange. */
#include "fmi2Functions.h"

#include "model.h"

static bool complain(Instance *m, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (m->log)
        ((fmi2CallbackLogger)m->log)(m->environment, m->name, fmi2Error, "logStatusError", "%s", text);
    return false;
}

#define MUST(phases)                                                                                                   \
    Instance *m = c;                                                                                                   \
    if (!m)                                                                                                            \
        return fmi2Error;                                                                                              \
    if (!allowed(m, phases, __func__))                                                                                 \
        return fmi2Error

static fmi2Status status_of(bool fine) { return fine ? fmi2OK : fmi2Error; }

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)n, (void)categories;
    MUST(ANY_PHASE);
    m->logging = on;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)visible;
    Instance *m = calloc(1, sizeof *m);
    if (!m || !functions || !functions->logger || !name || !*name || strcmp(token, TOKEN)) {
        if (functions && functions->logger)
            functions->logger(functions->componentEnvironment, name, fmi2Error, "logStatusError",
                              "wrong GUID or no instance name");
        free(m);
        return NULL;
    }
    m->name = strcpy(malloc(strlen(name) + 1), name);
    if (resources && !strncmp(resources, "file://", 7)) {
        resources += strncmp(resources + 7, "localhost", 9) ? 7 : 16;
#ifdef _WIN32
        resources++; /* the slash before the drive */
#endif
    }
    m->resources = strcpy(malloc((resources ? strlen(resources) : 0) + 1), resources ? resources : "");
    m->environment = functions->componentEnvironment;
    m->log = (void *)functions->logger;
    m->logging = logging;
    m->interface = type == fmi2CoSimulation ? CO_SIMULATION : MODEL_EXCHANGE;
    begin(m);
    return m;
}

void fmi2FreeInstance(fmi2Component c)
{
    Instance *m = c;
    if (!m)
        return;
    free(m->name);
    free(m->resources);
    free(m);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop)
{
    (void)has_tolerance, (void)tolerance;
    MUST(INSTANTIATED);
    if (has_stop && !(stop > start))
        return status_of(complain(m, "the stop time must be after the start time"));
    m->state.values.time = start;
    m->state.set_up = true;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    MUST(INSTANTIATED);
    if (!m->state.set_up)
        return status_of(complain(m, "fmi2SetupExperiment has to come first"));
    m->state.phase = INITIALIZING;
    m->state.stale = true;
    return status_of(initialize(m));
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    MUST(INITIALIZING);
    if (!initialize(m))
        return fmi2Error;
    if (m->interface == MODEL_EXCHANGE)
        m->state.phase = HANDLING;
    else {
        m->ends |= handle_events(&m->state);
        m->state.phase = STEPPING;
    }
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    MUST(STEPPING | HANDLING | CONTINUOUS_TIME);
    m->state.phase = ENDED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    MUST(ANY_PHASE);
    begin(m);
    return fmi2OK;
}

#define GET(Name, type, slot_type)                                                                                     \
    fmi2Status fmi2Get##Name(fmi2Component c, const fmi2ValueReference vr[], size_t n, type values[])                  \
    {                                                                                                                  \
        MUST(READABLE);                                                                                                \
        return status_of(get_numbers(m, slot_type, vr, n, values, n));                                                 \
    }                                                                                                                  \
    fmi2Status fmi2Set##Name(fmi2Component c, const fmi2ValueReference vr[], size_t n, const type values[])            \
    {                                                                                                                  \
        MUST(INSTANTIATED | INITIALIZING | STEPPING | HANDLING | CONTINUOUS_TIME);                                     \
        return status_of(set_numbers(m, slot_type, vr, n, values, n));                                                 \
    }

GET(Real, fmi2Real, FLOAT64)

/* Integers are INT32 or enumerations (64 bits), Booleans are bool inside and int outside: one by one. */
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer values[])
{
    MUST(READABLE);
    for (size_t i = 0; i < n; i++) {
        const Slot *slot = slot_of(vr[i]);
        int64_t item = 0;
        if (slot && slot->type == ENUMERATION) {
            if (!get_numbers(m, ENUMERATION, vr + i, 1, &item, 1))
                return fmi2Error;
            values[i] = (int)item;
        } else if (!get_numbers(m, INT32, vr + i, 1, values + i, 1))
            return fmi2Error;
    }
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer values[])
{
    MUST(INSTANTIATED | INITIALIZING | STEPPING | HANDLING | CONTINUOUS_TIME);
    for (size_t i = 0; i < n; i++) {
        const Slot *slot = slot_of(vr[i]);
        int64_t item = values[i];
        bool fine = slot && slot->type == ENUMERATION ? set_numbers(m, ENUMERATION, vr + i, 1, &item, 1)
                                                      : set_numbers(m, INT32, vr + i, 1, values + i, 1);
        if (!fine)
            return fmi2Error;
    }
    return fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean values[])
{
    MUST(READABLE);
    for (size_t i = 0; i < n; i++) {
        bool value;
        if (!get_numbers(m, BOOLEAN, vr + i, 1, &value, 1))
            return fmi2Error;
        values[i] = value;
    }
    return fmi2OK;
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Boolean values[])
{
    MUST(INSTANTIATED | INITIALIZING | STEPPING | HANDLING | CONTINUOUS_TIME);
    for (size_t i = 0; i < n; i++) {
        bool value = values[i] != fmi2False;
        if (!set_numbers(m, BOOLEAN, vr + i, 1, &value, 1))
            return fmi2Error;
    }
    return fmi2OK;
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String values[])
{
    MUST(READABLE);
    for (size_t i = 0, count; i < n; i++) {
        const Text *text = texts_of(m, STRING, vr[i], false, &count);
        if (!text)
            return fmi2Error;
        values[i] = text->data;
    }
    return fmi2OK;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String values[])
{
    MUST(INSTANTIATED | INITIALIZING | STEPPING | HANDLING | CONTINUOUS_TIME);
    for (size_t i = 0, count; i < n; i++) {
        Text *text = texts_of(m, STRING, vr[i], true, &count);
        if (!text || !values[i])
            return fmi2Error;
        if (!set_text(text, values[i], strlen(values[i])))
            return status_of(complain(m, "the text is longer than %d bytes", TEXT_ROOM - 1));
    }
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    MUST(ANY_PHASE);
    if (!*state)
        *state = malloc(sizeof(State));
    memcpy(*state, &m->state, sizeof(State));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    MUST(ANY_PHASE);
    memcpy(&m->state, state, sizeof(State));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    MUST(ANY_PHASE);
    free(*state);
    *state = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)state;
    MUST(ANY_PHASE);
    *size = sizeof(State);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    MUST(ANY_PHASE);
    if (size < sizeof(State))
        return status_of(complain(m, "the memory for the state is too small"));
    memcpy(bytes, state, sizeof(State));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    MUST(ANY_PHASE);
    if (size != sizeof(State))
        return status_of(complain(m, "this is no state of mine"));
    if (!*state)
        *state = malloc(sizeof(State));
    memcpy(*state, bytes, sizeof(State));
    return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real seed[],
                                        fmi2Real sensitivity[])
{
    MUST(READABLE);
#ifdef HAS_PARTIAL
    for (size_t i = 0; i < n_unknown; i++) {
        sensitivity[i] = 0;
        for (size_t j = 0; j < n_known; j++)
            sensitivity[i] += partial(&m->state.values, unknown[i], known[j]) * seed[j];
    }
    return fmi2OK;
#else
    (void)unknown, (void)n_unknown, (void)known, (void)n_known, (void)seed, (void)sensitivity;
    return status_of(complain(m, "there are no directional derivatives"));
#endif
}

/* Model exchange */

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    MUST(CONTINUOUS_TIME);
    m->state.phase = HANDLING;
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    MUST(HANDLING);
    Update what = {0};
    update(&m->state, &what);
    m->state.stale = true;
    memset(info, 0, sizeof *info);
    info->newDiscreteStatesNeeded = what.again;
    info->terminateSimulation = what.ends;
    info->valuesOfContinuousStatesChanged = what.states_changed;
    info->nextEventTimeDefined = isfinite(m->state.next_event) != 0;
    info->nextEventTime = info->nextEventTimeDefined ? m->state.next_event : 0;
    return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    MUST(HANDLING);
    m->state.phase = CONTINUOUS_TIME;
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_rollback, fmi2Boolean *enter, fmi2Boolean *ends)
{
    (void)no_rollback;
    MUST(CONTINUOUS_TIME);
    *enter = *ends = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    MUST(HANDLING | CONTINUOUS_TIME);
    m->state.values.time = time;
    m->state.stale = true;
    return fmi2OK;
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n)
{
    MUST(CONTINUOUS_TIME);
    if (n != n_states(&m->state.values))
        return status_of(complain(m, "%zu states were given", n));
    move_states(&m->state.values, 0, (double *)x, true);
    m->state.stale = true;
    return fmi2OK;
}

static fmi2Status give_states(Instance *m, int which, double x[], size_t n)
{
    if (n != n_states(&m->state.values))
        return status_of(complain(m, "%zu states were asked for", n));
    refresh(&m->state);
    move_states(&m->state.values, which, x, false);
    return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real dx[], size_t n)
{
    MUST(READABLE & ~STEPPING);
    return give_states(m, 1, dx, n);
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    MUST(READABLE & ~STEPPING);
    return give_states(m, 0, x, n);
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    MUST(READABLE & ~STEPPING);
    for (size_t i = 0; i < n; i++)
        x[i] = 1;
    return fmi2OK;
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real z[], size_t n)
{
    MUST(READABLE & ~STEPPING);
    if (n != N_INDICATORS)
        return status_of(complain(m, "%zu event indicators were asked for", n));
    refresh(&m->state);
#if N_INDICATORS
    indicators(&m->state.values, z);
#endif
    (void)z;
    return fmi2OK;
}

/* Co-simulation */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean no_rollback)
{
    (void)no_rollback;
    MUST(STEPPING);
    State *s = &m->state;
    if (fabs(time - s->values.time) > 1e-9 * (1 + fabs(time)))
        return status_of(complain(m, "a step from %.17g was asked for, but it is %.17g", time, s->values.time));
    if (!(h > 0))
        return status_of(complain(m, "the step size must be positive"));
    if (m->ends)
        return fmi2Discard;
    s->values.time = time;
    while (advance_until(s, time + h))
        if (handle_events(s)) {
            m->ends = true;
            return s->values.time < time + h ? fmi2Discard : fmi2OK;
        }
    remember_indicators(s);
    return fmi2OK;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind, (void)value;
    MUST(STEPPING | ENDED);
    return fmi2Discard;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    MUST(STEPPING | ENDED);
    if (kind != fmi2LastSuccessfulTime)
        return fmi2Discard;
    *value = m->state.values.time;
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    MUST(STEPPING | ENDED);
    if (kind != fmi2Terminated)
        return fmi2Discard;
    *value = m->ends;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)c, (void)kind, (void)value;
    return fmi2Discard;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)c, (void)kind, (void)value;
    return fmi2Discard;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real values[])
{
    (void)vr, (void)n, (void)order, (void)values;
    MUST(ANY_PHASE);
    return status_of(complain(m, "inputs cannot be interpolated"));
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real values[])
{
    (void)vr, (void)n, (void)order, (void)values;
    MUST(ANY_PHASE);
    return status_of(complain(m, "outputs have no derivatives"));
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    MUST(ANY_PHASE);
    return status_of(complain(m, "steps are never pending"));
}
