/* A component whose work is done by a separate process, its partner: one for each instance, from the first
 * initialization on. The importer passes its command through dse_bridge_open; dse does so if resources/partner.txt
 * names a module. Its standard input is a connected socket for frames of doubles in both directions. Its standard
 * output is a pipe without data, which is closed when this process ends, in any way. POSIX only. */
#ifndef DSE_PARTNER_H
#define DSE_PARTNER_H

#ifndef _POSIX_C_SOURCE
#define _POSIX_C_SOURCE 200809L
#endif
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#ifndef MSG_NOSIGNAL
#define MSG_NOSIGNAL 0 /* where it does not exist, Python already ignores the signal */
#endif

enum { DSE_PARTNER_START, DSE_PARTNER_STEP, DSE_PARTNER_END }; /* requests; the last one has no answer */
enum { DSE_PARTNER_LONGEST = 400 };                             /* bytes of an error message */

struct dse_partner {
    pid_t process; /* 0: no process */
    int line, life;
    bool is_running; /* a simulation */
};

struct dse_partner_head {
    uint32_t kind, count; /* of a request: kind, number of doubles; of an answer: 0, number; 1, bytes of text */
};

static char **dse_partner_command, **dse_partner_environment;

static char **dse_partner_copy(char *const *texts) {
    size_t count = 0;
    while (texts[count]) {
        count++;
    }
    char **copy = calloc(count + 1, sizeof *copy);
    for (size_t i = 0; copy && i < count; i++) {
        copy[i] = strdup(texts[i]);
    }
    return copy;
}

/* The same functions as in a bridge to a host (dse/fmu/bridge): nothing is started yet, so nothing fails. */
__attribute__((visibility("default"))) int64_t dse_bridge_open(char *const *command, char *const *environment);
__attribute__((visibility("default"))) int64_t dse_bridge_open(char *const *command, char *const *environment) {
    if (!dse_partner_command) {
        dse_partner_environment = dse_partner_copy(environment);
        dse_partner_command = dse_partner_copy(command);
    }
    return 0;
}

__attribute__((visibility("default"))) int dse_bridge_has(const char *name);
__attribute__((visibility("default"))) int dse_bridge_has(const char *name) {
    (void)name;
    return 1;
}

/* No number below 3: these become the standard files of the partner. */
static int dse_partner_own(int file) {
    const int own = file < 0 ? file : fcntl(file, F_DUPFD_CLOEXEC, 3);
    if (file >= 0) {
        close(file);
    }
    return own;
}

/* Start it; "" or the reason of the failure. */
static const char *dse_partner_begin(struct dse_partner *partner) {
    int line[2] = {-1, -1}, life[2] = {-1, -1};
    if (!dse_partner_command || !dse_partner_environment) {
        return "only dse can run this FMU: its work is done by a process that dse starts";
    }
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, line) != 0 || pipe(life) != 0) {
        return strerror(errno);
    }
    for (int i = 0; i < 2; i++) {
        line[i] = dse_partner_own(line[i]);
        life[i] = dse_partner_own(life[i]);
    }
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t none;
    sigemptyset(&none);
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, line[1], 0);
    posix_spawn_file_actions_adddup2(&files, life[0], 1);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setsigmask(&attributes, &none);
    const int error = posix_spawnp(&partner->process, dse_partner_command[0], &files, &attributes, dse_partner_command,
                                   dse_partner_environment);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    close(line[1]);
    close(life[0]);
    partner->line = line[0];
    partner->life = life[1];
    if (error) {
        close(partner->line);
        close(partner->life);
        partner->process = 0;
    }
    return error ? strerror(error) : "";
}

/* Ends it, with all processes that it has started. */
static void dse_partner_end(struct dse_partner *partner) {
    if (partner->process) {
        close(partner->line);
        close(partner->life);
        kill(-partner->process, SIGKILL);
        while (waitpid(partner->process, NULL, 0) < 0 && errno == EINTR) {
        }
    }
    partner->process = 0;
    partner->is_running = false;
}

static bool dse_partner_send(const struct dse_partner *partner, const void *from, size_t size) {
    const char *bytes = from;
    while (size) {
        const ssize_t sent = send(partner->line, bytes, size, MSG_NOSIGNAL);
        if (sent < 0 && errno != EINTR) {
            return false;
        }
        bytes += sent < 0 ? 0 : sent;
        size -= sent < 0 ? 0 : (size_t)sent;
    }
    return true;
}

static bool dse_partner_receive(const struct dse_partner *partner, void *to, size_t size) {
    char *bytes = to;
    while (size) {
        const ssize_t got = recv(partner->line, bytes, size, 0);
        if (got == 0 || (got < 0 && errno != EINTR)) {
            return false;
        }
        bytes += got < 0 ? 0 : got;
        size -= got < 0 ? 0 : (size_t)got;
    }
    return true;
}

/* Send *count* doubles, receive *expected*; false with an error in *said*. A new start ends the running simulation. */
static bool dse_partner_ask(struct dse_partner *partner, uint32_t kind, const double *asked, uint32_t count,
                            double *answer, uint32_t expected, char said[DSE_PARTNER_LONGEST + 1]) {
    const struct dse_partner_head ending = {DSE_PARTNER_END, 0}, head = {kind, count};
    struct dse_partner_head told = {0, 0};
    said[0] = 0;
    if (!partner->process) {
        snprintf(said, DSE_PARTNER_LONGEST, "%s", dse_partner_begin(partner));
        if (said[0]) {
            return false;
        }
    }
    bool is_ok = kind != DSE_PARTNER_START || !partner->is_running || dse_partner_send(partner, &ending, sizeof ending);
    is_ok = is_ok && dse_partner_send(partner, &head, sizeof head)
            && dse_partner_send(partner, asked, count * sizeof *asked)
            && dse_partner_receive(partner, &told, sizeof told);
    partner->is_running = is_ok && told.kind == 0;
    if (is_ok && told.kind == 0 && told.count == expected) {
        is_ok = dse_partner_receive(partner, answer, expected * sizeof *answer);
    } else if (is_ok && told.kind == 1 && told.count <= DSE_PARTNER_LONGEST) {
        is_ok = dse_partner_receive(partner, said, told.count);
        said[is_ok ? told.count : 0] = 0;
    } else {
        is_ok = false;
    }
    if (!is_ok) {
        dse_partner_end(partner);
        snprintf(said, DSE_PARTNER_LONGEST, "its process has ended without a word");
    }
    return !said[0];
}

#endif
