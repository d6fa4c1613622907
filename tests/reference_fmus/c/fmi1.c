/* FMI 1.0, co-simulation. Its functions carry the name of the model: Dahlquist_fmiDoStep. */
#include <stddef.h>

#include "fmi1Functions.h"

#include "model.h"

#define JOIN(a, b) a##_fmi##b
#define NAMED(a, b) JOIN(a, b)
#define FUNCTION(name) NAMED(IDENTIFIER, name)

static bool complain(Instance *m, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (m->log)
        ((fmi1CallbackLogger)m->log)(m, m->name, fmi1Error, "error", "%s", text);
    return false;
}

#define MUST(phases)                                                                                                   \
    Instance *m = c;                                                                                                   \
    if (!m)                                                                                                            \
        return fmi1Error;                                                                                              \
    if (!allowed(m, phases, __func__))                                                                                 \
        return fmi1Error

static fmi1Status status_of(bool fine) { return fine ? fmi1OK : fmi1Error; }

const char *FUNCTION(GetTypesPlatform)(void) { return "standard32"; }
const char *FUNCTION(GetVersion)(void) { return "1.0"; }

fmi1Component FUNCTION(InstantiateSlave)(fmi1String name, fmi1String token, fmi1String location, fmi1String mime,
                                         fmi1Real timeout, fmi1Boolean visible, fmi1Boolean interactive,
                                         fmi1CallbackFunctions functions, fmi1Boolean logging)
{
    (void)mime, (void)timeout, (void)visible, (void)interactive;
    if (!name || !*name || !token || strcmp(token, TOKEN)) {
        if (functions.logger)
            functions.logger(NULL, name, fmi1Error, "error", "wrong GUID or no instance name");
        return NULL;
    }
    Instance *m = calloc(1, sizeof *m);
    m->name = strcpy(malloc(strlen(name) + 1), name);
    if (location && !strncmp(location, "file://", 7))
        location += strncmp(location + 7, "localhost", 9) ? 7 : 16;
    const char *folder = "/resources";
    m->resources = malloc((location ? strlen(location) : 0) + strlen(folder) + 1);
    strcat(strcpy(m->resources, location ? location : ""), folder);
    m->log = (void *)functions.logger;
    m->logging = logging;
    m->interface = CO_SIMULATION;
    begin(m);
    return m;
}

void FUNCTION(FreeSlaveInstance)(fmi1Component c)
{
    Instance *m = c;
    if (!m)
        return;
    free(m->name);
    free(m->resources);
    free(m);
}

fmi1Status FUNCTION(SetDebugLogging)(fmi1Component c, fmi1Boolean on)
{
    MUST(ANY_PHASE);
    m->logging = on;
    return fmi1OK;
}

fmi1Status FUNCTION(InitializeSlave)(fmi1Component c, fmi1Real start, fmi1Boolean has_stop, fmi1Real stop)
{
    MUST(INSTANTIATED);
    if (has_stop && !(stop > start))
        return status_of(complain(m, "the stop time must be after the start time"));
    m->state.values.time = start;
    m->state.stale = true;
    if (!initialize(m))
        return fmi1Error;
    m->ends |= handle_events(&m->state);
    m->state.phase = STEPPING;
    return fmi1OK;
}

fmi1Status FUNCTION(TerminateSlave)(fmi1Component c)
{
    MUST(STEPPING);
    m->state.phase = ENDED;
    return fmi1OK;
}

fmi1Status FUNCTION(ResetSlave)(fmi1Component c)
{
    MUST(ANY_PHASE);
    begin(m);
    return fmi1OK;
}

/* In FMI 1.0 values may be read from a new slave too. */
enum { FMI1_READABLE = INSTANTIATED | STEPPING | ENDED, FMI1_WRITABLE = INSTANTIATED | STEPPING };

fmi1Status FUNCTION(GetReal)(fmi1Component c, const fmi1ValueReference vr[], size_t n, fmi1Real values[])
{
    MUST(FMI1_READABLE);
    return status_of(get_numbers(m, FLOAT64, vr, n, values, n));
}

fmi1Status FUNCTION(SetReal)(fmi1Component c, const fmi1ValueReference vr[], size_t n, const fmi1Real values[])
{
    MUST(FMI1_WRITABLE);
    return status_of(set_numbers(m, FLOAT64, vr, n, values, n));
}

fmi1Status FUNCTION(GetInteger)(fmi1Component c, const fmi1ValueReference vr[], size_t n, fmi1Integer values[])
{
    MUST(FMI1_READABLE);
    for (size_t i = 0; i < n; i++) {
        const Slot *slot = slot_of(vr[i]);
        int64_t item = 0;
        if (slot && slot->type == ENUMERATION) {
            if (!get_numbers(m, ENUMERATION, vr + i, 1, &item, 1))
                return fmi1Error;
            values[i] = (int)item;
        } else if (!get_numbers(m, INT32, vr + i, 1, values + i, 1))
            return fmi1Error;
    }
    return fmi1OK;
}

