/* The datagrams of docs/udp.md: a socket, packets of doubles, and counts of invalid packets. POSIX only.
 *
 * Defined by the component: DSE_UDP_SENT and DSE_UDP_HEARD, the numbers of sent and received values; DSE_UDP_IS_SERVER;
 * DSE_UDP_HOST ("" for the socket with the number in DSE_LIVE_SOCKET) and DSE_UDP_PORT; DSE_UDP_WHOLES, {place, least,
 * greatest} of the received values that are integers; DSE_UDP_LAYOUT, optional, the required last received value;
 * DSE_UDP_ANSWERS_HOST and DSE_UDP_ANSWERS_PORT, optional, where a server sends to instead of to the sender. */
#ifndef DSE_DATAGRAM_H
#define DSE_DATAGRAM_H

#ifdef _WIN32
#error "components of the kind udp are built for Linux and macOS"
#endif
#if !defined __BYTE_ORDER__ || __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "packets are copied as they lie in memory: little-endian"
#endif
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#ifndef MSG_DONTWAIT
#define MSG_DONTWAIT 0x80 /* macOS hides it from programs that request POSIX */
#endif

enum { DSE_UDP_MAGIC_VERSION = 0x44534531, DSE_UDP_HEAD = 24 };
enum { DSE_UDP_START = 1, DSE_UDP_END = 2, DSE_UDP_LATE = 4, DSE_UDP_BUSY = 8, DSE_UDP_ANSWER = 16, DSE_UDP_FLAGS = 31 };
#define DSE_UDP_SIZE(count) (DSE_UDP_HEAD + 8 * (count) + 4)
#define DSE_UDP_SENT_SIZE DSE_UDP_SIZE(DSE_UDP_SENT)
#define DSE_UDP_HEARD_SIZE DSE_UDP_SIZE(DSE_UDP_HEARD)

/* Why a packet is ignored. */
enum {
    DSE_UDP_WRONG_SIZE,
    DSE_UDP_WRONG_VERSION,
    DSE_UDP_TORN,
    DSE_UDP_WRONG_FLAGS,
    DSE_UDP_WRONG_VALUE,
    DSE_UDP_WRONG_LAYOUT,
    DSE_UDP_WRONG_SESSION,
    DSE_UDP_WRONG_SENDER,
    DSE_UDP_WRONG_SEQUENCE, /* also for duplicated or reordered packets, which are not an error */
    DSE_UDP_REASONS
};

/* A sender or receiver. *size* is 0 for the address that the socket is connected to. */
struct dse_udp_address {
    struct sockaddr_storage at;
    socklen_t size;
};

/* Counts; *last_size* is the size of the last packet that was too long or too short, *latest* the largest delay after a
 * deadline in s. */
struct dse_udp_counts {
    uint64_t resent, busy, overruns, refused, ignored[DSE_UDP_REASONS];
    double latest;
    size_t last_size;
};

struct dse_udp {
    int line;
    bool is_open;
    /* The session: active if *session* is not 0. Numbers of the last sent and the last received packet. */
    bool has_ended, was_late; /* by the other side; whether the last deadline was missed */
    int32_t session, former, sequence, heard;
    int32_t over[8]; /* sessions that ended last */
    uint32_t n_over;
    struct dse_udp_address peer;
    struct dse_udp_address answers; /* of size 0: answers are sent to the sender of the request */
    /* Wall-clock times in s: of simulated time 0 (extrapolated if the run starts later), of the last reception. */
    double zero, heard_at, lateness;
    bool has_zero;
    struct dse_udp_counts counts;
    /* The last sent packet, a received one, and the values that are taken from those. */
    unsigned char sent[DSE_UDP_SENT_SIZE], room[DSE_UDP_HEARD_SIZE + 1];
    double taken[DSE_UDP_HEARD + 1];
};

/* Head of a received packet. Its values are in *room*. */
struct dse_udp_packet {
    int32_t session, sequence, flags;
    struct dse_udp_address from;
};

static const struct {
    uint32_t place;
    double least, greatest;
} dse_udp_wholes[] = {DSE_UDP_WHOLES{UINT32_MAX, 0.0, 0.0}};

static double dse_udp_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void dse_udp_sleep_until(double time) {
    for (double rest = time - dse_udp_now(); rest > 0.0; rest = time - dse_udp_now()) {
        const struct timespec nap = {(time_t)rest, (long)(1e9 * (rest - floor(rest)))};
        nanosleep(&nap, NULL);
    }
}

/* ---- the socket ---- */

