/* The common part of the reference FMUs: values, a solver for co-simulation, and who may call what when.
 *
 * MODEL is the file of the model. It may read and write the fields of Values (generated: variables.h) and defines
 *   initialize   on leaving initialization mode; false (after a message) if that is impossible
 *   calculate    outputs and derivatives from states, inputs and parameters
 *   indicators   event indicators, if there are any
 *   update       one pass of event handling
 *   partial      the derivative of one scalar by another one, if HAS_PARTIAL is defined
 */
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT_ROOM = 256, MOST_STATES = 32 };

typedef enum {
    FLOAT64, FLOAT32, INT8, UINT8, INT16, UINT16, INT32, UINT32, INT64, UINT64, ENUMERATION, BOOLEAN, STRING, BINARY
} Type;

typedef struct {
    size_t size;
    char data[TEXT_ROOM];
} Text;

typedef struct { /* an array's place in Values; sized_by holds offsets of structural parameters, plus one */
    size_t offset, fixed, sized_by[2];
} Extent;

enum { HAS_START = 1, EXTERNAL = 2, TUNABLE = 4, CONTINUOUS = 8, STRUCTURAL = 16 };

typedef struct {
    unsigned reference;
    Type type;
    int flags;
    Extent extent;
} Slot;

static bool set_text(Text *text, const char *data, size_t size)
{
    if (size >= TEXT_ROOM)
        return false;
    memset(text->data, 0, TEXT_ROOM);
    memcpy(text->data, data, size);
    text->size = size;
    return true;
}

#include "variables.h"

typedef enum {
    INSTANTIATED = 1, CONFIGURING = 2, INITIALIZING = 4, STEPPING = 8, HANDLING = 16, CONTINUOUS_TIME = 32, ENDED = 64,
    BROKEN = 128
} Phase;

enum { ANY_PHASE = 255, READABLE = INITIALIZING | STEPPING | HANDLING | CONTINUOUS_TIME | ENDED };

typedef struct { /* all there is to save and restore */
    Values values;
    Phase phase;
    double next_event, before[N_INDICATORS + 1];
    bool stale, set_up;
} State;

typedef struct {
    bool again, ends, states_changed;
} Update;

typedef struct Instance Instance;
static bool complain(Instance *m, const char *format, ...);

typedef enum { MODEL_EXCHANGE, CO_SIMULATION } Interface;

struct Instance {
    State state;
    Interface interface;
    char *name, *resources;
    void *environment, *log;
    bool logging, event_mode, early_return, ends;
    void *intermediate;
};

static bool initialize(Instance *m);
static void calculate(Values *v);
static void update(State *s, Update *what);
#if N_INDICATORS
static void indicators(const Values *v, double *z);
#endif
#ifdef HAS_RESIZED
static void resized(Values *v);
#endif

#include MODEL

static size_t count_of(const Values *v, Extent extent)
{
    size_t count = extent.fixed;
    for (int i = 0; i < 2; i++)
        if (extent.sized_by[i])
            count *= *(const uint64_t *)((const char *)v + extent.sized_by[i] - 1);
    return count;
}

static const Slot *slot_of(unsigned reference)
{
    for (size_t i = 0; i < N_SLOTS; i++)
        if (slots[i].reference == reference)
            return &slots[i];
    return NULL;
}

static void refresh(State *s)
{
    if (s->stale)
        calculate(&s->values);
    s->stale = false;
}

/* What may be set depends on the phase (FMI 2.0.4, 2.1.7 and tables of 3.2.3 and 4.2.4; FMI 3.0, 2.2.7.3). */
static bool settable(const Instance *m, const Slot *slot)
{
    switch (m->state.phase) {
    case CONFIGURING:
        return slot->flags & STRUCTURAL;
    case INSTANTIATED:
    case INITIALIZING:
        return (slot->flags & HAS_START) && !(slot->flags & STRUCTURAL);
    case STEPPING:
        return m->event_mode ? (slot->flags & EXTERNAL) && (slot->flags & CONTINUOUS)
                             : slot->flags & (EXTERNAL | TUNABLE);
    case HANDLING:
        return slot->flags & (EXTERNAL | TUNABLE);
    case CONTINUOUS_TIME:
        return (slot->flags & EXTERNAL) && (slot->flags & CONTINUOUS);
    default:
        return false;
    }
}

