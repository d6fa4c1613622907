/* A component that is somebody outside: its inputs and parameters go out as datagrams, its outputs are what comes back
 * (docs/udp.md). In lockstep every step waits for its answer; in free mode for the wall clock, with the newest heard.
 *
 * Of the component besides what datagram.h wants: DSE_UDP_IS_FREE, DSE_UDP_TIMEOUT and DSE_UDP_WAIT in s. */
#ifndef DSE_UDP_H
#define DSE_UDP_H

#include <stdarg.h>

#include "datagram.h"

enum { DSE_UDP_DONE, DSE_UDP_ENDED, DSE_UDP_FAILED };
enum { DSE_UDP_LONGEST = 400, DSE_UDP_ENDS = 3, DSE_UDP_MOST_IN_A_STEP = 4096 };
#define DSE_UDP_FIRST_RESEND 0.005
#define DSE_UDP_LAST_RESEND 0.2
#define DSE_UDP_GIVEN_UP 0.1 /* of delay, in s, is not made up for */

/* ---- what is told ---- */

struct dse_udp_text {
    char *at;
    size_t used; /* of DSE_UDP_LONGEST */
};

static void dse_udp_add(struct dse_udp_text *text, const char *format, ...) {
    if (text->used < DSE_UDP_LONGEST) {
        va_list arguments;
        va_start(arguments, format);
        const int more = vsnprintf(text->at + text->used, DSE_UDP_LONGEST - text->used, format, arguments);
        va_end(arguments);
        text->used += more > 0 ? (size_t)more : 0;
    }
}

static double dse_udp_count_ignored(const struct dse_udp *udp, int reasons) {
    double sum = 0.0;
    for (int reason = 0; reason < reasons; reason++) {
        sum += (double)udp->counts.ignored[reason];
    }
    return sum;
}

static void dse_udp_add_ignored(const struct dse_udp *udp, struct dse_udp_text *text) {
    static const char *const reasons[DSE_UDP_REASONS] = {
        "of a wrong size", "of another protocol or version", "torn", "with flags that are wrong here",
        "with values that are none", "of another session", "from elsewhere", "old or doubled"};
    const char *separator = "";
    dse_udp_add(text, "ignored: ");
    for (int reason = 0; reason < DSE_UDP_REASONS; reason++) {
        if (udp->counts.ignored[reason]) {
            dse_udp_add(text, "%s%.0f %s", separator, (double)udp->counts.ignored[reason], reasons[reason]);
            separator = ", ";
        }
    }
    if (udp->counts.ignored[DSE_UDP_WRONG_SIZE]) {
        dse_udp_add(text, " (the last of %lu bytes, right are %lu)", (unsigned long)udp->counts.last_size,
                    (unsigned long)DSE_UDP_HEARD_SIZE);
    }
}

/* Whether something came that nobody in good order sends, or a deadline was missed: then *said* tells it. */
static bool dse_udp_tell_trouble(const struct dse_udp *udp, char said[DSE_UDP_LONGEST + 1]) {
    struct dse_udp_text text = {said, 0};
    const bool has_ignored = dse_udp_count_ignored(udp, DSE_UDP_WRONG_SEQUENCE) > 0.0;
    if (udp->counts.overruns) {
        dse_udp_add(&text, "%.0f deadlines were missed, by %.3g s at most", (double)udp->counts.overruns,
                    udp->counts.latest);
    }
    if (has_ignored) {
        dse_udp_add(&text, udp->counts.overruns ? "; packets " : "packets ");
        dse_udp_add_ignored(udp, &text);
    }
    return has_ignored || udp->counts.overruns;
}

static int dse_udp_fail_silent(const struct dse_udp *udp, double seconds, char *said) {
    struct dse_udp_text text = {said, 0};
    dse_udp_add(&text, "in %g s no packet that can be used came ", seconds);
    if (!DSE_UDP_HOST[0]) {
        dse_udp_add(&text, "from the other side");
    } else {
        dse_udp_add(&text, DSE_UDP_IS_SERVER ? "to %s:%s" : "from %s:%s", DSE_UDP_HOST, DSE_UDP_PORT);
    }
    dse_udp_add(&text, "; ");
    if (dse_udp_count_ignored(udp, DSE_UDP_REASONS) > 0.0) {
        dse_udp_add_ignored(udp, &text);
    } else {
        dse_udp_add(&text, udp->counts.refused ? "nobody listens there"
                           : udp->counts.busy  ? "it is busy with another session"
                                               : "nothing was heard at all");
    }
    return DSE_UDP_FAILED;
}

