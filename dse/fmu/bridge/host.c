/* The host: a program that loads the library of an FMU and calls it for the bridge, which started it: on Linux by itself,
 * or a program for Windows, in wine.
 *
 * It knows nothing of FMI's functions but their names and, on Linux, which parameters are doubles: parameters come as the
 * 64 bits they are passed in. */
#define _GNU_SOURCE
#include "frame.h"
#include "functions.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <io.h>
#include <windows.h>
#else
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>
#endif

static const char *const names[] = {
#define NAMED(name, parameters) #name,
    FUNCTIONS(NAMED)
};
typedef void (*Function)(void);
static Function functions[N_FUNCTIONS];
static size_t take(void *to, size_t size);          /* from the bridge: how many bytes there were, 0 if it is gone */
static size_t give(const void *bytes, size_t size); /* to the bridge, likewise */
static _Noreturn void leave(int code);              /* at once */
static void hold_line(bool begins);                 /* FMUs log from threads of their own */

typedef struct {
    uint8_t *bytes;
    size_t room;
} Room;

static void *with_room(Room *room, size_t size)
{
    if (room->room < size) {
        room->bytes = realloc(room->bytes, room->room = 2 * size + 256);
        if (!room->bytes)
            leave(14); /* Windows' number for it */
    }
    return room->bytes;
}

/* ---- frames ---- */

static void receive(void *to, size_t size)
{
    for (size_t got; size; to = (uint8_t *)to + got, size -= got)
        if (!(got = take(to, size)))
            leave(0); /* nobody is there any more */
}

static void write_all(const void *bytes, size_t size)
{
    for (size_t put; size; bytes = (const uint8_t *)bytes + put, size -= put)
        if (!(put = give(bytes, size)))
            leave(0);
}

/* *room* begins with room for a head. */
static void send_frame(Room *room, uint32_t kind, uint32_t number, uint64_t value, size_t size)
{
    const Head head = {kind, number, size, value};
    memcpy(room->bytes, &head, sizeof head);
    hold_line(true);
    write_all(room->bytes, sizeof head + size);
    hold_line(false);
}

/* ---- callbacks ---- */

