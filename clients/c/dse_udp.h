/* The answering side of dse's datagrams (docs/udp.md), for a world in C99 on Linux, macOS or Windows (link ws2_32).
 *
 *     dse_udp_world world;
 *     double asked[2], told[3] = {0};
 *     if (!dse_udp_open(&world, "127.0.0.1", 5005, 2, 3)) return 1;
 *     for (;;) {
 *         switch (dse_udp_wait(&world, asked, -1.0)) {
 *         case DSE_UDP_STARTED: reset();               dse_udp_answer(&world, world.time, told); break;
 *         case DSE_UDP_STEP:    advance(0.01, asked);  dse_udp_answer(&world, world.time + 0.01, told); break;
 *         case DSE_UDP_ENDED:   break;
 *         }
 *     }
 *
 * Lockstep: each STARTED and each STEP wants one answer. Free: wait with 0 s until NOTHING, step by the clock, tell.
 * A clock: double next = dse_udp_now(); … dse_udp_sleep_until(next = dse_udp_deadline(next, step, dse_udp_now()));
 * Doubles must be IEEE 754 and little-endian, as on x86 and ARM. A world is one thread's. */
#ifndef DSE_UDP_WORLD_H
#define DSE_UDP_WORLD_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <winsock2.h>
#include <ws2tcpip.h>
typedef SOCKET dse_udp_socket;
typedef int dse_udp_length;
#else
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
typedef int dse_udp_socket;
typedef socklen_t dse_udp_length;
#endif

#define DSE_UDP_MAGIC_VERSION 0x44534531
#define DSE_UDP_MOST_VALUES 8000
enum { DSE_UDP_START = 1, DSE_UDP_END = 2, DSE_UDP_LATE = 4, DSE_UDP_BUSY = 8, DSE_UDP_ANSWER = 16 };
typedef enum { DSE_UDP_NOTHING, DSE_UDP_STARTED, DSE_UDP_STEP, DSE_UDP_ENDED, DSE_UDP_BROKEN } dse_udp_event;

typedef struct {
    dse_udp_socket line;
    bool is_free;              /* set it after opening: own clock, newest packet counts */
    int n_asked, n_told;       /* values each way */
    int32_t session;           /* 0: none is on */
    int32_t sequence, flags;   /* of the last packet that was taken */
    double time;               /* of it, in s */
    int32_t told;              /* sequence of what was told last, -1 if nothing was */
    unsigned long ignored;     /* datagrams that were none of ours, or old */
    struct sockaddr_in peer;
    int32_t over[8];           /* sessions that ended last */
    unsigned n_over;
    unsigned char *room, *last; /* what came, what was told last */
} dse_udp_world;

static size_t dse_udp_size(int count) { return 28 + 8 * (size_t)count; }

static void dse_udp_close(dse_udp_world *world) {
#ifdef _WIN32
    closesocket(world->line);
#else
    close(world->line);
#endif
    free(world->room);
    free(world->last);
    world->room = world->last = NULL;
}

/* Listen on the IPv4 address *host*; false if that is impossible. */
static bool dse_udp_open(dse_udp_world *world, const char *host, unsigned short port, int n_asked, int n_told) {
    struct sockaddr_in at;
    memset(world, 0, sizeof *world);
    memset(&at, 0, sizeof at);
    at.sin_family = AF_INET;
    at.sin_port = htons(port);
    if (n_asked < 0 || n_told < 0 || n_asked > DSE_UDP_MOST_VALUES || n_told > DSE_UDP_MOST_VALUES
        || inet_pton(AF_INET, host, &at.sin_addr) != 1) {
        return false;
    }
#ifdef _WIN32
    WSADATA about;
    if (WSAStartup(MAKEWORD(2, 2), &about)) {
        return false;
    }
#endif
    world->n_asked = n_asked;
    world->n_told = n_told;
    world->told = -1;
    world->room = malloc(dse_udp_size(n_asked) + 1);
    world->last = calloc(1, dse_udp_size(n_told));
    world->line = socket(AF_INET, SOCK_DGRAM, 0);
    if (world->room && world->last && bind(world->line, (struct sockaddr *)&at, sizeof at) == 0) {
        return true;
    }
    dse_udp_close(world);
    return false;
}

