/* The bridge: what a Linux program loads in the place of an FMU's library that needs another process: one for Windows, or
 * one that is to be isolated. It exports FMI's functions and has the host make each call, which it starts: one host in wine
 * for all instances, or on Linux a host for each.
 *
 * If the host ends, this process ends in the same way: who runs FMUs has to expect that of any library. */
#define _GNU_SOURCE
#include "frame.h"
#include "functions.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#define OFFERED __attribute__((visibility("default")))

#ifndef WINE
#define WINE "" /* who compiles it says which */
#endif
OFFERED const char dse_bridge_wine[] = WINE; /* another wine computes other numbers: so this is another library */
enum { IS_WINE = sizeof dse_bridge_wine > 1 };

typedef struct {
    uint8_t *bytes;
    size_t size, room;
} Room;

/* Make room for *size* more bytes, at a multiple of 8, all zero. */
static uint8_t *added(Room *room, size_t size)
{
    const size_t at = ROUNDED(room->size);
    if (at + size > room->room) {
        room->room = 2 * (at + size) + 256;
        room->bytes = realloc(room->bytes, room->room);
        if (!room->bytes)
            abort();
    }
    memset(room->bytes + room->size, 0, at + size - room->size);
    room->size = at + size;
    return room->bytes + at;
}

/* ---- the host ---- */

typedef struct {
    int to, from, life; /* which stays open as long as this process wants the host */
    pid_t warden;
    uint64_t instance; /* the one there, where each has a host */
} Host;

static Host *host;  /* that is called at present; under *calling* */
static Host *idle;  /* started, and without an instance */
static char **host_command, **host_environment;
static uint8_t exported[N_FUNCTIONS];
OFFERED char dse_bridge_missing[LONGEST_NAME]; /* a library that the FMU's needs and that is not there, or "" */
static pthread_mutex_t calling; /* recursive: from within an intermediate update the FMU is called, too */

static const char *const names[] = {
#define NAMED(name, parameters) #name,
    FUNCTIONS(NAMED)
};

static pid_t watched; /* known to the warden alone */

static void host_ended(int number)
{
    (void)number;
    int status;
    if (waitpid(watched, &status, WNOHANG) == watched)
        _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
}

/* In a process of its own: start the host and see to it that it ends with who asked for it, whatever it is doing. That the
 * system can do only for a thread's end. */
static _Noreturn void watch(char *const *command, char *const *environment, int requests, int replies, int alive)
{
    setsid();
    dup2(requests, 0);
    dup2(replies, 1);
    dup2(alive, 3);
    syscall(SYS_close_range, 4u, ~0u, 0u);
    signal(SIGCHLD, host_ended);
    sigset_t none;
    sigemptyset(&none);
    watched = fork();
    if (watched == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        signal(SIGCHLD, SIG_DFL);
        sigprocmask(SIG_SETMASK, &none, NULL);
        close(3);
        execve(command[0], command, environment);
        _exit(127);
    }
    close(0);
    close(1);
    sigprocmask(SIG_SETMASK, &none, NULL);
    char byte;
    while (read(3, &byte, 1) < 0 && errno == EINTR)
        host_ended(0);
    signal(SIGCHLD, SIG_DFL);
    kill(watched, SIGKILL);
    waitpid(watched, NULL, 0);
    _exit(0);
}

static bool start(Host *new)
{
    int requests[2], replies[2], lives[2];
    if (pipe2(requests, O_CLOEXEC) || pipe2(replies, O_CLOEXEC) || pipe2(lives, O_CLOEXEC))
        return false;
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    new->warden = fork();
    if (new->warden == 0)
        watch(host_command, host_environment, requests[0], replies[1], lives[0]);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    close(requests[0]);
    close(replies[1]);
    close(lives[0]);
    new->life = lives[1];
    new->to = requests[1];
    new->from = replies[0];
    return new->warden > 0;
}

/* How a process ends on Linux where it does so on Windows (NTSTATUS). */
static int signal_of(uint64_t code)
{
    switch (code) {
    case 0xC0000005: /* access violation */
    case 0xC00000FD: /* stack overflow */
        return SIGSEGV;
    case 0xC000001D: /* illegal instruction */
    case 0xC0000096: /* privileged instruction */
        return SIGILL;
    default:
        return code >= 0xC000008D && code <= 0xC0000095 ? SIGFPE : SIGABRT; /* arithmetic */
    }
}

