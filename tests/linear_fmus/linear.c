/* x' = A x + B u, y = C x + D u with up to 4 states, 3 inputs and 3 outputs, FMI 2.0 or 3.0 as -DFMI says. All numbers
 * are parameters. A step integrates with the classic Runge-Kutta method in *parts*, inputs held or (FMI 2) moved along
 * the slopes they were given. Outputs follow inputs at any time. Steps
 * that are longer than *longest* are discarded, if it is set. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { STATES = 4, INPUTS = 3, OUTPUTS = 3 };
enum { U = 0, Y = 8, X = 16, A = 32, B = 48, C = 64, D = 80, PARTS = 96, LONGEST = 97, SIZE = 98 };

typedef struct {
    double value[SIZE], slope[INPUTS];
    bool stepping;
} Model;

static void show(Model *m)
{
    for (int i = 0; i < OUTPUTS; i++) {
        double y = 0;
        for (int j = 0; j < STATES; j++)
            y += m->value[C + STATES * i + j] * m->value[X + j];
        for (int j = 0; j < INPUTS; j++)
            y += m->value[D + INPUTS * i + j] * m->value[U + j];
        m->value[Y + i] = y;
    }
}

static void rate(const Model *m, const double *x, double passed, double *to)
{
    for (int i = 0; i < STATES; i++) {
        to[i] = 0;
        for (int j = 0; j < STATES; j++)
            to[i] += m->value[A + STATES * i + j] * x[j];
        for (int j = 0; j < INPUTS; j++)
            to[i] += m->value[B + INPUTS * i + j] * (m->value[U + j] + m->slope[j] * passed);
    }
}

static int step(Model *m, double length)
{
    double *x = m->value + X, k[4][STATES], at[STATES];
    const int parts = (int)m->value[PARTS];
    if (m->value[LONGEST] > 0 && length > m->value[LONGEST])
        return 2;
    const double h = length / parts;
    for (int part = 0; part < parts; part++) {
        const double passed = part * h;
        rate(m, x, passed, k[0]);
        for (int s = 1; s < 4; s++) {
            const double ahead = s == 3 ? h : 0.5 * h;
            for (int i = 0; i < STATES; i++)
                at[i] = x[i] + ahead * k[s - 1][i];
            rate(m, at, passed + ahead, k[s]);
        }
        for (int i = 0; i < STATES; i++)
            x[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
    }
    for (int j = 0; j < INPUTS; j++) {
        m->value[U + j] += m->slope[j] * length;
        m->slope[j] = 0;
    }
    m->stepping = true;
    return 0;
}

static int reset(Model *m)
{
    memset(m, 0, sizeof *m);
    m->value[PARTS] = 1;
    return 0;
}

static void *make(void)
{
    Model *m = malloc(sizeof *m);
    if (m)
        reset(m);
    return m;
}

static int save(const Model *m, void **state)
{
    if (!*state)
        *state = malloc(sizeof *m);
    memcpy(*state, m, sizeof *m);
    return 0;
}

static int forget(void **state)
{
    free(*state);
    *state = NULL;
    return 0;
}

static int get(Model *m, const uint32_t *reference, size_t n, double *value)
{
    show(m);
    for (size_t i = 0; i < n; i++)
        value[i] = m->value[reference[i]];
    return 0;
}

static int set(Model *m, const uint32_t *reference, size_t n, const double *value)
{
    for (size_t i = 0; i < n; i++)
        m->value[reference[i]] = value[i];
    return 0;
}

#if FMI == 2
EXPORT void *fmi2Instantiate(const char *name, int type, const char *token, const char *resources, const void *callbacks,
                             int visible, int logging)
{
    (void)name, (void)token, (void)resources, (void)callbacks, (void)visible, (void)logging;
    return type == 1 ? make() : NULL;
}
EXPORT void fmi2FreeInstance(void *m) { free(m); }
EXPORT int fmi2SetupExperiment(void *m, int has_tolerance, double tolerance, double start, int has_stop, double stop)
{
    return (void)m, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop, 0;
}
EXPORT int fmi2EnterInitializationMode(void *m) { return (void)m, 0; }
EXPORT int fmi2ExitInitializationMode(void *m) { return (void)m, 0; }
EXPORT int fmi2Terminate(void *m) { return (void)m, 0; }
EXPORT int fmi2Reset(void *m) { return reset(m); }
EXPORT int fmi2DoStep(void *m, double time, double h, int final) { return (void)time, (void)final, step(m, h); }
EXPORT int fmi2GetReal(void *m, const uint32_t *r, size_t n, double *value) { return get(m, r, n, value); }
EXPORT int fmi2SetReal(void *m, const uint32_t *r, size_t n, const double *value) { return set(m, r, n, value); }
EXPORT int fmi2GetFMUstate(void *m, void **state) { return save(m, state); }
EXPORT int fmi2SetFMUstate(void *m, void *state) { return memcpy(m, state, sizeof(Model)), 0; }
EXPORT int fmi2FreeFMUstate(void *m, void **state) { return (void)m, forget(state); }
EXPORT int fmi2SetRealInputDerivatives(void *m, const uint32_t *r, size_t n, const int *order, const double *value)
{
    for (size_t i = 0; i < n; i++) {
        if (order[i] != 1 || r[i] >= INPUTS)
            return 3;
        ((Model *)m)->slope[r[i]] = value[i];
    }
    return 0;
}
#else
EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                         bool logging, bool events, bool early, const uint32_t *intermediate,
                                         size_t n_intermediate, void *environment, void *log, void *update)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)events, (void)early;
    (void)intermediate, (void)n_intermediate, (void)environment, (void)log, (void)update;
    return make();
}
EXPORT void fmi3FreeInstance(void *m) { free(m); }
EXPORT int fmi3EnterInitializationMode(void *m, bool has_tolerance, double tolerance, double start, bool has_stop,
                                       double stop)
{
    return (void)m, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop, 0;
}
EXPORT int fmi3ExitInitializationMode(void *m) { return (void)m, 0; }
EXPORT int fmi3Terminate(void *m) { return (void)m, 0; }
EXPORT int fmi3Reset(void *m) { return reset(m); }
EXPORT int fmi3DoStep(void *m, double time, double h, bool final, bool *event, bool *ended, bool *early, double *reached)
{
    (void)final;
    *event = *ended = *early = false;
    *reached = time + h;
    return step(m, h);
}
EXPORT int fmi3GetFloat64(void *m, const uint32_t *r, size_t n, double *value, size_t count)
{
    return (void)count, get(m, r, n, value);
}
EXPORT int fmi3SetFloat64(void *m, const uint32_t *r, size_t n, const double *value, size_t count)
{
    return (void)count, set(m, r, n, value);
}
EXPORT int fmi3GetFMUState(void *m, void **state) { return save(m, state); }
EXPORT int fmi3SetFMUState(void *m, void *state) { return memcpy(m, state, sizeof(Model)), 0; }
EXPORT int fmi3FreeFMUState(void *m, void **state) { return (void)m, forget(state); }
#endif
