/* What a page needs of a system besides its fused loop: instances, start values, initialization, the last row.
 *
 * It does for a page what the kernel (dse/cosim/kernel) does by FMI calls, for systems of FMI 2 that a fused loop
 * simulates. Included by the generated driver (dse/fmu/fusion/web.py), which defines the tables. */
#ifndef DSE_WEB_H
#define DSE_WEB_H

#include "csolve/fused_abi.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define DSE_PAGE __attribute__((visibility("default")))

typedef struct {
    void (*logger)(void *environment, const char *name, int status, const char *category, const char *message, ...);
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
    void *step_finished, *environment;
} dse_web_callbacks;

/* The FMI functions of one element, in the order in which they are called. */
typedef struct {
    void *(*instantiate)(const char *, int, const char *, const char *, const dse_web_callbacks *, int, int);
    int (*reset)(void *);
    int (*setup)(void *, int, double, double, int, double);
    int (*enter)(void *);
    int (*leave)(void *);
    int (*set_real)(void *, const uint32_t *, size_t, const double *);
    int (*set_integer)(void *, const uint32_t *, size_t, const int *);
    int (*set_boolean)(void *, const uint32_t *, size_t, const int *);
    int (*get_real)(void *, const uint32_t *, size_t, double *);
    int (*get_integer)(void *, const uint32_t *, size_t, int *);
    int (*get_boolean)(void *, const uint32_t *, size_t, int *);
    const char *name, *token;
} dse_web_element;

enum { DSE_WEB_REAL, DSE_WEB_INTEGER, DSE_WEB_BOOLEAN };

typedef struct {
    int element, type;
    uint32_t reference;
} dse_web_place;

typedef struct {
    dse_web_place from, to;
} dse_web_wire;

/* What a run came to. */
enum { DSE_WEB_DONE, DSE_WEB_NO_INSTANCE, DSE_WEB_ERROR, DSE_WEB_UNSETTLED, DSE_WEB_STOPPED };

/* One of the systems that a module simulates; its tables have one entry more than is counted. */
typedef struct {
    dse_fused_loop *simulate;
    const dse_web_element *element;
    const dse_web_place *start, *record;
    const dse_web_wire *wire;
    void **instance;
    int elements, starts, recorded, wires;
} dse_web_system;

extern const dse_web_system dse_systems[DSE_SYSTEMS]; /* the driver's */

enum { DSE_LONGEST = 512 };

static double dse_starts[DSE_MOST_STARTS], *dse_rows;
static int64_t dse_progress[3];
static char dse_said[DSE_LONGEST];

static void dse_log(void *environment, const char *name, int status, const char *category, const char *message, ...) {
    (void)environment, (void)category;
    if (status < 2 || dse_said[0])
        return; /* the first error tells why */
    const int length = snprintf(dse_said, sizeof dse_said, "%s: ", name);
    if (length < 0 || length >= DSE_LONGEST)
        return;
    va_list rest;
    va_start(rest, message);
    vsnprintf(dse_said + length, sizeof dse_said - (size_t)length, message, rest);
    va_end(rest);
}

static const dse_web_callbacks dse_callbacks = {dse_log, calloc, free, NULL, NULL};

static bool dse_is_good(int status) { return status < 2; }

static bool dse_set(const dse_web_system *of, dse_web_place at, double value) {
    const dse_web_element *element = &of->element[at.element];
    void *const instance = of->instance[at.element];
    if (at.type == DSE_WEB_REAL)
        return dse_is_good(element->set_real(instance, &at.reference, 1, &value));
    const int whole = (int)value;
    const bool is_integer = at.type == DSE_WEB_INTEGER;
    return dse_is_good((is_integer ? element->set_integer : element->set_boolean)(instance, &at.reference, 1, &whole));
}

static bool dse_get(const dse_web_system *of, dse_web_place at, double *value) {
    const dse_web_element *element = &of->element[at.element];
    void *const instance = of->instance[at.element];
    if (at.type == DSE_WEB_REAL)
        return dse_is_good(element->get_real(instance, &at.reference, 1, value));
    int whole = 0;
    const bool is_integer = at.type == DSE_WEB_INTEGER;
    const int status =
        (is_integer ? element->get_integer : element->get_boolean)(instance, &at.reference, 1, &whole);
    *value = whole;
    return dse_is_good(status);
}