/* ---- sessions ---- */

/* New at each start, and never 0. */
static int32_t dse_udp_new_session(const struct dse_udp *udp) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    uint64_t hash = (uint64_t)now.tv_sec * 1000000007u + (uint64_t)now.tv_nsec;
    hash = (hash ^ (uint64_t)getpid() << 32 ^ (uint64_t)(uintptr_t)udp) * 0xD6E8FEB86659FD93u;
    hash = (hash ^ hash >> 32) * 0xD6E8FEB86659FD93u;
    return (int32_t)(hash >> 33 | 1u);
}

/* End what is on. END has no answer: it goes out more than once, as any of them may be lost. */
static void dse_udp_end(struct dse_udp *udp) {
    if (udp->session) {
        for (int k = 0; k < DSE_UDP_ENDS && !udp->has_ended; k++) {
            dse_udp_send_other(udp, &udp->peer, udp->session, udp->sequence + 1, DSE_UDP_END);
        }
        udp->former = udp->over[udp->n_over++ % 8] = udp->session;
    }
    udp->session = 0;
    udp->has_ended = udp->was_late = udp->has_zero = false;
}

static bool dse_udp_is_over(const struct dse_udp *udp, int32_t session) {
    for (int k = 0; k < 8; k++) {
        if (udp->over[k] == session) {
            return true;
        }
    }
    return false;
}

static void dse_udp_take(struct dse_udp *udp, int32_t sequence) {
    udp->heard = sequence;
    udp->heard_at = dse_udp_now();
    memcpy(udp->taken, udp->room + DSE_UDP_HEAD, DSE_UDP_HEARD * sizeof *udp->taken);
}

/* ---- what a packet means ---- */

enum { DSE_UDP_GO_ON, DSE_UDP_TAKEN, DSE_UDP_OVER };

static int dse_udp_ignore(struct dse_udp *udp, int reason) {
    udp->counts.ignored[reason]++;
    return DSE_UDP_GO_ON;
}

/* To the client: *next* is the least sequence that it takes; in lockstep no other. */
static int dse_udp_on_answer(struct dse_udp *udp, const struct dse_udp_packet *packet, int32_t next) {
    if (packet->session != udp->session) {
        return dse_udp_ignore(udp, DSE_UDP_WRONG_SESSION);
    }
    if (packet->flags & DSE_UDP_BUSY) {
        udp->counts.busy++;
        return DSE_UDP_GO_ON;
    }
    if (packet->flags & DSE_UDP_END) {
        udp->has_ended = true;
        return DSE_UDP_OVER;
    }
    if (DSE_UDP_IS_FREE ? packet->sequence < next : packet->sequence != next) {
        return dse_udp_ignore(udp, DSE_UDP_WRONG_SEQUENCE);
    }
    dse_udp_take(udp, packet->sequence);
    return DSE_UDP_TAKEN;
}

/* To the server without a session. */
static int dse_udp_on_start(struct dse_udp *udp, const struct dse_udp_packet *packet) {
    if (packet->session <= 0 || dse_udp_is_over(udp, packet->session)) {
        /* Who has not heard the end is told again. */
        if (packet->session > 0 && !(packet->flags & (DSE_UDP_START | DSE_UDP_END))) {
            dse_udp_send_other(udp, &packet->from, packet->session, packet->sequence, DSE_UDP_END);
        }
        return dse_udp_ignore(udp, DSE_UDP_WRONG_SESSION);
    }
    if (!(packet->flags & DSE_UDP_START) || packet->flags & DSE_UDP_END || packet->sequence != 0) {
        return dse_udp_ignore(udp, DSE_UDP_WRONG_SESSION);
    }
    udp->session = packet->session;
    udp->sequence = -1;
    udp->peer = packet->from;
    dse_udp_take(udp, 0);
    return DSE_UDP_TAKEN;
}

