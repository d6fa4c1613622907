/* An FMU 2.0 that integrates one small MODEL by one MODE, both given to the compiler; so are its own step GRID in seconds
 * and the steps PARTS in one doStep. Values are real[reference]: the input, two states, their derivatives, a parameter. */
#define _GNU_SOURCE
#include "fmi2Functions.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { U, X, V, DX, DV, K, COUNT };

/* models */
#define DECAY 0
#define SPRING 1
#define FORCED 2
#define STIFF 3
#define LOGISTIC 4
#define BALL 5
#define MASS 6
#define GAIN 7
#define CONTROLLER 8
#define SINE 9
#define LAG 10

/* modes */
#define EULER 0    /* steps of GRID, or PARTS of them in each doStep, the last one cut to the end of doStep */
#define RK4 1      /* the same by Runge and Kutta's method */
#define EULER_HELD 2 /* on a grid of its own: what is due after the end of doStep waits */
#define RK4_HELD 3
#define EULER_LONG 4 /* the same, but a doStep that is longer is one step */
#define ADAPTIVE 5 /* to the tolerance that is told, begun anew in each doStep */
#define OWN_TOLERANCE 6 /* the same, to TOLERANCE whatever is told */
#define FREE 7     /* to TOLERANCE, steps as they come, outputs interpolated */
#define EXACT 8

#ifndef GRID
#define GRID 0.0
#endif
#ifndef PARTS
#define PARTS 1
#endif
#ifndef TOLERANCE
#define TOLERANCE 1e-4
#endif
#ifndef NOISE
#define NOISE 0.0
#endif

typedef struct {
    double real[COUNT], time, told, due;
    double state[2], before[2], slope[2], slope_before[2], reached, from, width; /* of FREE */
    double integral, sampled;
    long sample;
} Part;

static int instances;

static void rates(double k, double t, const double x[2], double u, double d[2])
{
    d[0] = d[1] = 0.0;
#if MODEL == DECAY
    d[0] = -k * x[0];
#elif MODEL == SPRING
    d[0] = x[1];
    d[1] = -4.0 * k * x[0] - 0.4 * x[1];
#elif MODEL == FORCED
    d[0] = k * sin(2.0 * t) - x[0];
#elif MODEL == STIFF
    d[0] = -500.0 * k * (x[0] - cos(t));
#elif MODEL == LOGISTIC
    d[0] = 3.0 * k * x[0] * (1.0 - x[0]);
#elif MODEL == BALL
    d[0] = x[1];
    d[1] = -9.81 * k - x[1] / 2;
#elif MODEL == MASS
    d[0] = x[1];
    d[1] = k * u;
#elif MODEL == LAG
    d[0] = k * (u - x[0]);
#endif
    (void)k, (void)t, (void)x, (void)u;
}

static void initial(Part *p)
{
    p->state[0] = MODEL == LOGISTIC ? 0.1 : MODEL == FORCED || MODEL == LAG ? 0.0 : 1.0;
    p->state[1] = 0.0;
}

static void bounce(double x[2])
{
#if MODEL == BALL
    if (x[0] <= 0.0 && x[1] < 0.0) {
        x[0] = 0.0;
        x[1] *= -0.9;
    }
#endif
    (void)x;
}

static void euler(Part *p, double t, double h, double x[2])
{
    double d[2];
    rates(p->real[K], t, x, p->real[U], d);
    for (int i = 0; i < 2; i++)
        x[i] += h * d[i];
    bounce(x);
}

static void rk4(Part *p, double t, double h, double x[2])
{
    double d[4][2], y[2];
    const double k = p->real[K], u = p->real[U];
    rates(k, t, x, u, d[0]);
    for (int s = 1; s < 4; s++) {
        const double c = s == 3 ? h : h / 2;
        for (int i = 0; i < 2; i++)
            y[i] = x[i] + c * d[s - 1][i];
        rates(k, t + c, y, u, d[s]);
    }
    for (int i = 0; i < 2; i++)
        x[i] += h / 6 * (d[0][i] + 2 * d[1][i] + 2 * d[2][i] + d[3][i]);
    bounce(x);
}