static bool dse_has_all_instances(const dse_web_system *of) {
    for (int e = 0; e < of->elements; e++) {
        const dse_web_element *element = &of->element[e];
        if (!of->instance[e])
            of->instance[e] = element->instantiate(element->name, 1, element->token, "", &dse_callbacks, 0, 0);
        if (!of->instance[e])
            return false;
    }
    return true;
}

/* Pass all wires on until nothing changes; at most as often as there are elements, and once more to see it. */
static int dse_settle(const dse_web_system *of) {
    static double last[DSE_MOST_WIRES];
    for (int turn = 0; turn < of->elements + 2; turn++) {
        bool is_same = turn > 0;
        for (int w = 0; w < of->wires; w++) {
            double value = 0.0;
            if (!dse_get(of, of->wire[w].from, &value))
                return DSE_WEB_ERROR;
            is_same &= value == last[w];
            last[w] = value;
            if (!dse_set(of, of->wire[w].to, value))
                return DSE_WEB_ERROR;
        }
        if (is_same)
            return DSE_WEB_DONE;
    }
    return DSE_WEB_UNSETTLED;
}

/* The start values that a run was given; those that have changed since, or all. */
static bool dse_take(const dse_web_system *of, bool only_changed) {
    static double given[DSE_MOST_STARTS];
    for (int s = 0; s < of->starts; s++) {
        if (only_changed && dse_starts[s] == given[s])
            continue;
        given[s] = dse_starts[s];
        if (!dse_set(of, of->start[s], dse_starts[s]))
            return false;
    }
    return true;
}

static int dse_start(const dse_web_system *of, double stop) {
    for (int e = 0; e < of->elements; e++)
        if (!dse_is_good(of->element[e].reset(of->instance[e])) ||
            !dse_is_good(of->element[e].setup(of->instance[e], 0, 0.0, 0.0, 1, stop)))
            return DSE_WEB_ERROR;
    if (!dse_take(of, false))
        return DSE_WEB_ERROR;
    for (int e = 0; e < of->elements; e++)
        if (!dse_is_good(of->element[e].enter(of->instance[e])))
            return DSE_WEB_ERROR;
    const int settled = dse_settle(of);
    for (int e = 0; e < of->elements && settled == DSE_WEB_DONE; e++)
        if (!dse_is_good(of->element[e].leave(of->instance[e])))
            return DSE_WEB_ERROR;
    return settled;
}

/* ---- what the page calls ---- */

/* Start values of the next run, in the order of its system's. */
DSE_PAGE double *dse_web_starts(void) { return dse_starts; }

/* [steps + 1][recorded], after a run. */
DSE_PAGE double *dse_web_rows(void) { return dse_rows; }

/* Why a run failed, in the component's words; "" for nothing. */
DSE_PAGE const char *dse_web_said(void) { return dse_said; }

/* The step at which a run stopped. */
DSE_PAGE int dse_web_step(void) { return (int)dse_progress[2]; }

/* Makes a system ready for a run of so many steps. */
DSE_PAGE int dse_web_begin(int system, int steps, double stop) {
    const dse_web_system *of = &dse_systems[system];
    dse_said[0] = '\0';
    dse_progress[2] = 0;
    if (!dse_has_all_instances(of))
        return DSE_WEB_NO_INSTANCE;
    free(dse_rows);
    dse_rows = calloc(((size_t)steps + 1) * (size_t)(of->recorded + 1), sizeof *dse_rows);
    return dse_rows ? dse_start(of, stop) : DSE_WEB_NO_INSTANCE;
}

/* Makes the steps from *first* to *last*, and records the row of each and the one behind them. Start values that have
 * changed since are given to the components before, as far as they take them during a run. */
DSE_PAGE int dse_web_go(int system, int first, int last, double step) {
    const dse_web_system *of = &dse_systems[system];
    if (first > 0 && !dse_take(of, true))
        return DSE_WEB_ERROR;
    dse_fused_run run = {.instances = (void *const *)of->instance, .stride = sizeof(void *),
                         .progress = dse_progress, .step = step, .first = first, .steps = last,
                         .out = dse_rows + (size_t)first * of->recorded};
    if (of->simulate(&run) != DSE_FUSED_STOPPED)
        return DSE_WEB_ERROR;
    if (dse_progress[2] != last)
        return DSE_WEB_STOPPED;
    for (int r = 0; r < of->recorded; r++)
        if (!dse_get(of, of->record[r], dse_rows + (size_t)last * of->recorded + r))
            return DSE_WEB_ERROR;
    return DSE_WEB_DONE;
}

#endif
