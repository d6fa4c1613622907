/* An external component: its inputs and parameters are sent as datagrams, its outputs are the answers (docs/udp.md).
 * In lockstep every step waits for its answer. In free mode it waits for the wall clock, and uses the newest answer.
 *
 * Defined by the component in addition to datagram.h: DSE_UDP_IS_FREE, DSE_UDP_TIMEOUT and DSE_UDP_WAIT in s;
 * DSE_UDP_FIRST_RESEND in s, where nothing can be lost. */
#ifndef DSE_UDP_H
#define DSE_UDP_H

#include "udp_told.h"

enum { DSE_UDP_ENDS = 3, DSE_UDP_MOST_IN_A_STEP = 4096 };
#ifndef DSE_UDP_FIRST_RESEND
#define DSE_UDP_FIRST_RESEND 0.005
#endif
#define DSE_UDP_LAST_RESEND 0.2
#define DSE_UDP_GIVEN_UP 0.1 /* in s: a longer delay is not caught up */

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

/* End the session. END has no answer: it is sent several times, as packets may be lost. */
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

/* ---- meaning of packets ---- */

enum { DSE_UDP_GO_ON, DSE_UDP_TAKEN, DSE_UDP_OVER };

static int dse_udp_ignore(struct dse_udp *udp, int reason) {
    udp->counts.ignored[reason]++;
    return DSE_UDP_GO_ON;
}

/* To the client: *next* is the least sequence that it accepts; in lockstep the only one. */
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
        /* A client that missed the end gets it again. */
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

/* To the server with a session; *next* as above. */
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
    /* The client of a repeated request missed the answer. In free mode a repeated start gets the newest packet. */
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

/* Wait for the packet of the sequence *next*, *patience* long; the client resends its own repeatedly. */
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
            if (next == 0 && udp->former) { /* it may be the session that the other side is busy with */
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

/* Wait for the wall clock to reach the end of the step, then take the newest received packet. */
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

/* ---- functions for the component ---- */

/* Begin a session at *time*. The initialization may call this repeatedly: a client whose values have changed begins
 * another session, whose answer is for these values; a server returns the received values. */
static int dse_udp_start(struct dse_udp *udp, double time, const double *sent, char *said) {
    if (DSE_UDP_IS_SERVER) {
        if (!udp->session) {
            dse_udp_set_head(udp, 0, 0, 0);
            dse_udp_set_values(udp, time, sent); /* for a client with another layout */
        }
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

/* Exchange at *time*, a start for a *step* of 0: *values* are the received values, then the counts. On failure *said*
 * has the reason. */
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