static _Noreturn void crash(int number)
{
    signal(number, SIG_DFL);
    raise(number);
    abort();
}

/* The code the host has ended with; beyond 128, by which signal; 255 if that is not known. */
static int ended(void)
{
    int status;
    close(host->to);
    return waitpid(host->warden, &status, 0) == host->warden && WIFEXITED(status) ? WEXITSTATUS(status) : 255;
}

static void end_as_host(void)
{
    const int code = ended();
    if (code > 128)
        crash(code == 128 + SIGSEGV || code == 128 + SIGFPE || code == 128 + SIGILL ? code - 128 : SIGABRT);
    _exit(code);
}

static bool receive(void *to, size_t size)
{
    for (ssize_t got; size; to = (uint8_t *)to + got, size -= (size_t)got) {
        got = read(host->from, to, size);
        if (got == 0 || (got < 0 && errno != EINTR))
            return false;
        if (got < 0)
            got = 0;
    }
    return true;
}

static void send_bytes(const void *bytes, size_t size)
{
    for (ssize_t put; size; bytes = (const uint8_t *)bytes + put, size -= (size_t)put) {
        put = write(host->to, bytes, size);
        if (put < 0 && errno != EINTR)
            end_as_host();
        if (put < 0)
            put = 0;
    }
}

/* Start a host, from now on the one that is called. 0 if it has the library, else an error of its system; -1 - code if it
 * ended with that code. */
static int64_t open_host(void)
{
    Head head;
    host = calloc(1, sizeof *host);
    if (!host || !start(host))
        return -1 - 255;
    if (!receive(&head, sizeof head))
        return -1 - ended();
    if (head.kind == CRASHED)
        crash(signal_of(head.value));
    if (!receive(exported, sizeof exported) || !receive(dse_bridge_missing, sizeof dse_bridge_missing))
        return -1 - ended();
    return (int64_t)head.value;
}

static void close_host(Host *old)
{
    close(old->life);
    waitpid(old->warden, NULL, 0);
    close(old->to);
    close(old->from);
    free(old);
}

static char **copied(char *const *texts)
{
    size_t count = 0;
    while (texts[count])
        count++;
    char **copy = calloc(count + 1, sizeof *copy);
    for (size_t i = 0; copy && i < count; i++)
        copy[i] = strdup(texts[i]);
    return copy;
}

/* Have the host started by *command* with *environment*, once; as open_host. */
OFFERED int64_t dse_bridge_open(char *const *command, char *const *environment)
{
    static int64_t came_to;
    if (host_command)
        return came_to;
    pthread_mutexattr_t recursive;
    pthread_mutexattr_init(&recursive);
    pthread_mutexattr_settype(&recursive, PTHREAD_MUTEX_RECURSIVE);
    pthread_mutex_init(&calling, &recursive);
    host_command = copied(command);
    host_environment = copied(environment);
    came_to = host_command && host_environment ? open_host() : -1 - 255;
    idle = host;
    return came_to;
}

/* The host that waits goes with the library, the others when this process ends. */
__attribute__((destructor)) static void leave(void)
{
    if (idle && idle->warden > 0)
        close_host(idle);
}

/* Whether the FMU's library has the function *name*. */
OFFERED int dse_bridge_has(const char *name)
{
    for (int i = 0; i < N_FUNCTIONS; i++)
        if (strcmp(names[i], name) == 0)
            return exported[i];
    return 0;
}

/* ---- callbacks ---- */

