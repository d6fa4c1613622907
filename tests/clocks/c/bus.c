/* A CAN bus between two nodes: a frame takes its bits' time, the lower id goes first, its sender is told that it went;
 * who loses is told so and forgotten, or waits. Like others of its kind it evaluates its discrete states when the first
 * of its messages is asked for: what comes after that comes too late. */
#include "clocked.h"
#include "can.h"

enum { NODES = 2, MOST_FRAMES = 64, FRAME_BITS = 44, PAYLOAD_BYTES = 4 };
/* Of node k: Tx clock 1 + 2k, Rx clock 2 + 2k; Tx data 10 + 2k, Rx data 11 + 2k. */

typedef struct {
    Message tx, rx;
    uint32_t ids[MOST_FRAMES], payloads[MOST_FRAMES], n, baudrate;
    bool discards, is_new;
} Node;

struct Model {
    Common common;
    Node nodes[NODES];
    double rest;
    bool is_busy, is_evaluated;
};

static size_t model_size(void) { return sizeof(Model); }
static uint32_t clocks_of(uint32_t r) { return r >= 10 && r < 14 ? 1u << (r - 9) : 0; }
static double number(Model *m, uint32_t r) { return m->common.numbers[r]; }
static void take(Model *m, uint32_t r, double value) { m->common.numbers[r] = value; }
static void begin(Model *m) { (void)m; }
static bool polled(Model *m, uint32_t clock) { (void)m, (void)clock; return false; }

static void drop(Node *node) {
    node->n--;
    memmove(node->ids, node->ids + 1, node->n * sizeof *node->ids);
    memmove(node->payloads, node->payloads + 1, node->n * sizeof *node->payloads);
}

static Node *winner(Model *m) {
    Node *a = &m->nodes[0], *b = &m->nodes[1];
    return !a->n && !b->n ? NULL : !b->n || (a->n && a->ids[0] <= b->ids[0]) ? a : b;
}

static void hear(Node *node) {
    size_t place = 0;
    const uint8_t *found;
    while ((found = operation(&node->rx, &place))) {
        if (got(found, 4) == CONFIGURATION && found[8] == BAUDRATE)
            node->baudrate = got(found + 9, 4);
        else if (got(found, 4) == CONFIGURATION && found[8] == LOST_BEHAVIOR)
            node->discards = found[9] == DISCARD_AND_NOTIFY;
        else if (got(found, 4) == TRANSMIT && node->n < MOST_FRAMES) {
            node->ids[node->n] = got(found + 8, 4);
            node->payloads[node->n++] = got(found + 16, 4);
        }
    }
}

static void evaluate(Model *m) {
    if (m->is_evaluated)
        return;
    m->is_evaluated = true;
    for (int k = 0; k < NODES; k++)
        if (m->common.active >> (2 + 2 * k) & 1u)
            hear(&m->nodes[k]);
    if (m->common.active & (1u << 1 | 1u << 3)) {
        Node *sender = winner(m), *other = &m->nodes[sender == &m->nodes[0]];
        put_about(&sender->tx, CONFIRM, sender->ids[0]);
        put_frame(&other->tx, sender->ids[0], sender->payloads[0]);
        drop(sender);
        m->is_busy = false;
        for (int k = 0; k < NODES; k++)
            while (m->nodes[k].discards && m->nodes[k].n) {
                put_about(&m->nodes[k].tx, ARBITRATION_LOST, m->nodes[k].ids[0]);
                drop(&m->nodes[k]);
            }
    }
    if (!m->is_busy && winner(m)) {
        m->is_busy = m->nodes[0].is_new = m->nodes[1].is_new = true;
        m->rest = (FRAME_BITS + PAYLOAD_BYTES) / (double)winner(m)->baudrate;
    }
}

static Message *message(Model *m, uint32_t r) {
    if (r < 10 || r >= 10 + 2 * NODES)
        return NULL;
    Node *node = &m->nodes[(r - 10) / 2];
    if (r % 2)
        return m->is_evaluated ? NULL : &node->rx;
    if (m->common.mode == EVENTS)
        evaluate(m);
    return &node->tx;
}

static void ticked(Model *m, uint32_t clock) {
    if (m->is_evaluated)
        wrong(m, "late tick", clock), abort();
}

static int interval(Model *m, uint32_t clock, double *numerator, double *denominator) {
    (void)denominator;
    Node *node = &m->nodes[clock / 2];
    if (!node->is_new)
        return m->is_busy ? UNCHANGED : NOT_YET_KNOWN;
    node->is_new = false;
    *numerator = m->rest;
    return CHANGED;
}

static double go(Model *m, double end, bool *has_event) { (void)m, (void)has_event; return end; }

static bool update(Model *m, bool *ends, double *next) {
    (void)ends, (void)next;
    evaluate(m);
    m->is_evaluated = false;
    for (int k = 0; k < NODES; k++)
        m->nodes[k].tx.size = m->nodes[k].rx.size = 0;
    return false;
}