static void one(Part *p, double t, double h, double x[2])
{
    if (MODE == RK4 || MODE == RK4_HELD)
        rk4(p, t, h, x);
    else
        euler(p, t, h, x);
}

/* Bogacki and Shampine's pair; returns the error as a multiple of what is allowed. */
static double pair(Part *p, double t, double h, const double x[2], double y[2], double tolerance)
{
    double a[2], b[2], c[2], d[2], z[2], worst = 0.0;
    const double k = p->real[K], u = p->real[U];
    rates(k, t, x, u, a);
    for (int i = 0; i < 2; i++)
        z[i] = x[i] + h / 2 * a[i];
    rates(k, t + h / 2, z, u, b);
    for (int i = 0; i < 2; i++)
        z[i] = x[i] + 3 * h / 4 * b[i];
    rates(k, t + 3 * h / 4, z, u, c);
    for (int i = 0; i < 2; i++)
        y[i] = x[i] + h / 9 * (2 * a[i] + 3 * b[i] + 4 * c[i]);
    rates(k, t + h, y, u, d);
    for (int i = 0; i < 2; i++) {
        const double error = h * (-5.0 / 72 * a[i] + b[i] / 12 + c[i] / 9 - d[i] / 8);
        worst = fmax(worst, fabs(error) / (tolerance * fmax(1.0, fabs(x[i]))));
    }
    return worst;
}

static double next_width(double h, double error) { return h * fmin(4.0, fmax(0.2, 0.9 * pow(error + 1e-12, -1.0 / 3))); }

static void adaptively(Part *p, double from, double to, double x[2], double tolerance)
{
    double t = from, h = (to - from) / 4;
    while (t < to) {
        double y[2], step = fmin(h, to - t);
        const double error = pair(p, t, step, x, y, tolerance);
#if MODEL == BALL
        if (error <= 1.0 && y[0] <= 0.0 && y[1] < 0.0 && x[0] > 1e-12) { /* where it meets the ground, by bisection */
            double low = 0.0, high = step;
            for (int i = 0; i < 60; i++) {
                const double middle = (low + high) / 2;
                pair(p, t, middle, x, y, tolerance);
                *(y[0] > 0.0 ? &low : &high) = middle;
            }
            step = high;
            pair(p, t, step, x, y, tolerance);
            y[0] = 0.0;
            y[1] *= -0.9;
        }
#endif
        h = next_width(step, error);
        if (error > 1.0)
            continue;
        t = to - t - step < 1e-14 ? to : t + step;
        memcpy(x, y, sizeof y);
    }
}

static void freely(Part *p, double to)
{
    while (p->reached < to) {
        double y[2];
        const double error = pair(p, p->reached, p->width, p->state, y, TOLERANCE), step = p->width;
        p->width = next_width(step, error);
        if (error > 1.0)
            continue;
        memcpy(p->before, p->state, sizeof y);
        rates(p->real[K], p->reached, p->state, p->real[U], p->slope_before);
        memcpy(p->state, y, sizeof y);
        p->from = p->reached;
        p->reached += step;
        rates(p->real[K], p->reached, y, p->real[U], p->slope);
    }
    const double h = p->reached - p->from, s = (to - p->from) / h, r = 1 - s; /* Hermite's cubic */
    for (int i = 0; i < 2; i++)
        p->real[X + i] = r * r * (1 + 2 * s) * p->before[i] + s * s * (3 - 2 * s) * p->state[i]
                         + s * r * h * (r * p->slope_before[i] - s * p->slope[i]);
}

static void exactly(Part *p, double t, double h, double x[2])
{
    const double k = p->real[K], u = p->real[U];
#if MODEL == DECAY
    x[0] *= exp(-k * h);
#elif MODEL == LAG
    x[0] = u + (x[0] - u) * exp(-k * h);
#elif MODEL == MASS
    x[0] += h * x[1] + h * h / 2 * k * u;
    x[1] += h * k * u;
#elif MODEL == SINE
    x[0] = sin(k * (t + h));
#elif MODEL == GAIN
    x[0] = -k * u;
#elif MODEL == CONTROLLER
    while (p->sample * GRID <= t + 1e-9) {
        p->integral += GRID * (1.0 - u);
        p->sampled = 2.0 * k * (1.0 - u) + p->integral;
        p->sample++;
    }
    x[0] = p->sampled;
#endif
    (void)k, (void)u, (void)x, (void)t;
}

