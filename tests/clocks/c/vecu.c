/* A virtual ECU on a CAN bus by FMI-LS-BUS: sends a frame every *period*, counts what it receives. Its Tx clock is
 * triggered, or a countdown with -DTIMED. */
#include "clocked.h"
#include "can.h"

enum { TX_CLOCK = 1, RX_CLOCK, TX_DATA = 4, RX_DATA };
enum { SENT = 10, RECEIVED, LAST_ID, LAST_PAYLOAD, CONFIRMED, LOST, RECEIVED_AT, MALFORMED };
enum { ID = 20, PERIOD, OFFSET, BURST, DISCARDS };

struct Model {
    Common common;
    Message tx, rx;
    double told;
    int64_t next;
    bool is_pending, is_new;
};

#define N(m, r) ((m)->common.numbers[r])

static size_t model_size(void) { return sizeof(Model); }
static uint32_t clocks_of(uint32_t r) { return r == TX_DATA ? 1u << TX_CLOCK : r == RX_DATA ? 1u << RX_CLOCK : 0; }
static double number(Model *m, uint32_t r) { return N(m, r); }
static void take(Model *m, uint32_t r, double value) { N(m, r) = value; }

static void begin(Model *m) {
    N(m, BURST) = N(m, BURST) ? N(m, BURST) : 1;
    N(m, PERIOD) = N(m, PERIOD) ? N(m, PERIOD) : 1;
    put(&m->tx, CONFIGURATION, 4), put(&m->tx, 13, 4), put(&m->tx, BAUDRATE, 1), put(&m->tx, 100000, 4);
    put(&m->tx, CONFIGURATION, 4), put(&m->tx, 10, 4), put(&m->tx, LOST_BEHAVIOR, 1);
    put(&m->tx, N(m, DISCARDS) ? DISCARD_AND_NOTIFY : BUFFER_AND_RETRANSMIT, 1);
    m->is_pending = m->is_new = true;
}

static double due(const Model *m) { return N(m, OFFSET) + (double)m->next * N(m, PERIOD); }

static void send(Model *m) {
    for (int i = 0; i < N(m, BURST); i++)
        put_frame(&m->tx, (uint32_t)N(m, ID), (uint32_t)N(m, SENT)++);
    m->next++;
}

static Message *message(Model *m, uint32_t r) { return r == TX_DATA ? &m->tx : r == RX_DATA ? &m->rx : NULL; }

static bool polled(Model *m, uint32_t clock) {
    const bool ticks = clock == TX_CLOCK && m->is_pending;
    m->is_pending &= !ticks;
    return ticks;
}

static void ticked(Model *m, uint32_t clock) {
    if (clock == TX_CLOCK && m->common.time > 0.0)
        send(m);
}

static int interval(Model *m, uint32_t clock, double *numerator, double *denominator) {
    (void)clock, (void)denominator;
    if (!m->is_new)
        return UNCHANGED;
    m->is_new = false;
    *numerator = m->common.mode == INITIALIZING ? 0.0 : due(m) - m->common.time;
    return CHANGED;
}

static double go(Model *m, double end, bool *has_event) {
#ifndef TIMED
    while (due(m) <= end + 1e-12)
        send(m);
    *has_event = m->is_pending = m->tx.size > 0;
#endif
    return end;
}

static void receive(Model *m) {
    size_t place = 0;
    const uint8_t *found;
    while ((found = operation(&m->rx, &place))) {
        switch (got(found, 4)) {
        case TRANSMIT:
            N(m, MALFORMED) += got(found + 4, 4) != 16 + got(found + 14, 2) || found[12] || found[13];
            N(m, RECEIVED)++;
            N(m, LAST_ID) = got(found + 8, 4);
            N(m, LAST_PAYLOAD) = got(found + 16, 4);
            N(m, RECEIVED_AT) = m->common.time;
            break;
        case CONFIRM: N(m, CONFIRMED) += got(found + 8, 4) == N(m, ID); break;
        case ARBITRATION_LOST: N(m, LOST) += got(found + 8, 4) == N(m, ID); break;
        case CONFIGURATION: break;
        default: N(m, MALFORMED)++;
        }
    }
    N(m, MALFORMED) += place != m->rx.size;
}

static bool update(Model *m, bool *ends, double *next) {
    (void)ends, (void)next;
    if (m->common.active >> RX_CLOCK & 1u)
        receive(m);
    if (m->common.active >> TX_CLOCK & 1u) {
        m->tx.size = 0;
        m->is_new = true;
    }
    m->rx.size = 0;
    return false;
}
