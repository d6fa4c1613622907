/* One clock of any kind, another that it tells others with, a third that others tell it with.
 *
 * bell ticks with every n-th tick; or, if *alone*, by itself at multiples of *delay*, which it returns early for. */
#include "clocked.h"

enum { TICK = 1, BELL, RING };
enum { COUNT = 10, AT, SUM, U, V, HEARD, RINGS, Y, X, SEEN };
enum { KIND = 20, PERIOD, SHIFT_, EVERY, MODE, DELAY, PARTS_, BIAS };
enum { CONSTANT, FIXED, TUNABLE, CHANGING, COUNTDOWN };
enum { USUAL, AFTER_RING, ENDLESS, NEGATIVE, ENDS, ALONE, SPEEDS_UP, AGAIN, ALWAYS_AGAIN };

struct Model {
    Common common;
    double count, sum, at, heard, rings, seen, rung; /* after the last update */
    double rests;                                    /* until the next tick, once told; NAN for nothing to tell */
    double bells;                                    /* when alone: number of the next */
    bool is_told, is_pending;
    int agains;
};

#define N(m, r) ((m)->common.numbers[r])
#define TICKS(m, c) ((m)->common.active >> (c) & 1u)
#define IS(m, mode) (N(m, MODE) == (mode))

static size_t model_size(void) { return sizeof(Model); }

static uint32_t clocks_of(uint32_t r) {
    return r == COUNT || r == AT || r == U || r == SEEN ? 1u << TICK : r == SUM ? 1u << TICK | 1u << BELL
         : r == V || r == HEARD ? 1u << RING : 0;
}

static void begin(Model *m) {
    m->bells = 1;
    N(m, PARTS_) = N(m, PARTS_) ? N(m, PARTS_) : 1;
    m->rests = IS(m, AFTER_RING) ? NAN : IS(m, NEGATIVE) ? -1.0 : N(m, PERIOD);
}

static double number(Model *m, uint32_t r) {
    switch (r) {
    case COUNT: return m->count + TICKS(m, TICK);
    case AT: return TICKS(m, TICK) ? m->common.time : m->at;
    case SUM: return m->sum + (TICKS(m, TICK) ? N(m, U) + N(m, BIAS) : 0.0);
    case HEARD: return m->heard + (TICKS(m, RING) ? N(m, V) : 0.0);
    case SEEN: return TICKS(m, TICK) ? N(m, X) : m->seen;
    case RINGS: return m->rings;
    case Y: return m->common.time;
    default: return N(m, r);
    }
}

static void take(Model *m, uint32_t r, double value) { N(m, r) = value; }
static Message *message(Model *m, uint32_t r) { (void)m, (void)r; return NULL; }

static bool polled(Model *m, uint32_t clock) {
    if (clock != BELL)
        return false;
    return IS(m, ALONE) ? m->is_pending : TICKS(m, TICK) && N(m, EVERY) > 0 && fmod(m->count + 1, N(m, EVERY)) == 0;
}

static void ticked(Model *m, uint32_t clock) { (void)m, (void)clock; }

static int interval(Model *m, uint32_t clock, double *numerator, double *denominator) {
    (void)clock;
    if (isnan(m->rests))
        return m->is_told ? UNCHANGED : NOT_YET_KNOWN;
    *numerator = m->rests;
    *denominator = N(m, PARTS_);
    m->rests = NAN;
    m->is_told = true;
    return CHANGED;
}

static double go(Model *m, double end, bool *has_event) {
    if (!IS(m, ALONE) || m->is_pending || m->bells * N(m, DELAY) > end)
        return end;
    m->is_pending = *has_event = true;
    return N(m, 1) ? m->bells * N(m, DELAY) : end;
}

static bool update(Model *m, bool *ends, double *next) {
    (void)next;
    const bool rings = TICKS(m, RING), ticks = TICKS(m, TICK);
    m->sum = number(m, SUM), m->heard = number(m, HEARD), m->at = number(m, AT), m->seen = number(m, SEEN);
    m->count = number(m, COUNT);
    m->rings += rings;
    if (m->is_pending)
        m->bells++;
    m->is_pending = false;
    if (ticks) {
        m->is_told = false;
        if (N(m, KIND) == CHANGING)
            m->rests = N(m, PERIOD) * (1 + fmod(m->count, 3));
        else if (N(m, KIND) == COUNTDOWN && !IS(m, AFTER_RING))
            m->rests = IS(m, ENDLESS) ? 0.0 : N(m, PERIOD);
        else if (N(m, KIND) == TUNABLE && IS(m, SPEEDS_UP) && m->count == 2)
            m->rests = N(m, PERIOD) / 2;
    }
    if (rings && IS(m, AFTER_RING))
        m->rests = N(m, DELAY);
    *ends = IS(m, ENDS) && m->count == 3;
    m->agains = IS(m, AGAIN) && ticks ? 2 : m->agains - (m->agains > 0);
    return m->agains > 0 || IS(m, ALWAYS_AGAIN);
}