/* The slot to read or write as *type*, or NULL after a message. */
static const Slot *slot_for(Instance *m, unsigned reference, Type type, bool writing)
{
    const Slot *slot = slot_of(reference);
    if (!slot || slot->type != type) {
        complain(m, "value reference %u is no variable of the type that was asked for", reference);
        return NULL;
    }
    if (writing && !settable(m, slot)) {
        complain(m, "value reference %u must not be set now (phase %d)", reference, (int)m->state.phase);
        return NULL;
    }
    return slot;
}

static void *place_of(Values *v, const Slot *slot) { return (char *)v + slot->extent.offset; }

static const size_t item_sizes[] = {8, 4, 1, 1, 2, 2, 4, 4, 8, 8, 8, sizeof(bool)};

static bool get_numbers(Instance *m, Type type, const unsigned *references, size_t n, void *values, size_t n_values)
{
    char *to = values, *end = to + n_values * item_sizes[type];
    refresh(&m->state);
    for (size_t i = 0; i < n; i++) {
        const Slot *slot = slot_for(m, references[i], type, false);
        if (!slot)
            return false;
        size_t size = count_of(&m->state.values, slot->extent) * item_sizes[type];
        if (size > (size_t)(end - to))
            return complain(m, "the variables have more values than the %zu asked for", n_values);
        memcpy(to, place_of(&m->state.values, slot), size);
        to += size;
    }
    return to == end || complain(m, "the variables have fewer values than the %zu asked for", n_values);
}

static bool set_numbers(Instance *m, Type type, const unsigned *references, size_t n, const void *values,
                        size_t n_values)
{
    const char *from = values, *end = from + n_values * item_sizes[type];
    for (size_t i = 0; i < n; i++) {
        const Slot *slot = slot_for(m, references[i], type, true);
        if (!slot)
            return false;
        size_t size = count_of(&m->state.values, slot->extent) * item_sizes[type];
        if (size > (size_t)(end - from))
            return complain(m, "the variables have more values than the %zu given", n_values);
        if (slot->flags & STRUCTURAL && *(const uint64_t *)from > 5)
            return complain(m, "sizes are at most 5");
        memcpy(place_of(&m->state.values, slot), from, size);
        from += size;
    }
    m->state.stale = true;
    return from == end || complain(m, "the variables have fewer values than the %zu given", n_values);
}

/* The texts of one variable, *count* of them, or NULL after a message. */
static Text *texts_of(Instance *m, Type type, unsigned reference, bool writing, size_t *count)
{
    if (!writing)
        refresh(&m->state);
    const Slot *slot = slot_for(m, reference, type, writing);
    if (!slot)
        return NULL;
    *count = count_of(&m->state.values, slot->extent);
    m->state.stale |= writing;
    return place_of(&m->state.values, slot);
}

static void begin(Instance *m)
{
    State fresh;
    memset(&fresh, 0, sizeof fresh);
    fresh.phase = INSTANTIATED;
    fresh.next_event = INFINITY;
    fresh.stale = true;
    set_starts(&fresh.values);
    m->state = fresh;
    m->ends = false;
}

static bool allowed(Instance *m, int phases, const char *function)
{
    if (m->state.phase & phases)
        return true;
    complain(m, "%s must not be called now (phase %d)", function, (int)m->state.phase);
    return false;
}

#define UNUSED_OK __attribute__((unused))

static size_t n_states(const Values *v)
{
    size_t n = 0;
    for (int i = 0; i < N_STATE_VARIABLES; i++)
        n += count_of(v, state_slots[i][0]);
    return n;
}

/* Copies all states (which = 0) or derivatives (which = 1) out of or into the values. */
static void move_states(Values *v, int which, double *x, bool writing)
{
    for (int i = 0; i < N_STATE_VARIABLES; i++) {
        size_t n = count_of(v, state_slots[i][which]);
        double *at = (double *)((char *)v + state_slots[i][which].offset);
        memcpy(writing ? at : x, writing ? x : at, n * sizeof(double));
        x += n;
    }
}

#include "co_simulation.h"