/* Find the address that answers are sent to, of the *family* of the socket: "" or the reason of the failure. */
static const char *dse_udp_find_answers(struct dse_udp *udp, int family) {
#ifdef DSE_UDP_ANSWERS_HOST
    struct addrinfo wanted, *found = NULL;
    memset(&wanted, 0, sizeof wanted);
    wanted.ai_family = family;
    wanted.ai_socktype = SOCK_DGRAM;
    const int error = getaddrinfo(DSE_UDP_ANSWERS_HOST, DSE_UDP_ANSWERS_PORT, &wanted, &found);
    if (error) {
        return gai_strerror(error);
    }
    memcpy(&udp->answers.at, found->ai_addr, found->ai_addrlen);
    udp->answers.size = found->ai_addrlen;
    freeaddrinfo(found);
#else
    (void)udp, (void)family;
#endif
    return "";
}

/* "" or the reason of the failure. */
static const char *dse_udp_open(struct dse_udp *udp) {
    if (udp->is_open) {
        return "";
    }
    if (!DSE_UDP_HOST[0]) {
        const char *told = getenv("DSE_LIVE_SOCKET");
        char *end = NULL;
        const long number = told ? strtol(told, &end, 10) : -1;
        udp->line = told && end != told && !*end && number >= 0 && number <= INT32_MAX
                        ? fcntl((int)number, F_DUPFD_CLOEXEC, 3) : -1;
        udp->is_open = udp->line >= 0;
        return udp->is_open ? "" : "DSE_LIVE_SOCKET has no number of an open socket";
    }
    struct addrinfo wanted, *found = NULL;
    memset(&wanted, 0, sizeof wanted);
    wanted.ai_family = strchr(DSE_UDP_HOST, ':') ? AF_INET6 : AF_INET;
    wanted.ai_socktype = SOCK_DGRAM;
    const int error = getaddrinfo(DSE_UDP_HOST, DSE_UDP_PORT, &wanted, &found);
    if (error) {
        return gai_strerror(error);
    }
    udp->line = socket(found->ai_family, SOCK_DGRAM, 0);
    const bool is_ok = udp->line >= 0 && fcntl(udp->line, F_SETFD, FD_CLOEXEC) == 0
                       && (DSE_UDP_IS_SERVER ? bind(udp->line, found->ai_addr, found->ai_addrlen)
                                             : connect(udp->line, found->ai_addr, found->ai_addrlen)) == 0;
    const char *reason = is_ok ? dse_udp_find_answers(udp, found->ai_family) : strerror(errno);
    freeaddrinfo(found);
    if (*reason && udp->line >= 0) {
        close(udp->line);
    }
    udp->is_open = !*reason;
    return reason;
}

/* ---- packets ---- */

static void dse_udp_set_head(struct dse_udp *udp, int32_t session, int32_t sequence, int32_t flags) {
    const int32_t head[4] = {DSE_UDP_MAGIC_VERSION, session, sequence,
                             flags | (DSE_UDP_IS_SERVER ? DSE_UDP_ANSWER : 0)};
    memcpy(udp->sent, head, sizeof head);
    memcpy(udp->sent + DSE_UDP_SENT_SIZE - sizeof sequence, &sequence, sizeof sequence);
}

static void dse_udp_set_values(struct dse_udp *udp, double time, const double *values) {
    memcpy(udp->sent + sizeof(int32_t[4]), &time, sizeof time);
    memcpy(udp->sent + DSE_UDP_HEAD, values, DSE_UDP_SENT * sizeof *values);
}

/* Packets that are lost or not accepted are handled in the same way: they are sent again. */
static void dse_udp_send(const struct dse_udp *udp, const struct dse_udp_address *to) {
    to = udp->answers.size ? &udp->answers : to;
    while (sendto(udp->line, udp->sent, DSE_UDP_SENT_SIZE, MSG_DONTWAIT,
                  to->size ? (const struct sockaddr *)(const void *)&to->at : NULL, to->size) < 0 && errno == EINTR) {
    }
}

/* Send a packet to *to* that is not the last one of its session, with the values of the last one. */
static void dse_udp_send_other(struct dse_udp *udp, const struct dse_udp_address *to, int32_t session,
                               int32_t sequence, int32_t flags) {
    int32_t head[4];
    memcpy(head, udp->sent, sizeof head);
    dse_udp_set_head(udp, session, sequence, flags);
    dse_udp_send(udp, to);
    dse_udp_set_head(udp, head[1], head[2], head[3]);
}