static void show(Part *p)
{
    if (MODE != FREE || p->told < 0.0)
        memcpy(&p->real[X], p->state, sizeof p->state);
#if defined(BY_CLOCK)
    p->real[X] += 1e-4 * (double)(time(NULL) % 1000);
#elif defined(BY_PROCESS)
    p->real[X] += 1e-6 * (double)getpid();
#elif defined(BY_COUNT)
    p->real[X] += 1e-4 * (double)instances;
#endif
    rates(p->real[K], p->time, p->state, p->real[U], &p->real[DX]);
}

static void set_up(Part *p)
{
    memset(p, 0, sizeof *p);
    p->real[K] = 1.0;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    Part *p = malloc(sizeof *p);
    set_up(p);
    instances++;
    return p;
}
void fmi2FreeInstance(fmi2Component c) { free(c); }
fmi2Status fmi2Reset(fmi2Component c) { return set_up(c), fmi2OK; }
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop)
{
    ((Part *)c)->told = has_tolerance ? tolerance : TOLERANCE;
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Part *p = c;
    initial(p);
    if (MODEL == GAIN || MODEL == CONTROLLER || MODEL == SINE)
        exactly(p, 0.0, 0.0, p->state);
    p->width = 1e-3;
    memcpy(&p->real[X], p->state, sizeof p->state);
    return show(p), fmi2OK;
}
fmi2Status fmi2Terminate(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean final)
{
    Part *p = c;
    const double end = t + h;
    if (MODE == EULER || MODE == RK4) {
        const double longest = GRID > 0.0 ? GRID : h / PARTS;
        for (double at = t; end - at > 1e-12 * h;) {
            const double width = fmin(longest, end - at);
            one(p, at, width, p->state);
            at += width;
        }
    } else if (MODE == EULER_HELD || MODE == RK4_HELD || (MODE == EULER_LONG && h < GRID)) {
        for (; (p->due + 1) * GRID <= end + 1e-9; p->due++)
            one(p, p->due * GRID, GRID, p->state);
    } else if (MODE == EULER_LONG) {
        one(p, t, h, p->state);
    } else if (MODE == ADAPTIVE || MODE == OWN_TOLERANCE) {
        adaptively(p, t, end, p->state, MODE == ADAPTIVE ? p->told : TOLERANCE);
    } else if (MODE == FREE) {
        freely(p, end);
    } else {
        exactly(p, t, h, p->state);
    }
    p->time = end;
    return show(p), fmi2OK;
}
fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real values[])
{
    if (((Part *)c)->told < 0.0) /* model exchange: outputs follow states */
        show(c);
    for (size_t i = 0; i < n; i++)
        values[i] = ((Part *)c)->real[vr[i]];
    return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real values[])
{
    for (size_t i = 0; i < n; i++)
        ((Part *)c)->real[vr[i]] = values[i];
    return fmi2OK;
}

fmi2Status fmi2EnterEventMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    memset(info, 0, sizeof *info);
    return fmi2OK;
}
fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) { return ((Part *)c)->told = -1.0, fmi2OK; }
fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set, fmi2Boolean *event, fmi2Boolean *end)
{
    *event = *end = fmi2False;
    return fmi2OK;
}
fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) { return ((Part *)c)->time = time, fmi2OK; }
fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n)
{
    memcpy(((Part *)c)->state, x, n * sizeof *x);
    return show(c), fmi2OK;
}
fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    memcpy(x, ((Part *)c)->state, n * sizeof *x);
    return fmi2OK;
}
fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real x[], size_t n)
{
    show(c);
    memcpy(x, &((Part *)c)->real[DX], n * sizeof *x);
    return fmi2OK;
}
fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real z[], size_t n) { return fmi2OK; }
fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    for (size_t i = 0; i < n; i++)
        x[i] = 1.0;
    return fmi2OK;
}