typedef struct {
    void (*log_fmi2)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Fmi2Callbacks;

typedef struct {
    Fmi2Callbacks fmi2; /* in FMI 3 the environment alone */
    void (*log)(void *, int, const char *, const char *);
    void (*between)(void *, double, bool, bool, bool, bool, bool *, double *);
} Callbacks;

static Callbacks *known;
static uint32_t n_known;

/* The host may name them at any time later, so they are kept; the same ones once. */
static uint32_t number_of(const Callbacks *callbacks)
{
    for (uint32_t i = 0; i < n_known; i++)
        if (memcmp(&known[i], callbacks, sizeof *callbacks) == 0)
            return i;
    known = realloc(known, (n_known + 1) * sizeof *known);
    if (!known)
        abort();
    known[n_known] = *callbacks;
    return n_known++;
}

static void update(const Callbacks *to)
{
    Update update;
    if (!receive(&update, sizeof update))
        end_as_host();
    bool early = false;
    double time = update.time;
    to->between(to->fmi2.environment, time, update.flags[0], update.flags[1], update.flags[2], update.flags[3], &early,
                &time);
    struct {
        Head head;
        Update update;
    } answer = {{UPDATED, 0, sizeof update, 0}, {time, {0}, early, {0}}};
    send_bytes(&answer, sizeof answer);
}

static void log_line(const Callbacks *to, const Head *head)
{
    char *category = malloc(head->size + 1);
    if (!category || !receive(category, head->size))
        end_as_host();
    category[head->size] = 0;
    const char *line = category + strlen(category) + 1;
    if (to->log)
        to->log(to->fmi2.environment, (int)head->value, category, line);
    else if (to->fmi2.log_fmi2)
        to->fmi2.log_fmi2(to->fmi2.environment, "", (int)head->value, category, "%s", line);
    free(category);
}

/* The head of what came of a call; what the host calls before is answered. */
static Head returned(void)
{
    for (;;) {
        Head head;
        if (!receive(&head, sizeof head))
            end_as_host();
        if (head.kind == RETURNED)
            return head;
        if (head.kind == CRASHED)
            crash(signal_of(head.value));
        Callbacks to = known[head.number < n_known ? head.number : 0]; /* what it calls may make another instance */
        if (head.number >= n_known)
            to.fmi2.environment = NULL; /* the FMU passed another one than it was given */
        if (head.kind == LOGGED)
            log_line(&to, &head);
        else if (head.kind == BETWEEN)
            update(&to);
        else if (to.fmi2.finished)
            to.fmi2.finished(to.fmi2.environment, (int)head.value);
    }
}

/* ---- calls ---- */

/* What comes back from the host for an array of the caller's. */
typedef struct {
    uint64_t to;
    size_t size;
} Output;

/* The room of a thread's calls. What a call within a call overwrites was sent before. */
static _Thread_local Room links, data, texts;

static void link_at(size_t at, uint32_t to)
{
    *(Link *)added(&links, sizeof(Link)) = (Link){(uint32_t)at, to};
}

static uint64_t add_bytes(const void *bytes, size_t size)
{
    uint8_t *to = added(&data, size);
    if (size)
        memcpy(to, bytes, size);
    return (uint64_t)(to - data.bytes);
}

/* Strings, or with *sizes* binaries: pointers, and what they point to behind them. */
static uint64_t add_texts(const char *const *given, const size_t *sizes, size_t count)
{
    const uint64_t at = (uint64_t)(added(&data, 8 * count) - data.bytes);
    for (size_t i = 0; i < count; i++) {
        if (!given[i])
            continue;
        const uint64_t text = add_bytes(given[i], sizes ? sizes[i] : strlen(given[i]) + 1);
        memcpy(data.bytes + at + 8 * i, &text, sizeof text);
        link_at(at + 8 * i, TO_DATA_IN_DATA);
    }
    return at;
}

/* Where wine finds what lies at *place*, a URI or a path. */
static uint64_t add_place(const char *place)
{
    if (!IS_WINE)
        return add_bytes(place, strlen(place) + 1);
    const bool is_uri = strncmp(place, "file://", 7) == 0;
    const char *path = is_uri ? place + 7 : place, *drive = is_uri ? "file:///Z:" : "Z:";
    const size_t before = strlen(drive), size = strlen(path) + 1;
    char *name = (char *)added(&data, before + size);
    memcpy(name, drive, before);
    memcpy(name + before, path, size);
    for (char *c = name; !is_uri && *c; c++)
        if (*c == '/')
            *c = '\\';
    return (uint64_t)((uint8_t *)name - data.bytes);
}

static size_t bytes_of(const char *array, const uint64_t *given)
{
    const size_t count = array[2] == '-' ? 1 : (size_t)given[array[2] - 'a'];
    return count * (array[1] == 'E' ? 32 : array[1] == 's' || array[1] == 'x' ? 8 : (size_t)(array[1] - '0'));
}

static const char *next_of(const char *parameter)
{
    return parameter + (*parameter == '<' || *parameter == '>' ? 3 : 1);
}

/* What the caller passed, in order: integers and addresses come in other registers than doubles (System V's ABI). */
static int sort(const char *parameters, const uint64_t *integers, const double *doubles, uint64_t *given)
{
    int n = 0;
    for (const char *p = parameters; *p; p = next_of(p), n++)
        if (*p == 'd')
            memcpy(&given[n], doubles++, 8);
        else
            given[n] = *p == 'b' ? (uint8_t)*integers++ : *p == 'n' ? (uint32_t)*integers++ : *integers++;
    return n;
}

static Callbacks callbacks_in(const char *parameters, const uint64_t *given)
{
    Callbacks found = {0};
    for (; *parameters; parameters = next_of(parameters), given++)
        if (*parameters == 'L')
            found.fmi2 = *(const Fmi2Callbacks *)*given;
        else if (*parameters == 'G')
            found.fmi2.environment = (void *)*given;
        else if (*parameters == 'l')
            found.log = (void (*)(void *, int, const char *, const char *))*given;
        else if (*parameters == 'm')
            found.between = (void (*)(void *, double, bool, bool, bool, bool, bool *, double *))*given;
    return found;
}

/* The parameter as the host gets it; *p says what it is. */
static uint64_t packed(const char *p, const uint64_t *given, int i)
{
    if (!given[i])
        return 0;
    if (*p == '<' && (p[1] == 's' || p[1] == 'x'))
        return add_texts((const char *const *)given[i], p[1] == 'x' ? (const size_t *)given[i - 1] : NULL,
                         bytes_of(p, given) / 8);
    return *p == 's' ? add_bytes((const char *)given[i], strlen((const char *)given[i]) + 1)
           : *p == 'u' ? add_place((const char *)given[i])
                       : add_bytes((const void *)given[i], bytes_of(p, given));
}

/* Pack what is given, then what comes back: that begins as it is, since a function may leave it alone. */
static int pack(const char *parameters, const uint64_t *given, Call *call, Output *outputs)
{
    int n_outputs = 0, i = 0;
    links.size = data.size = 0;
    const Callbacks callbacks = callbacks_in(parameters, given);
    const uint32_t number = callbacks.log || callbacks.fmi2.log_fmi2 || callbacks.between ? number_of(&callbacks) : 0;
    for (const char *p = parameters; *p; p = next_of(p), i++) {
        const size_t at = offsetof(Call, parameters) + 8 * (size_t)i;
        if (strchr("su<", *p)) {
            call->parameters[i] = packed(p, given, i);
            if (given[i])
                link_at(at, TO_DATA);
        } else if (strchr("LGlm", *p)) {
            call->parameters[i] = *p == 'G' || given[i] ? number : 0;
            if (*p != 'G' && given[i])
                link_at(at, *p == 'L' ? TO_CALLBACKS : *p == 'l' ? TO_LOGGER : TO_BETWEEN);
        } else if (*p != '>')
            call->parameters[i] = given[i];
    }
    added(&data, 0);
    call->out_from = (uint32_t)data.size;
    i = 0;
    for (const char *p = parameters; *p; p = next_of(p), i++) {
        if (*p != '>' || !given[i])
            continue;
        const size_t size = bytes_of(p, given);
        const bool is_text = p[1] == 's' || p[1] == 'x';
        const uint64_t at = is_text ? (uint64_t)(added(&data, size) - data.bytes) : add_bytes((void *)given[i], size);
        if (is_text) {
            call->texts = (uint32_t)at;
            call->n_texts = (uint32_t)(size / 8);
            call->sizes = p[1] == 'x' ? (uint32_t)call->parameters[i - 1] : 0;
        }
        call->parameters[i] = at;
        outputs[n_outputs++] = (Output){given[i], size};
        link_at(offsetof(Call, parameters) + 8 * (size_t)i, TO_DATA);
    }
    call->n_links = (uint32_t)(links.size / sizeof(Link));
    call->data_size = (uint32_t)data.size;
    return n_outputs;
}

static void send_call(uint32_t function, const Call *call)
{
    const uint64_t size = sizeof *call + links.size + data.size;
    const Head head = {CALL, function, size, 0};
    static _Thread_local Room frame;
    frame.size = 0;
    memcpy(added(&frame, sizeof head), &head, sizeof head);
    memcpy(added(&frame, sizeof *call), call, sizeof *call);
    if (links.size)
        memcpy(added(&frame, links.size), links.bytes, links.size);
    if (data.size)
        memcpy(added(&frame, data.size), data.bytes, data.size);
    send_bytes(frame.bytes, sizeof head + size);
}

/* Behind the arrays lie texts, if any: they stay until this thread's next call. */
static void unpack(const Head *head, const Call *call, const Output *outputs, int n_outputs)
{
    texts.size = 0;
    uint8_t *from = added(&texts, head->size), *pointers = NULL;
    if (!receive(from, head->size))
        end_as_host();
    uint8_t *text = from + (call->data_size - call->out_from);
    const uint8_t *const end = from + head->size;
    for (int i = 0; i < n_outputs; i++) {
        const bool is_text = call->n_texts && i == n_outputs - 1;
        if (is_text)
            pointers = (uint8_t *)outputs[i].to;
        else
            memcpy((void *)outputs[i].to, from, outputs[i].size);
        from += ROUNDED(outputs[i].size);
    }
    for (uint32_t i = 0; pointers && text < end && i < call->n_texts; i++) {
        int64_t size;
        memcpy(&size, text, sizeof size);
        const char *there = size == NO_TEXT ? NULL : (const char *)text + sizeof size;
        memcpy(pointers + 8 * i, &there, sizeof there);
        text += sizeof size + 1 + (size < 0 ? 0 : size > LONGEST_TEXT ? LONGEST_TEXT + 1 : (size_t)size);
    }
}

static bool makes(uint32_t function)
{
    return function == NUMBER_OF_fmi2Instantiate || function == NUMBER_OF_fmi3InstantiateCoSimulation ||
           function == NUMBER_OF_fmi3InstantiateModelExchange;
}

static bool ends(uint32_t function)
{
    return function == NUMBER_OF_fmi2FreeInstance || function == NUMBER_OF_fmi3FreeInstance;
}

/* Where each instance has a host, that is what the caller knows it by. */
static uint64_t forward(uint32_t function, const char *parameters, const uint64_t *integers, const double *doubles)
{
    uint64_t given[MOST_PARAMETERS];
    Call call = {0};
    Output outputs[MOST_PARAMETERS];
    sort(parameters, integers, doubles, given);
    pthread_mutex_lock(&calling);
    Host *const before = host; /* of the call that this one is made from within */
    if (IS_WINE)
        host = idle;
    else if (makes(function) && !idle && open_host() != 0)
        host = NULL;
    else if (makes(function))
        host = idle ? idle : host, idle = NULL;
    else
        host = (Host *)given[0], given[0] = host->instance;
    Head head = {0};
    if (host) {
        const int n_outputs = pack(parameters, given, &call, outputs);
        send_call(function, &call);
        head = returned();
        unpack(&head, &call, outputs, n_outputs);
    }
    if (!IS_WINE && makes(function) && head.value) {
        host->instance = head.value;
        head.value = (uintptr_t)host;
    } else if (!IS_WINE && host && (makes(function) || ends(function)))
        close_host(host);
    host = before;
    pthread_mutex_unlock(&calling);
    return head.value;
}

/* One signature takes whatever FMI passes: six integers in registers, the others on the stack, and the doubles. Where
 * there are fewer, what is read in their place is not looked at. */
#define EXPORTED(name, parameters) \
    OFFERED uint64_t name(uint64_t r0, uint64_t r1, uint64_t r2, uint64_t r3, uint64_t r4, uint64_t r5, double x0, \
                          double x1, double x2, uint64_t s0, uint64_t s1, uint64_t s2, uint64_t s3, uint64_t s4, \
                          uint64_t s5) \
    { \
        const uint64_t integers[] = {r0, r1, r2, r3, r4, r5, s0, s1, s2, s3, s4, s5}; \
        const double doubles[] = {x0, x1, x2}; \
        return forward(NUMBER_OF_##name, parameters, integers, doubles); \
    }
FUNCTIONS(EXPORTED)