/* Why the values in *room* are invalid, or DSE_UDP_REASONS. */
static int dse_udp_judge_values(const struct dse_udp *udp, int32_t flags) {
    double value;
    for (size_t k = 0; k <= DSE_UDP_HEARD; k++) { /* the time first */
        memcpy(&value, udp->room + sizeof(int32_t[4]) + 8 * k, sizeof value);
        if (!isfinite(value)) {
            return DSE_UDP_WRONG_VALUE;
        }
    }
    for (size_t k = 0; !(flags & (DSE_UDP_END | DSE_UDP_BUSY)) && dse_udp_wholes[k].place != UINT32_MAX; k++) {
        memcpy(&value, udp->room + DSE_UDP_HEAD + 8 * (size_t)dse_udp_wholes[k].place, sizeof value);
        if (!(value >= dse_udp_wholes[k].least && value <= dse_udp_wholes[k].greatest && value == floor(value))) {
            return DSE_UDP_WRONG_VALUE;
        }
    }
#ifdef DSE_UDP_LAYOUT
    memcpy(&value, udp->room + DSE_UDP_HEARD_SIZE - sizeof(int32_t) - sizeof value, sizeof value);
    if (!(flags & DSE_UDP_BUSY) && value != DSE_UDP_LAYOUT) {
        return DSE_UDP_WRONG_LAYOUT;
    }
#endif
    return DSE_UDP_REASONS;
}

/* Why the *size* bytes in *room* are not a packet, or DSE_UDP_REASONS with its head. */
static int dse_udp_judge(struct dse_udp *udp, size_t size, struct dse_udp_packet *packet) {
    int32_t head[4], again;
    if (size != DSE_UDP_HEARD_SIZE) {
        udp->counts.last_size = size;
        return DSE_UDP_WRONG_SIZE;
    }
    memcpy(head, udp->room, sizeof head);
    memcpy(&again, udp->room + size - sizeof again, sizeof again);
    packet->session = head[1];
    packet->sequence = head[2];
    packet->flags = head[3];
    if (head[0] != DSE_UDP_MAGIC_VERSION) {
        return DSE_UDP_WRONG_VERSION;
    }
    if (head[2] != again) {
        return DSE_UDP_TORN;
    }
    if ((head[3] & ~DSE_UDP_FLAGS) || (head[3] & DSE_UDP_ANSWER) != (DSE_UDP_IS_SERVER ? 0 : DSE_UDP_ANSWER)) {
        return DSE_UDP_WRONG_FLAGS;
    }
    return dse_udp_judge_values(udp, head[3]);
}

enum { DSE_UDP_NOTHING, DSE_UDP_IGNORED, DSE_UDP_PACKET };

/* A client that begins a session with packets of another size or layout gets one of our packets, so that both sides can
 * report the difference. It is not much larger than the request, as the sender is not verified. */
static void dse_udp_show(struct dse_udp *udp, size_t size, const struct dse_udp_address *to) {
    int32_t head[4];
    if (size < DSE_UDP_HEAD || 4 * size < DSE_UDP_SENT_SIZE) {
        return;
    }
    memcpy(head, udp->room, sizeof head);
    if (head[0] == DSE_UDP_MAGIC_VERSION && head[3] == DSE_UDP_START) {
        dse_udp_send_other(udp, to, head[1], head[2], DSE_UDP_END);
    }
}

/* Receive one datagram from the socket, if there is one. */
static int dse_udp_receive(struct dse_udp *udp, struct dse_udp_packet *packet) {
    packet->from.size = sizeof packet->from.at;
    const ssize_t size = recvfrom(udp->line, udp->room, sizeof udp->room, MSG_DONTWAIT,
                                  (struct sockaddr *)(void *)&packet->from.at, &packet->from.size);
    if (size < 0) {
        udp->counts.refused += errno == ECONNREFUSED;
        return errno == ECONNREFUSED || errno == EINTR ? DSE_UDP_IGNORED : DSE_UDP_NOTHING;
    }
    if (!DSE_UDP_IS_SERVER || !DSE_UDP_HOST[0]) {
        packet->from.size = 0;
    }
    const int reason = dse_udp_judge(udp, (size_t)size, packet);
    if (reason == DSE_UDP_REASONS) {
        return DSE_UDP_PACKET;
    }
    udp->counts.ignored[reason]++;
    if (DSE_UDP_IS_SERVER && (reason == DSE_UDP_WRONG_SIZE || reason == DSE_UDP_WRONG_LAYOUT)) {
        dse_udp_show(udp, (size_t)size, &packet->from);
    }
    return DSE_UDP_IGNORED;
}

/* Wait for a datagram until *until* at most. */
static void dse_udp_wait(const struct dse_udp *udp, double until) {
    const double rest = until - dse_udp_now();
    struct pollfd files = {udp->line, POLLIN, 0};
    if (rest > 0.0) {
        poll(&files, 1, rest > 1e6 ? 1000000000 : (int)ceil(1e3 * rest));
    }
}

#endif