/* To the server with one; *next* as above. */
static int dse_udp_on_request(struct dse_udp *udp, const struct dse_udp_packet *packet, int32_t next) {
    if (packet->session != udp->session) {
        if (packet->flags & DSE_UDP_START && !dse_udp_is_over(udp, packet->session)) {
            udp->counts.busy++;
            dse_udp_send_other(udp, &packet->from, packet->session, packet->sequence, DSE_UDP_BUSY);
            return DSE_UDP_GO_ON;
        }
        return dse_udp_ignore(udp, DSE_UDP_WRONG_SESSION);
    }
    if (packet->from.size != udp->peer.size || memcmp(&packet->from.at, &udp->peer.at, udp->peer.size) != 0) {
        return dse_udp_ignore(udp, DSE_UDP_WRONG_SENDER);
    }
    if (packet->flags & DSE_UDP_END) {
        udp->has_ended = true;
        return DSE_UDP_OVER;
    }
    /* A request that comes again has not heard its answer; to a start that does, in free mode, the newest is one. */
    if (DSE_UDP_IS_FREE ? packet->flags & DSE_UDP_START : packet->sequence == udp->sequence) {
        udp->counts.resent++;
        dse_udp_send_other(udp, &udp->peer, udp->session, packet->sequence,
                           packet->sequence ? 0 : DSE_UDP_START);
        return DSE_UDP_GO_ON;
    }
    if (DSE_UDP_IS_FREE ? packet->sequence < next : packet->sequence != next) {
        return dse_udp_ignore(udp, DSE_UDP_WRONG_SEQUENCE);
    }
    dse_udp_take(udp, packet->sequence);
    return DSE_UDP_TAKEN;
}

static int dse_udp_on_packet(struct dse_udp *udp, const struct dse_udp_packet *packet, int32_t next) {
    return !DSE_UDP_IS_SERVER ? dse_udp_on_answer(udp, packet, next)
           : udp->session     ? dse_udp_on_request(udp, packet, next)
                              : dse_udp_on_start(udp, packet);
}

/* ---- waiting ---- */

/* Wait for the packet of the sequence *next*, *patience* long; the client sends its own again and again. */
static int dse_udp_await(struct dse_udp *udp, int32_t next, double patience, char *said) {
    const double until = dse_udp_now() + patience;
    double pause = DSE_UDP_FIRST_RESEND, again = DSE_UDP_IS_SERVER ? until : dse_udp_now() + pause;
    struct dse_udp_packet packet;
    for (;;) {
        const int got = dse_udp_receive(udp, &packet);
        const int meaning = got == DSE_UDP_PACKET ? dse_udp_on_packet(udp, &packet, next) : DSE_UDP_GO_ON;
        if (meaning != DSE_UDP_GO_ON) {
            return meaning == DSE_UDP_TAKEN ? DSE_UDP_DONE : DSE_UDP_ENDED;
        }
        const double now = dse_udp_now();
        if (now >= until) {
            return dse_udp_fail_silent(udp, patience, said);
        }
        if (now >= again) {
            if (next == 0 && udp->former) { /* it may be what the other side is busy with */
                dse_udp_send_other(udp, &udp->peer, udp->former, 0, DSE_UDP_END);
            }
            dse_udp_send(udp, &udp->peer);
            udp->counts.resent++;
            pause = 2.0 * pause < DSE_UDP_LAST_RESEND ? 2.0 * pause : DSE_UDP_LAST_RESEND;
            again = now + pause;
        }
        if (got == DSE_UDP_NOTHING) {
            dse_udp_wait(udp, again < until ? again : until);
        }
    }
}