static void dse_udp_send(dse_udp_world *world, const unsigned char *data, const struct sockaddr_in *to) {
    (void)sendto(world->line, (const char *)data, (int)dse_udp_size(world->n_told), 0, (const struct sockaddr *)to,
                 sizeof *to);
}

static void dse_udp_head(unsigned char *data, size_t size, int32_t session, int32_t sequence, int32_t flags) {
    const int32_t head[4] = {DSE_UDP_MAGIC_VERSION, session, sequence, flags | DSE_UDP_ANSWER};
    memcpy(data, head, sizeof head);
    memcpy(data + size - 4, &sequence, 4);
}

static bool dse_udp_is_finite(const unsigned char *at) {
    uint64_t bits;
    memcpy(&bits, at, 8);
    return (bits >> 52 & 0x7FF) != 0x7FF;
}

/* Whether the *size* bytes that came are a packet of a client; *head* is its head. */
static bool dse_udp_is_packet(const dse_udp_world *world, size_t size, int32_t head[4]) {
    int32_t closing;
    if (size != dse_udp_size(world->n_asked)) {
        return false;
    }
    memcpy(head, world->room, 16);
    memcpy(&closing, world->room + size - 4, 4);
    for (int k = 0; k <= world->n_asked; k++) { /* the time first */
        if (!dse_udp_is_finite(world->room + 16 + 8 * (size_t)k)) {
            return false;
        }
    }
    return head[0] == DSE_UDP_MAGIC_VERSION && head[1] > 0 && head[2] >= 0 && closing == head[2]
           && !(head[3] & ~(DSE_UDP_START | DSE_UDP_END | DSE_UDP_LATE));
}

static dse_udp_event dse_udp_take(dse_udp_world *world, const int32_t head[4], double *asked, dse_udp_event event) {
    world->sequence = head[2];
    world->flags = head[3];
    memcpy(&world->time, world->room + 16, 8);
    memcpy(asked, world->room + 24, 8 * (size_t)world->n_asked);
    return event;
}

static bool dse_udp_is_over(const dse_udp_world *world, int32_t session) {
    for (int k = 0; k < 8; k++) {
        if (world->over[k] == session) {
            return true;
        }
    }
    return false;
}

static void dse_udp_say_busy(dse_udp_world *world, const int32_t head[4], const struct sockaddr_in *to) {
    const size_t size = dse_udp_size(world->n_told);
    unsigned char *data = calloc(1, size);
    if (data) {
        dse_udp_head(data, size, head[1], head[2], DSE_UDP_BUSY);
        dse_udp_send(world, data, to);
        free(data);
    }
}

/* What a packet means. */
static dse_udp_event dse_udp_on_packet(dse_udp_world *world, const int32_t head[4], const struct sockaddr_in *from,
                                       double *asked) {
    const bool is_peer = from->sin_port == world->peer.sin_port
                         && from->sin_addr.s_addr == world->peer.sin_addr.s_addr;
    const bool starts = head[3] & DSE_UDP_START && !(head[3] & DSE_UDP_END) && head[2] == 0
                        && !dse_udp_is_over(world, head[1]);
    if (!world->session && starts) {
        world->session = head[1];
        world->peer = *from;
        world->told = -1;
        return dse_udp_take(world, head, asked, DSE_UDP_STARTED);
    }
    if (world->session && head[1] != world->session && starts) {
        dse_udp_say_busy(world, head, from);
        return DSE_UDP_NOTHING;
    }
    if (!world->session || head[1] != world->session || !is_peer) {
        world->ignored++;
        return DSE_UDP_NOTHING;
    }
    if (head[3] & DSE_UDP_END) {
        world->over[world->n_over++ % 8] = world->session;
        world->session = 0;
        return DSE_UDP_ENDED;
    }
    if (world->is_free ? head[3] & DSE_UDP_START : head[2] == world->sequence) {
        if (world->told >= 0) { /* its answer was lost */
            dse_udp_send(world, world->last, &world->peer);
        }
        return DSE_UDP_NOTHING;
    }
    if (world->is_free ? head[2] > world->sequence : head[2] == world->sequence + 1 && world->told == world->sequence) {
        return dse_udp_take(world, head, asked, DSE_UDP_STEP);
    }
    world->ignored++;
    return DSE_UDP_NOTHING;
}