fmi1Status FUNCTION(SetInteger)(fmi1Component c, const fmi1ValueReference vr[], size_t n, const fmi1Integer values[])
{
    MUST(FMI1_WRITABLE);
    for (size_t i = 0; i < n; i++) {
        const Slot *slot = slot_of(vr[i]);
        int64_t item = values[i];
        bool fine = slot && slot->type == ENUMERATION ? set_numbers(m, ENUMERATION, vr + i, 1, &item, 1)
                                                      : set_numbers(m, INT32, vr + i, 1, values + i, 1);
        if (!fine)
            return fmi1Error;
    }
    return fmi1OK;
}

fmi1Status FUNCTION(GetBoolean)(fmi1Component c, const fmi1ValueReference vr[], size_t n, fmi1Boolean values[])
{
    MUST(FMI1_READABLE);
    for (size_t i = 0; i < n; i++) {
        bool value;
        if (!get_numbers(m, BOOLEAN, vr + i, 1, &value, 1))
            return fmi1Error;
        values[i] = value;
    }
    return fmi1OK;
}

fmi1Status FUNCTION(SetBoolean)(fmi1Component c, const fmi1ValueReference vr[], size_t n, const fmi1Boolean values[])
{
    MUST(FMI1_WRITABLE);
    for (size_t i = 0; i < n; i++) {
        bool value = values[i] != fmi1False;
        if (!set_numbers(m, BOOLEAN, vr + i, 1, &value, 1))
            return fmi1Error;
    }
    return fmi1OK;
}

fmi1Status FUNCTION(GetString)(fmi1Component c, const fmi1ValueReference vr[], size_t n, fmi1String values[])
{
    MUST(FMI1_READABLE);
    for (size_t i = 0, count; i < n; i++) {
        const Text *text = texts_of(m, STRING, vr[i], false, &count);
        if (!text)
            return fmi1Error;
        values[i] = text->data;
    }
    return fmi1OK;
}

fmi1Status FUNCTION(SetString)(fmi1Component c, const fmi1ValueReference vr[], size_t n, const fmi1String values[])
{
    MUST(FMI1_WRITABLE);
    for (size_t i = 0, count; i < n; i++) {
        Text *text = texts_of(m, STRING, vr[i], true, &count);
        if (!text || !values[i])
            return fmi1Error;
        if (!set_text(text, values[i], strlen(values[i])))
            return status_of(complain(m, "the text is longer than %d bytes", TEXT_ROOM - 1));
    }
    return fmi1OK;
}

fmi1Status FUNCTION(DoStep)(fmi1Component c, fmi1Real time, fmi1Real h, fmi1Boolean new_step)
{
    (void)new_step;
    MUST(STEPPING);
    State *s = &m->state;
    if (fabs(time - s->values.time) > 1e-9 * (1 + fabs(time)))
        return status_of(complain(m, "a step from %.17g was asked for, but it is %.17g", time, s->values.time));
    if (h < 0)
        return status_of(complain(m, "the step size must not be negative"));
    if (m->ends)
        return fmi1Discard;
    s->values.time = time;
    while (advance_until(s, time + h))
        if (handle_events(s)) {
            m->ends = true;
            return s->values.time < time + h ? fmi1Discard : fmi1OK;
        }
    remember_indicators(s);
    return fmi1OK;
}

fmi1Status FUNCTION(CancelStep)(fmi1Component c)
{
    MUST(ANY_PHASE);
    return status_of(complain(m, "steps are never pending"));
}

fmi1Status FUNCTION(GetStatus)(fmi1Component c, const fmi1StatusKind kind, fmi1Status *value)
{
    (void)c, (void)kind, (void)value;
    return fmi1Discard;
}

fmi1Status FUNCTION(GetRealStatus)(fmi1Component c, const fmi1StatusKind kind, fmi1Real *value)
{
    MUST(STEPPING | ENDED);
    if (kind != fmi1LastSuccessfulTime)
        return fmi1Discard;
    *value = m->state.values.time;
    return fmi1OK;
}

fmi1Status FUNCTION(GetIntegerStatus)(fmi1Component c, const fmi1StatusKind kind, fmi1Integer *value)
{
    (void)c, (void)kind, (void)value;
    return fmi1Discard;
}

fmi1Status FUNCTION(GetBooleanStatus)(fmi1Component c, const fmi1StatusKind kind, fmi1Boolean *value)
{
    (void)c, (void)kind, (void)value;
    return fmi1Discard;
}

fmi1Status FUNCTION(GetStringStatus)(fmi1Component c, const fmi1StatusKind kind, fmi1String *value)
{
    (void)c, (void)kind, (void)value;
    return fmi1Discard;
}

fmi1Status FUNCTION(SetRealInputDerivatives)(fmi1Component c, const fmi1ValueReference vr[], size_t n,
                                             const fmi1Integer order[], const fmi1Real values[])
{
    (void)vr, (void)n, (void)order, (void)values;
    MUST(ANY_PHASE);
    return status_of(complain(m, "inputs cannot be interpolated"));
}

fmi1Status FUNCTION(GetRealOutputDerivatives)(fmi1Component c, const fmi1ValueReference vr[], size_t n,
                                              const fmi1Integer order[], fmi1Real values[])
{
    (void)vr, (void)n, (void)order, (void)values;
    MUST(ANY_PHASE);
    return status_of(complain(m, "outputs have no derivatives"));
}
