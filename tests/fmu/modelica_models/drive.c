/* Calls everything an FMI 2.0 importer may call on a model, well and badly; for sanitizers. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2_abi.h"

fmi2Component fmi2Instantiate(fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *, int, int);
void fmi2FreeInstance(fmi2Component);
fmi2Status fmi2SetupExperiment(fmi2Component, int, double, double, int, double);
fmi2Status fmi2EnterInitializationMode(fmi2Component), fmi2ExitInitializationMode(fmi2Component);
fmi2Status fmi2Reset(fmi2Component), fmi2Terminate(fmi2Component);
fmi2Status fmi2DoStep(fmi2Component, double, double, int);
fmi2Status fmi2GetReal(fmi2Component, const unsigned *, size_t, double *);
fmi2Status fmi2SetReal(fmi2Component, const unsigned *, size_t, const double *);
fmi2Status fmi2GetInteger(fmi2Component, const unsigned *, size_t, int *);
fmi2Status fmi2SetInteger(fmi2Component, const unsigned *, size_t, const int *);
fmi2Status fmi2GetBoolean(fmi2Component, const unsigned *, size_t, int *);
fmi2Status fmi2GetFMUstate(fmi2Component, void **), fmi2SetFMUstate(fmi2Component, void *);
fmi2Status fmi2FreeFMUstate(fmi2Component, void **);
fmi2Status fmi2SerializedFMUstateSize(fmi2Component, void *, size_t *);
fmi2Status fmi2SerializeFMUstate(fmi2Component, void *, char *, size_t);
fmi2Status fmi2DeSerializeFMUstate(fmi2Component, const char *, size_t, void **);
fmi2Status fmi2EnterEventMode(fmi2Component), fmi2EnterContinuousTimeMode(fmi2Component);
fmi2Status fmi2NewDiscreteStates(fmi2Component, fmi2EventInfo *);
fmi2Status fmi2CompletedIntegratorStep(fmi2Component, int, int *, int *);
fmi2Status fmi2SetTime(fmi2Component, double);
fmi2Status fmi2SetContinuousStates(fmi2Component, const double *, size_t);
fmi2Status fmi2GetContinuousStates(fmi2Component, double *, size_t);
fmi2Status fmi2GetDerivatives(fmi2Component, double *, size_t);
fmi2Status fmi2GetEventIndicators(fmi2Component, double *, size_t);
fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component, double *, size_t);

static int told;

static void tell(void *environment, fmi2String name, fmi2Status status, fmi2String category, fmi2String text, ...) {
    (void)environment, (void)name, (void)status, (void)category;
    told += text[0] != 0;
}

/* Read and write all of the first *count* value references as every type; most is refused, nothing may break. */
static void touch(fmi2Component c, unsigned count, int is_writing) {
    for (unsigned k = 0; k < count + 2; k++) {
        double real = 0.0;
        int whole = 0, truth = 0;
        const int is_real = fmi2GetReal(c, &k, 1, &real) == fmi2OK;
        const int is_whole = fmi2GetInteger(c, &k, 1, &whole) == fmi2OK;
        (void)fmi2GetBoolean(c, &k, 1, &truth);
        if (is_writing && is_real) {
            (void)fmi2SetReal(c, &k, 1, &real);
        }
        if (is_writing && is_whole) {
            (void)fmi2SetInteger(c, &k, 1, &whole);
        }
    }
}

static fmi2Component begin(fmi2Type type, const fmi2CallbackFunctions *functions, unsigned count) {
    fmi2Component c = fmi2Instantiate("tested", type, "{handmade}", "", functions, 0, 0);
    touch(c, count, 1);
    fmi2SetupExperiment(c, 1, 1e-7, 0.0, 0, 0.0);
    fmi2EnterInitializationMode(c);
    touch(c, count, 1);
    fmi2ExitInitializationMode(c);
    return c;
}

static void co_simulate(const fmi2CallbackFunctions *functions, unsigned count) {
    fmi2Component c = begin(fmi2CoSimulation, functions, count);
    void *state = NULL, *copy = NULL;
    size_t size = 0;
    for (int k = 0; k < 40; k++) {
        const double step = k % 5 == 4 ? 0.1 : 0.013;
        static double time;
        time = k == 0 ? 0.0 : time;
        fmi2DoStep(c, time, step, 1);
        time += step;
        touch(c, count, k % 3 == 0);
        if (k == 20) {
            fmi2GetFMUstate(c, &state);
            fmi2SerializedFMUstateSize(c, state, &size);
        }
    }
    char *bytes = malloc(size);
    fmi2SerializeFMUstate(c, state, bytes, size);
    fmi2DeSerializeFMUstate(c, bytes, size, &copy);
    fmi2DeSerializeFMUstate(c, bytes, size - 1, &copy);
    fmi2SetFMUstate(c, copy);
    free(bytes);
    fmi2FreeFMUstate(c, &state);
    fmi2FreeFMUstate(c, &copy);
    fmi2Terminate(c);
    touch(c, count, 1);
    fmi2Reset(c);
    fmi2DoStep(c, 0.0, 0.1, 1);
    fmi2FreeInstance(c);
}

static void exchange(const fmi2CallbackFunctions *functions, unsigned count, size_t states, size_t indicators) {
    fmi2Component c = begin(fmi2ModelExchange, functions, count);
    double *x = calloc(states + 1, sizeof *x), *slope = calloc(states + 1, sizeof *x);
    double *z = calloc(indicators + 1, sizeof *z), *before = calloc(indicators + 1, sizeof *z);
    double time = 0.0;
    fmi2EventInfo info = {0};
    fmi2NewDiscreteStates(c, &info);
    fmi2EnterContinuousTimeMode(c);
    fmi2GetNominalsOfContinuousStates(c, x, states);
    fmi2GetEventIndicators(c, before, indicators);
    for (int k = 0; k < 400; k++) {
        int event = 0, end = 0, has_crossed = 0;
        double next = time + 0.005;
        fmi2GetContinuousStates(c, x, states);
        fmi2GetDerivatives(c, slope, states);
        if (info.nextEventTimeDefined && info.nextEventTime <= next) {
            next = info.nextEventTime;
            has_crossed = 1;
        }
        for (size_t j = 0; j < states; j++) {
            x[j] += (next - time) * slope[j];
        }
        time = next;
        fmi2SetTime(c, time);
        fmi2SetContinuousStates(c, x, states);
        fmi2CompletedIntegratorStep(c, 1, &event, &end);
        fmi2GetEventIndicators(c, z, indicators);
        for (size_t j = 0; j < indicators; j++) {
            has_crossed |= z[j] < 0.0;
        }
        if (has_crossed) {
            fmi2EnterEventMode(c);
            fmi2NewDiscreteStates(c, &info);
            fmi2EnterContinuousTimeMode(c);
        }
        touch(c, count, k % 7 == 0);
    }
    fmi2SetContinuousStates(c, x, states + 1);
    fmi2Terminate(c);
    fmi2FreeInstance(c);
    free(x), free(slope), free(z), free(before);
}

int main(int argc, char **argv) {
    const fmi2CallbackFunctions functions = {tell, NULL, NULL, NULL, NULL};
    if (argc != 4) {
        return 2;
    }
    co_simulate(&functions, (unsigned)atoi(argv[1]));
    exchange(&functions, (unsigned)atoi(argv[1]), (size_t)atoi(argv[2]), (size_t)atoi(argv[3]));
    printf("told %d\n", told);
    return 0;
}