/* Seconds of a clock that never jumps. */
static double dse_udp_now(void) {
#ifdef _WIN32
    LARGE_INTEGER ticks, rate;
    QueryPerformanceCounter(&ticks);
    QueryPerformanceFrequency(&rate);
    return (double)ticks.QuadPart / (double)rate.QuadPart;
#else
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
#endif
}

/* The deadline after *last*: delays do not add up, but a delay of more than 0.1 s is not caught up (docs/udp.md). */
static double dse_udp_deadline(double last, double step, double now) {
    const double next = last + step;
    return now - next > 0.1 ? now : next;
}

/* Wait for *deadline*, a time of dse_udp_now. What is late is not waited for. */
static void dse_udp_sleep_until(double deadline) {
    for (double rest = deadline - dse_udp_now(); rest > 0.0; rest = deadline - dse_udp_now()) {
#ifdef _WIN32
        Sleep((DWORD)(1e3 * rest));
#else
        struct timespec nap;
        nap.tv_sec = (time_t)rest;
        nap.tv_nsec = (long)(1e9 * (rest - (double)nap.tv_sec));
        nanosleep(&nap, NULL);
#endif
    }
}

/* The next thing that happens within *seconds* (less than 0: for ever); its n_asked values are put into *asked*. */
static dse_udp_event dse_udp_wait(dse_udp_world *world, double *asked, double seconds) {
    for (;;) {
        struct timeval patience;
        struct sockaddr_in from;
        dse_udp_length length = sizeof from;
        int32_t head[4];
        fd_set lines;
        FD_ZERO(&lines);
        FD_SET(world->line, &lines);
        patience.tv_sec = (long)seconds;
        patience.tv_usec = (long)(1e6 * (seconds - (double)patience.tv_sec));
        const int ready = select((int)world->line + 1, &lines, NULL, NULL, seconds < 0.0 ? NULL : &patience);
        if (ready <= 0) {
            return ready < 0 ? DSE_UDP_BROKEN : DSE_UDP_NOTHING;
        }
        const long size = (long)recvfrom(world->line, (char *)world->room, (int)dse_udp_size(world->n_asked) + 1, 0,
                                         (struct sockaddr *)&from, &length);
        if (size < 0 || !dse_udp_is_packet(world, (size_t)size, head)) {
            world->ignored++;
            continue;
        }
        const dse_udp_event event = dse_udp_on_packet(world, head, &from, asked);
        if (event != DSE_UDP_NOTHING) {
            return event;
        }
    }
}

/* Tell n_told values and the time in s that they belong to. Free: whenever the clock says; lockstep: once for each
 * STARTED and STEP; more is nothing. Nothing without a session. */
static void dse_udp_answer(dse_udp_world *world, double time, const double *values) {
    const size_t size = dse_udp_size(world->n_told);
    if (!world->session || (!world->is_free && world->told == world->sequence)) {
        return;
    }
    world->told = world->is_free ? world->told + 1 : world->sequence;
    dse_udp_head(world->last, size, world->session, world->told, world->told ? 0 : DSE_UDP_START);
    memcpy(world->last + 16, &time, 8);
    memcpy(world->last + 24, values, 8 * (size_t)world->n_told);
    dse_udp_send(world, world->last, &world->peer);
}

/* End the session from this side: the run there ends regularly, and what it has is its result. */
static void dse_udp_end(dse_udp_world *world) {
    const size_t size = dse_udp_size(world->n_told);
    if (!world->session) {
        return;
    }
    dse_udp_head(world->last, size, world->session, world->sequence, DSE_UDP_END);
    for (int k = 0; k < 3; k++) { /* any of them may be lost */
        dse_udp_send(world, world->last, &world->peer);
    }
    world->over[world->n_over++ % 8] = world->session;
    world->session = 0;
}

#endif
