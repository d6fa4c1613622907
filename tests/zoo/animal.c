/* A small FMU 2.0 for co-simulation, tame unless the functions in bite.h say otherwise.
 *
 * y(t) = gain * (t + u), u as it was before the step. What an animal does is done if it bites (a parameter that is 1),
 * in a step from half a second on. */
#define _GNU_SOURCE
#include "fmi2Functions.h"

#include <fenv.h>
#include <locale.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifndef _WIN32
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#endif

enum { U, Y, BITES, GAIN, TEXT, TEXT_IN };

typedef struct {
    double real[4], time;
    const char *text;
    const fmi2CallbackFunctions *functions;
    fmi2ComponentEnvironment environment;
    fmi2CallbackLogger log;
#ifndef _WIN32
    pthread_t thread;
#endif
    bool has_thread;
    volatile bool done;
} Animal;

static void say(Animal *a, fmi2Status status, const char *text)
{
    a->log(a->environment, "animal", status, "logStatusError", "%s", text);
}

#include "bite.h"

#ifndef AT_LOAD
#define AT_LOAD
#endif
#ifndef AT_INSTANTIATE
#define AT_INSTANTIATE
#endif
#ifndef AT_INITIALIZATION
#define AT_INITIALIZATION
#endif
#ifndef AT_STEP
#define AT_STEP
#endif
#ifndef AT_GET
#define AT_GET
#endif
#ifndef AT_RESET
#define AT_RESET
#endif
#ifndef AT_TERMINATE
#define AT_TERMINATE
#endif
#ifndef AT_FREE
#define AT_FREE
#endif
#define BITES_NOW (a->real[BITES] == 1)

__attribute__((constructor)) static void load(void) { AT_LOAD }

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    Animal *a = calloc(1, sizeof *a);
    a->log = functions->logger;
    a->environment = functions->componentEnvironment;
    a->real[GAIN] = 1;
    a->text = "short";
    AT_INSTANTIATE
    if (strcmp(token, TOKEN)) {
        say(a, fmi2Error, "this library is not of that model description");
        free(a);
        return NULL;
    }
    return a;
}

void fmi2FreeInstance(fmi2Component c)
{
    Animal *a = c;
    AT_FREE
    free(a);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop)
{
    ((Animal *)c)->time = start;
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }

static void calculate(Animal *a) { a->real[Y] = a->real[GAIN] * (a->time + a->real[U]); }

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Animal *a = c;
    if (BITES_NOW) {
        AT_INITIALIZATION
    }
    calculate(a);
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    Animal *a = c;
    if (BITES_NOW) {
        AT_TERMINATE
    }
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    Animal *a = c;
    AT_RESET
    memset(a->real, 0, sizeof a->real);
    a->real[GAIN] = 1;
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real values[])
{
    Animal *a = c;
    if (BITES_NOW) {
        AT_GET
    }
    for (size_t i = 0; i < n; i++)
        values[i] = a->real[vr[i]];
    return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real values[])
{
    for (size_t i = 0; i < n; i++)
        ((Animal *)c)->real[vr[i]] = values[i];
    return fmi2OK;
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String values[])
{
    for (size_t i = 0; i < n; i++)
        values[i] = ((Animal *)c)->text;
    return fmi2OK;
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String values[])
{
    return fmi2OK;
}
#define REFUSED(name, ...) fmi2Status name(fmi2Component c, __VA_ARGS__) { return fmi2Error; }
REFUSED(fmi2GetInteger, const fmi2ValueReference vr[], size_t n, fmi2Integer values[])
REFUSED(fmi2SetInteger, const fmi2ValueReference vr[], size_t n, const fmi2Integer values[])
REFUSED(fmi2GetBoolean, const fmi2ValueReference vr[], size_t n, fmi2Boolean values[])
REFUSED(fmi2SetBoolean, const fmi2ValueReference vr[], size_t n, const fmi2Boolean values[])
REFUSED(fmi2GetFMUstate, fmi2FMUstate *state)
REFUSED(fmi2SetFMUstate, fmi2FMUstate state)
REFUSED(fmi2FreeFMUstate, fmi2FMUstate *state)
REFUSED(fmi2SerializedFMUstateSize, fmi2FMUstate state, size_t *size)
REFUSED(fmi2SerializeFMUstate, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
REFUSED(fmi2DeSerializeFMUstate, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
REFUSED(fmi2GetDirectionalDerivative, const fmi2ValueReference unknown[], size_t n_unknown,
        const fmi2ValueReference known[], size_t n_known, const fmi2Real seed[], fmi2Real sensitivity[])
REFUSED(fmi2SetRealInputDerivatives, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
        const fmi2Real values[])
REFUSED(fmi2GetRealOutputDerivatives, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
        fmi2Real values[])
REFUSED(fmi2GetStatus, const fmi2StatusKind kind, fmi2Status *value)
REFUSED(fmi2GetRealStatus, const fmi2StatusKind kind, fmi2Real *value)
REFUSED(fmi2GetIntegerStatus, const fmi2StatusKind kind, fmi2Integer *value)
REFUSED(fmi2GetBooleanStatus, const fmi2StatusKind kind, fmi2Boolean *value)
REFUSED(fmi2GetStringStatus, const fmi2StatusKind kind, fmi2String *value)
fmi2Status fmi2CancelStep(fmi2Component c) { return fmi2Error; }

#ifndef WITHOUT_STEP
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean no_rollback)
{
    Animal *a = c;
    a->time = time + h;
    calculate(a);
    if (BITES_NOW && time >= 0.499) {
        AT_STEP
    }
    return fmi2OK;
}
#endif