typedef struct {
    void (*log)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

/* What the FMU is told to be its environment is the number that the bridge gave the callbacks. */
static uint32_t number_of(void *environment)
{
    return (uint32_t)(uintptr_t)environment;
}

/* A line, its category before it, each with a zero at its end. */
static void send_line(void *environment, int status, const char *category, const char *line)
{
    Room room = {0};
    const size_t before = strlen(category ? category : "") + 1, size = strlen(line) + 1;
    uint8_t *to = (uint8_t *)with_room(&room, sizeof(Head) + before + size) + sizeof(Head);
    memcpy(to, category ? category : "", before);
    memcpy(to + before, line, size);
    send_frame(&room, LOGGED, number_of(environment), (uint64_t)status, before + size);
    free(room.bytes);
}

static void log_fmi2(void *environment, const char *name, int status, const char *category, const char *format, ...)
{
    char line[4096];
    va_list values;
    (void)name;
    if (!format)
        return;
    va_start(values, format);
    vsnprintf(line, sizeof line, format, values);
    va_end(values);
    send_line(environment, status, category, line);
}

static void log_fmi3(void *environment, int status, const char *category, const char *message)
{
    if (message)
        send_line(environment, status, category, message);
}

static void finished(void *environment, int status)
{
    Room room = {0};
    with_room(&room, sizeof(Head));
    send_frame(&room, FINISHED, number_of(environment), (uint64_t)status, 0);
    free(room.bytes);
}

static Update serve(void);

static void between(void *environment, double time, bool sets, bool gets, bool done, bool may_return,
                    bool *returns_early, double *return_time)
{
    Room room = {0};
    const Update update = {time, {sets, gets, done, may_return}, 0, {0}};
    memcpy((uint8_t *)with_room(&room, sizeof(Head) + sizeof update) + sizeof(Head), &update, sizeof update);
    send_frame(&room, BETWEEN, number_of(environment), 0, sizeof update);
    free(room.bytes);
    const Update answer = serve();
    if (returns_early)
        *returns_early = answer.returns_early;
    if (return_time && answer.returns_early)
        *return_time = answer.time;
}

/* The FMU may keep their address. */
static void *callbacks_of(uint32_t number)
{
    static Callbacks **known;
    static uint32_t count;
    if (number >= count) {
        known = realloc(known, (number + 1) * sizeof *known);
        memset(known + count, 0, (number + 1 - count) * sizeof *known);
        count = number + 1;
    }
    if (!known[number]) {
        known[number] = malloc(sizeof **known);
        *known[number] = (Callbacks){log_fmi2, calloc, free, finished, (void *)(uintptr_t)number};
    }
    return known[number];
}

static uint64_t linked(uint32_t to, uint64_t value, const uint8_t *data)
{
    return to <= TO_DATA_IN_DATA ? value + (uintptr_t)data
           : to == TO_CALLBACKS ? (uintptr_t)callbacks_of((uint32_t)value)
           : to == TO_LOGGER    ? (uintptr_t)log_fmi3
                                : (uintptr_t)between;
}

/* ---- calls ---- */

static double as_double(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#ifdef _WIN32
/* Where a function takes a variable number of arguments, doubles are passed as integers, too: so the one call serves every
 * function, whichever of its parameters are doubles, and takes no harm from those that are too many (Microsoft's x64
 * calling convention). */
static uint64_t call(uint32_t number, const uint64_t *p)
{
    return ((uint64_t(*)(uint64_t, ...))(void *)functions[number])(p[0], as_double(p[1]), as_double(p[2]), as_double(p[3]),
                                                                   p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11]);
}
#else
static const char *const signatures[] = {
#define SIGNED(name, parameters) parameters,
    FUNCTIONS(SIGNED)
};

/* Integers and addresses go in other registers than doubles, each in their order: the bridge's own functions the other way
 * round (System V's ABI, and that of Arm). */
static uint64_t call(uint32_t number, const uint64_t *p)
{
    uint64_t i[MOST_PARAMETERS] = {0};
    double d[3] = {0};
    int n_integers = 0, n_doubles = 0;
    for (const char *each = signatures[number]; *each; each += *each == '<' || *each == '>' ? 3 : 1, p++)
        if (*each == 'd')
            d[n_doubles++] = as_double(*p);
        else
            i[n_integers++] = *p;
    typedef uint64_t Any(uint64_t, uint64_t, uint64_t, uint64_t, uint64_t, uint64_t, double, double, double, uint64_t,
                         uint64_t, uint64_t, uint64_t, uint64_t, uint64_t);
    return ((Any *)functions[number])(i[0], i[1], i[2], i[3], i[4], i[5], d[0], d[1], d[2], i[6], i[7], i[8], i[9], i[10],
                                      i[11]);
}
#endif

/* Add the texts behind what is sent back: size, bytes and a zero each. */
static size_t add_texts(Room *room, size_t size, const Call *given, const uint8_t *data)
{
    const char *const *texts = (const char *const *)(data + given->texts);
    const uint64_t *sizes = (const uint64_t *)(data + given->sizes);
    for (uint32_t i = 0; i < given->n_texts; i++) {
        const int64_t length = !texts[i] ? NO_TEXT : given->sizes ? (int64_t)sizes[i] : (int64_t)strlen(texts[i]);
        const size_t bytes = length < 0 ? 0 : length > LONGEST_TEXT ? LONGEST_TEXT + 1 : (size_t)length;
        uint8_t *to = (uint8_t *)with_room(room, size + sizeof length + bytes + 1) + size;
        memcpy(to, &length, sizeof length);
        memcpy(to + sizeof length, texts[i], bytes);
        to[sizeof length + bytes] = 0;
        size += sizeof length + bytes + 1;
    }
    return size;
}

static void answer(const Head *head, uint8_t *frame, Room *reply)
{
    Call *given = (Call *)frame;
    const Link *links = (const Link *)(given + 1), *end = links + given->n_links;
    uint8_t *data = frame + ROUNDED(sizeof *given + given->n_links * sizeof *links);
    for (const Link *link = links; link < end; link++) {
        uint64_t *at = (uint64_t *)((link->to == TO_DATA_IN_DATA ? data : frame) + link->at);
        *at = linked(link->to, *at, data);
    }
    const uint64_t value = call(head->number, given->parameters);
    const size_t sent = given->data_size - given->out_from;
    size_t size = sizeof(Head) + sent;
    memcpy((uint8_t *)with_room(reply, size) + sizeof(Head), data + given->out_from, sent);
    if (given->n_texts && (uint32_t)value <= 1)
        size = add_texts(reply, size, given, data);
    send_frame(reply, RETURNED, head->number, value, size - sizeof(Head));
}

/* Answer calls until an intermediate update is told to be over; without one, for ever. */
static Update serve(void)
{
    Room frame = {0}, reply = {0}; /* of its own: what the call outside was given must stay */
    for (;;) {
        Head head;
        receive(&head, sizeof head);
        receive(with_room(&frame, head.size), head.size);
        if (head.kind == UPDATED) {
            Update update;
            memcpy(&update, frame.bytes, sizeof update);
            free(frame.bytes);
            free(reply.bytes);
            return update;
        }
        answer(&head, frame.bytes, &reply);
    }
}

/* ---- the process ---- */

/* Tell which functions *library* has, and what is *missing* for it; *error* is not 0 if it is not there. */
static void report(void *library, uint32_t error, const char *missing, Function (*find)(void *, const char *))
{
    Room room = {0};
    uint8_t *has = (uint8_t *)with_room(&room, sizeof(Head) + N_FUNCTIONS + LONGEST_NAME) + sizeof(Head);
    memset(has, 0, N_FUNCTIONS + LONGEST_NAME);
    strncpy((char *)has + N_FUNCTIONS, missing, LONGEST_NAME - 1);
    for (int i = 0; i < N_FUNCTIONS; i++) {
        functions[i] = library ? find(library, names[i]) : NULL;
        has[i] = functions[i] != NULL;
    }
    send_frame(&room, READY, 0, error, N_FUNCTIONS + LONGEST_NAME);
    free(room.bytes);
    if (library)
        serve();
}

#ifdef _WIN32
static HANDLE from_bridge, to_bridge;
static CRITICAL_SECTION sending;

static size_t take(void *to, size_t size)
{
    DWORD got = 0;
    return ReadFile(from_bridge, to, size < 1 << 30 ? (DWORD)size : 1 << 30, &got, NULL) ? got : 0;
}

static size_t give(const void *bytes, size_t size)
{
    DWORD put = 0;
    return WriteFile(to_bridge, bytes, size < 1 << 30 ? (DWORD)size : 1 << 30, &put, NULL) ? put : 0;
}

static _Noreturn void leave(int code)
{
    TerminateProcess(GetCurrentProcess(), (UINT)code);
    abort();
}

static void hold_line(bool begins)
{
    if (begins)
        EnterCriticalSection(&sending);
    else
        LeaveCriticalSection(&sending);
}

static LONG WINAPI crash(EXCEPTION_POINTERS *what)
{
    const Head head = {CRASHED, 0, 0, what->ExceptionRecord->ExceptionCode};
    write_all(&head, sizeof head);
    TerminateProcess(GetCurrentProcess(), 1);
    return EXCEPTION_EXECUTE_HANDLER;
}

/* What the FMU prints must not come between the frames. */
static void keep_pipes(void)
{
    HANDLE self = GetCurrentProcess(), error = GetStdHandle(STD_ERROR_HANDLE);
    DuplicateHandle(self, GetStdHandle(STD_INPUT_HANDLE), self, &from_bridge, 0, FALSE, DUPLICATE_SAME_ACCESS);
    DuplicateHandle(self, GetStdHandle(STD_OUTPUT_HANDLE), self, &to_bridge, 0, FALSE, DUPLICATE_SAME_ACCESS);
    freopen("NUL", "r", stdin);
    _dup2(_fileno(stderr), _fileno(stdout));
    SetStdHandle(STD_INPUT_HANDLE, NULL);
    SetStdHandle(STD_OUTPUT_HANDLE, error);
}

/* The first of the libraries that *path* needs that cannot be loaded, "" if none. */
static void find_missing(const wchar_t *path, char *missing)
{
    wchar_t folder[32768] = L"";
    const uint8_t *image = (const uint8_t *)LoadLibraryExW(path, NULL, DONT_RESOLVE_DLL_REFERENCES);
    if (!image)
        return;
    wcsncpy(folder, path, 32767);
    *wcsrchr(folder, L'\\') = 0;
    SetDllDirectoryW(folder);
    const IMAGE_NT_HEADERS *head = (const IMAGE_NT_HEADERS *)(image + ((const IMAGE_DOS_HEADER *)image)->e_lfanew);
    const DWORD imports = head->OptionalHeader.DataDirectory[IMAGE_DIRECTORY_ENTRY_IMPORT].VirtualAddress;
    const IMAGE_IMPORT_DESCRIPTOR *needed = (const IMAGE_IMPORT_DESCRIPTOR *)(image + imports);
    for (; imports && needed->Name; needed++)
        if (!LoadLibraryA((const char *)image + needed->Name)) {
            strncpy(missing, (const char *)image + needed->Name, LONGEST_NAME - 1);
            return;
        }
}

static Function find(void *library, const char *name)
{
    return (Function)(void *)GetProcAddress((HMODULE)library, name);
}

int wmain(int n, wchar_t **arguments)
{
    InitializeCriticalSection(&sending);
    keep_pipes();
    SetErrorMode(SEM_FAILCRITICALERRORS | SEM_NOGPFAULTERRORBOX | SEM_NOOPENFILEERRORBOX);
    SetUnhandledExceptionFilter(crash);
    HMODULE library = n == 2 ? LoadLibraryExW(arguments[1], NULL, LOAD_WITH_ALTERED_SEARCH_PATH) : NULL;
    const DWORD error = library ? 0 : GetLastError();
    char missing[LONGEST_NAME] = "";
    if (error == ERROR_MOD_NOT_FOUND)
        find_missing(arguments[1], missing);
    report(library, error, missing, find);
    return 0;
}
#else
static int from_bridge, to_bridge;
static pthread_mutex_t sending = PTHREAD_MUTEX_INITIALIZER;

static size_t take(void *to, size_t size)
{
    ssize_t got;
    do
        got = read(from_bridge, to, size);
    while (got < 0 && errno == EINTR);
    return got < 0 ? 0 : (size_t)got;
}

static size_t give(const void *bytes, size_t size)
{
    ssize_t put;
    do
        put = write(to_bridge, bytes, size);
    while (put < 0 && errno == EINTR);
    return put < 0 ? 0 : (size_t)put;
}

static _Noreturn void leave(int code)
{
    _exit(code);
}

static void hold_line(bool begins)
{
    if (begins)
        pthread_mutex_lock(&sending);
    else
        pthread_mutex_unlock(&sending);
}

static Function find(void *library, const char *name)
{
    Function found;
    *(void **)&found = dlsym(library, name);
    return found;
}

int main(int n, char **arguments)
{
    /* What the FMU prints must not come between the frames, and what it starts must not keep them. */
    from_bridge = fcntl(0, F_DUPFD_CLOEXEC, 3);
    to_bridge = fcntl(1, F_DUPFD_CLOEXEC, 3);
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, 0);
    dup2(2, 1);
    void *library = n == 2 ? dlopen(arguments[1], RTLD_NOW) : NULL;
    report(library, library == NULL, library ? "" : dlerror(), find);
    return 0;
}
#endif