/* Wait for the wall clock to reach the end of the step, then take the newest that has come. */
static int dse_udp_keep_time(struct dse_udp *udp, double time, double step, char *said) {
    struct dse_udp_packet packet;
    int meaning = DSE_UDP_GO_ON;
    if (!udp->has_zero) {
        udp->zero = dse_udp_now() - time;
        udp->heard_at = dse_udp_now();
        udp->has_zero = true;
    }
    const double deadline = udp->zero + time + step;
    udp->was_late = dse_udp_now() > deadline;
    udp->counts.overruns += udp->was_late;
    dse_udp_sleep_until(deadline);
    udp->lateness = dse_udp_now() - deadline;
    if (udp->was_late && udp->lateness > udp->counts.latest) {
        udp->counts.latest = udp->lateness;
    }
    if (udp->lateness > DSE_UDP_GIVEN_UP) {
        udp->zero += udp->lateness;
    }
    for (int k = 0; k < DSE_UDP_MOST_IN_A_STEP && meaning != DSE_UDP_OVER; k++) {
        const int got = dse_udp_receive(udp, &packet);
        if (got == DSE_UDP_NOTHING) {
            break;
        }
        if (got == DSE_UDP_PACKET) {
            meaning = dse_udp_on_packet(udp, &packet, udp->heard + 1);
        }
    }
    if (meaning != DSE_UDP_OVER && dse_udp_now() - udp->heard_at > DSE_UDP_TIMEOUT) {
        return dse_udp_fail_silent(udp, DSE_UDP_TIMEOUT, said);
    }
    return meaning == DSE_UDP_OVER ? DSE_UDP_ENDED : DSE_UDP_DONE;
}

/* ---- what the component asks ---- */

/* Begin a session at *time*. The initialization may ask more than once: a client whose values have changed begins
 * another one, whose answer is of these values; a server gives what it has heard. */
static int dse_udp_start(struct dse_udp *udp, double time, const double *sent, char *said) {
    if (DSE_UDP_IS_SERVER) {
        return udp->session ? DSE_UDP_DONE : dse_udp_await(udp, 0, DSE_UDP_WAIT, said);
    }
    if (udp->session && memcmp(udp->sent + DSE_UDP_HEAD, sent, DSE_UDP_SENT * sizeof *sent) == 0) {
        return DSE_UDP_DONE;
    }
    dse_udp_end(udp);
    udp->session = dse_udp_new_session(udp);
    udp->sequence = 0;
    udp->heard = -1;
    dse_udp_set_head(udp, udp->session, 0, DSE_UDP_START);
    dse_udp_set_values(udp, time, sent);
    dse_udp_send(udp, &udp->peer);
    return dse_udp_await(udp, 0, DSE_UDP_WAIT, said);
}

/* One step from *time* over *step*. */
static int dse_udp_step(struct dse_udp *udp, double time, double step, const double *sent, char *said) {
    const bool is_first = DSE_UDP_IS_SERVER && udp->sequence < 0;
    udp->sequence++;
    dse_udp_set_head(udp, udp->session, udp->sequence,
                     (is_first ? DSE_UDP_START : 0) | (udp->was_late ? DSE_UDP_LATE : 0));
    dse_udp_set_values(udp, time, sent);
    dse_udp_send(udp, &udp->peer);
    if (DSE_UDP_IS_FREE) {
        return dse_udp_keep_time(udp, time, step, said);
    }
    return dse_udp_await(udp, udp->sequence + DSE_UDP_IS_SERVER, DSE_UDP_TIMEOUT, said);
}

/* What the component asks for at *time*, a start for a *step* of 0: *values* are what was heard, then what is counted.
 * If it fails *said* tells why. */
static int dse_udp_ask(struct dse_udp *udp, double time, double step, const double *sent, double *values,
                       char said[DSE_UDP_LONGEST + 1]) {
    const char *reason = dse_udp_open(udp);
    if (*reason) {
        snprintf(said, DSE_UDP_LONGEST, "no socket for %s:%s: %s", DSE_UDP_HOST, DSE_UDP_PORT, reason);
        return DSE_UDP_FAILED;
    }
    int done = DSE_UDP_ENDED;
    if (!udp->has_ended) {
        done = step > 0.0 ? dse_udp_step(udp, time, step, sent, said) : dse_udp_start(udp, time, sent, said);
    }
    memcpy(values, udp->taken, DSE_UDP_HEARD * sizeof *values);
    values[DSE_UDP_HEARD] = (double)udp->counts.resent;
    values[DSE_UDP_HEARD + 1] = dse_udp_count_ignored(udp, DSE_UDP_REASONS);
    values[DSE_UDP_HEARD + 2] = (double)udp->counts.overruns;
    values[DSE_UDP_HEARD + 3] = udp->lateness;
    return done;
}

static void dse_udp_close(struct dse_udp *udp) {
    dse_udp_end(udp);
    if (udp->is_open) {
        close(udp->line);
    }
    udp->is_open = false;
}

#endif
