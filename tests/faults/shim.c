/* Preloaded into a command and all it starts: lets the n-th call of a kind fail, all from the n-th on, or each n-th.

   Which, stands in a file that all these processes have mapped: they count together. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum kind { WRITE, RENAME, SYNC, MAP, ALLOCATE, OPEN, LENGTHEN, START, FULL, BROKEN, FILES, DENIED, KINDS };
enum role { COORDINATOR, WORKER, TOOL, ROLES };

enum { ONCE, FROM_THEN_ON, EACH }; /* the n-th call; all from the n-th on; the n-th, the 2n-th, the 3n-th … */

/* The order and the sizes are known to shim.py. */
struct control {
    int64_t kind, role, nth, stays, error, least; /* set by the test; stays: ONCE … EACH */
    char below[512];                              /* the folder of whose files FULL … DENIED are */
    _Atomic int64_t first;                        /* process of the command itself */
    _Atomic int64_t failed;                       /* how many calls were let fail */
    _Atomic int64_t counts[ROLES][KINDS];
    char what[1024]; /* the first that was */
};

static struct control *control;
static enum role role;
static char program[512];

static void *map_by_kernel(int file, size_t size) {
    return (void *)syscall(SYS_mmap, NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
}

static int has(const char *text, size_t length, const char *word) { return memmem(text, length, word, strlen(word)) != NULL; }

static void arm(const char *path, int command) {
    int file = (int)syscall(SYS_openat, AT_FDCWD, path, O_RDWR | O_CLOEXEC, 0);
    if (file < 0) return;
    void *mapped = map_by_kernel(file, sizeof *control);
    syscall(SYS_close, file);
    if (mapped == MAP_FAILED) return;
    char line[4096];
    file = (int)syscall(SYS_openat, AT_FDCWD, "/proc/self/cmdline", O_RDONLY | O_CLOEXEC, 0);
    long length = file < 0 ? 0 : syscall(SYS_read, file, line, sizeof line);
    if (file >= 0) syscall(SYS_close, file);
    if (length < 0) length = 0;
    for (long at = 0; at < length && at < (long)sizeof program - 1; at++) program[at] = line[at] ? line[at] : ' ';
    struct control *ours = mapped;
    int64_t nobody = 0;
    if (command) ours->first = getpid();
    else atomic_compare_exchange_strong(&ours->first, &nobody, getpid());
    int python = has(line, (size_t)length, "python");
    role = ours->first == getpid() ? COORDINATOR : python && !has(line, (size_t)length, "compile_cache") ? WORKER : TOOL;
    control = ours;
}

/* A command that was forked, not started, calls these. */
void faults_arm(const char *path) { arm(path, 1); }
void faults_disarm(void) { control = NULL; }

__attribute__((constructor)) static void begin(void) {
    const char *path = getenv("DSE_TESTS_FAULTS");
    if (path) arm(path, 0);
}

static int fails(enum kind kind, const char *call, const char *what) {
    struct control *c = control;
    if (!c) return 0;
    int64_t count = ++c->counts[role][kind];
    int ours = c->kind == (int64_t)kind && c->role == (int64_t)role && c->nth &&
               (c->stays == EACH ? count % c->nth == 0 : c->stays ? count >= c->nth : count == c->nth);
    /* What stays, as a full disk, is met by everybody. */
    int met = c->stays == FROM_THEN_ON && c->failed && (c->kind == (int64_t)kind || (c->kind == WRITE && kind == LENGTHEN));
    if (!ours && !met) return 0;
    if (!c->failed++) snprintf(c->what, sizeof c->what, "%s %s [%d: %.300s]", call, what, getpid(), program);
    errno = (int)c->error;
    return 1;
}

#define REAL(name) \
    static __typeof__(&name) real; \
    if (!real) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)

/* The errors a call can have, as a set of kinds. */
#define CAN(kind) (1 << (kind))
#define LOOKS (CAN(BROKEN) | CAN(DENIED))
#define OPENS_FILE (LOOKS | CAN(FILES))
#define CHANGES (LOOKS | CAN(FULL))
#define GROWS (CAN(FULL) | CAN(BROKEN))

static int fails_one_of(int kinds, const char *call, const char *what) {
    for (int kind = FULL; kind < KINDS; kind++)
        if (kinds & CAN(kind) && fails(kind, call, what)) return 1;
    return 0;
}

/* A path that is relative is one of the folder. What Python imports is not. */
static int fails_on(int kinds, const char *call, const char *path) {
    if (!control || !path || (path[0] == '/' && strncmp(path, control->below, strlen(control->below)))) return 0;
    return fails_one_of(kinds, call, path);
}

/* Files of a disk: what is said to pipes, terminals and devices is another matter. */
static int is_on_disk(int file, char path[512]) {
    struct stat status;
    if (!control || (role == COORDINATOR && file < 3) || syscall(SYS_fstat, file, &status) != 0 || !S_ISREG(status.st_mode)) return 0;
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    long length = syscall(SYS_readlink, link, path, 511);
    path[length < 0 ? 0 : length] = 0;
    return 1;
}

static int fails_at(enum kind kind, int kinds, const char *call, int file) {
    char path[512];
    return is_on_disk(file, path) && (fails(kind, call, path) || fails_on(kinds, call, path));
}

ssize_t write(int file, const void *content, size_t size) {
    REAL(write);
    if (!fails_at(WRITE, GROWS, "write", file)) return real(file, content, size);
    /* A disk that becomes full takes what it can first. */
    if (control->stays && control->failed == 1 && control->error == ENOSPC && size > 1) return real(file, content, size / 2);
    errno = (int)control->error;
    return -1;
}
ssize_t pwrite(int file, const void *content, size_t size, off_t at) {
    REAL(pwrite);
    return fails_at(WRITE, GROWS, "pwrite", file) ? -1 : real(file, content, size, at);
}
ssize_t pwrite64(int file, const void *content, size_t size, off64_t at) {
    REAL(pwrite64);
    return fails_at(WRITE, GROWS, "pwrite", file) ? -1 : real(file, content, size, at);
}
ssize_t writev(int file, const struct iovec *parts, int count) {
    REAL(writev);
    return fails_at(WRITE, GROWS, "writev", file) ? -1 : real(file, parts, count);
}

int rename(const char *from, const char *to) {
    REAL(rename);
    return fails(RENAME, "rename", to) || fails_on(CHANGES, "rename", to) ? -1 : real(from, to);
}
int renameat(int a, const char *from, int b, const char *to) {
    REAL(renameat);
    return fails(RENAME, "renameat", to) || fails_on(CHANGES, "renameat", to) ? -1 : real(a, from, b, to);
}
int renameat2(int a, const char *from, int b, const char *to, unsigned flags) {
    REAL(renameat2);
    return fails(RENAME, "renameat2", to) || fails_on(CHANGES, "renameat2", to) ? -1 : real(a, from, b, to, flags);
}

int fsync(int file) {
    REAL(fsync);
    return fails_at(SYNC, GROWS, "fsync", file) ? -1 : real(file);
}
int fdatasync(int file) {
    REAL(fdatasync);
    return fails_at(SYNC, GROWS, "fdatasync", file) ? -1 : real(file);
}

void *mmap(void *where, size_t size, int protection, int flags, int file, off_t at) {
    REAL(mmap);
    return fails(MAP, "mmap", "") ? MAP_FAILED : real(where, size, protection, flags, file, at);
}
void *mmap64(void *where, size_t size, int protection, int flags, int file, off64_t at) {
    REAL(mmap64);
    return fails(MAP, "mmap", "") ? MAP_FAILED : real(where, size, protection, flags, file, at);
}

static int fails_to_allocate(size_t size) { return control && (int64_t)size >= control->least && fails(ALLOCATE, "malloc", ""); }

/* The C library's own names: looking these up with dlsym would allocate. */
extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);

void *malloc(size_t size) { return fails_to_allocate(size) ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return fails_to_allocate(count * size) ? NULL : __libc_calloc(count, size); }
void *realloc(void *old, size_t size) { return fails_to_allocate(size) ? NULL : __libc_realloc(old, size); }
int posix_memalign(void **place, size_t alignment, size_t size) {
    REAL(posix_memalign);
    return fails_to_allocate(size) ? ENOMEM : real(place, alignment, size);
}

static int fails_to_open(const char *path, int flags) {
    int writes = (flags & O_ACCMODE) != O_RDONLY || flags & O_CREAT;
    int device = !strncmp(path, "/proc/", 6) || (!strncmp(path, "/dev/", 5) && strncmp(path, "/dev/shm/", 9));
    if (control && writes && !device && fails(OPEN, "open", path)) return 1;
    return fails_on(OPENS_FILE | (flags & O_CREAT ? CAN(FULL) : 0), "open", path);
}
static mode_t mode_of(int flags, va_list rest) { return flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0; }

#define OPENS(name)                                                      \
    int name(const char *path, int flags, ...) {                         \
        REAL(name);                                                      \
        va_list rest;                                                    \
        va_start(rest, flags);                                           \
        mode_t mode = mode_of(flags, rest);                              \
        va_end(rest);                                                    \
        return fails_to_open(path, flags) ? -1 : real(path, flags, mode); \
    }
#define OPENS_AT(name)                                                           \
    int name(int folder, const char *path, int flags, ...) {                     \
        REAL(name);                                                              \
        va_list rest;                                                            \
        va_start(rest, flags);                                                   \
        mode_t mode = mode_of(flags, rest);                                      \
        va_end(rest);                                                            \
        return fails_to_open(path, flags) ? -1 : real(folder, path, flags, mode); \
    }
OPENS(open)
OPENS(open64)
OPENS_AT(openat)
OPENS_AT(openat64)

FILE *fopen(const char *path, const char *mode) {
    REAL(fopen);
    return fails_to_open(path, strpbrk(mode, "wa+") ? O_WRONLY | O_CREAT : O_RDONLY) ? NULL : real(path, mode);
}
FILE *fopen64(const char *path, const char *mode) {
    REAL(fopen64);
    return fails_to_open(path, strpbrk(mode, "wa+") ? O_WRONLY | O_CREAT : O_RDONLY) ? NULL : real(path, mode);
}
int mkdir(const char *path, mode_t mode) {
    REAL(mkdir);
    return fails(OPEN, "mkdir", path) || fails_on(CHANGES, "mkdir", path) ? -1 : real(path, mode);
}

int ftruncate(int file, off_t size) {
    REAL(ftruncate);
    return fails_at(LENGTHEN, GROWS, "ftruncate", file) ? -1 : real(file, size);
}
int ftruncate64(int file, off64_t size) {
    REAL(ftruncate64);
    return fails_at(LENGTHEN, GROWS, "ftruncate", file) ? -1 : real(file, size);
}
int truncate(const char *path, off_t size) {
    REAL(truncate);
    return fails(LENGTHEN, "truncate", path) || fails_on(CHANGES, "truncate", path) ? -1 : real(path, size);
}
/* These return the error. */
int posix_fallocate(int file, off_t at, off_t size) {
    REAL(posix_fallocate);
    return fails_at(LENGTHEN, GROWS, "posix_fallocate", file) ? (int)control->error : real(file, at, size);
}
int posix_fallocate64(int file, off64_t at, off64_t size) {
    REAL(posix_fallocate64);
    return fails_at(LENGTHEN, GROWS, "posix_fallocate", file) ? (int)control->error : real(file, at, size);
}

/* Looking at files, reading them, and what changes folders. */
#define ON_PATH(type, name, kinds, path, failed, takes, gives)   \
    type name takes {                                            \
        REAL(name);                                              \
        return fails_on(kinds, #name, path) ? failed : real gives; \
    }
#define ON_FILE(name, kinds, takes, gives)                                      \
    ssize_t name takes {                                                        \
        REAL(name);                                                             \
        char path[512];                                                         \
        return is_on_disk(file, path) && fails_on(kinds, #name, path) ? -1 : real gives; \
    }
ON_PATH(int, stat, LOOKS, path, -1, (const char *path, struct stat *found), (path, found))
ON_PATH(int, stat64, LOOKS, path, -1, (const char *path, struct stat64 *found), (path, found))
ON_PATH(int, lstat, LOOKS, path, -1, (const char *path, struct stat *found), (path, found))
ON_PATH(int, lstat64, LOOKS, path, -1, (const char *path, struct stat64 *found), (path, found))
ON_PATH(int, fstatat, LOOKS, path, -1, (int folder, const char *path, struct stat *found, int flags), (folder, path, found, flags))
ON_PATH(int, fstatat64, LOOKS, path, -1, (int folder, const char *path, struct stat64 *found, int flags), (folder, path, found, flags))
ON_PATH(int, access, LOOKS, path, -1, (const char *path, int mode), (path, mode))
ON_PATH(ssize_t, readlink, LOOKS, path, -1, (const char *path, char *target, size_t size), (path, target, size))
ON_PATH(DIR *, opendir, OPENS_FILE, path, NULL, (const char *path), (path))
ON_PATH(int, unlink, LOOKS, path, -1, (const char *path), (path))
ON_PATH(int, unlinkat, LOOKS, path, -1, (int folder, const char *path, int flags), (folder, path, flags))
ON_PATH(int, rmdir, LOOKS, path, -1, (const char *path), (path))
ON_PATH(int, link, CHANGES, to, -1, (const char *from, const char *to), (from, to))
ON_PATH(int, symlink, CHANGES, to, -1, (const char *from, const char *to), (from, to))
ON_PATH(int, chmod, LOOKS, path, -1, (const char *path, mode_t mode), (path, mode))
ON_PATH(int, utimensat, LOOKS, path, -1, (int folder, const char *path, const struct timespec times[2], int flags), (folder, path, times, flags))
ON_FILE(read, CAN(BROKEN), (int file, void *content, size_t size), (file, content, size))
ON_FILE(pread, CAN(BROKEN), (int file, void *content, size_t size, off_t at), (file, content, size, at))
ON_FILE(pread64, CAN(BROKEN), (int file, void *content, size_t size, off64_t at), (file, content, size, at))

/* Descriptors of what is no file. */
#define ON_NOTHING(name, takes, gives)                            \
    int name takes {                                              \
        REAL(name);                                               \
        return control && fails_one_of(CAN(FILES), #name, "") ? -1 : real gives; \
    }
ON_NOTHING(pipe, (int ends[2]), (ends))
ON_NOTHING(pipe2, (int ends[2], int flags), (ends, flags))
ON_NOTHING(dup, (int file), (file))
ON_NOTHING(socket, (int domain, int type, int protocol), (domain, type, protocol))
ON_NOTHING(socketpair, (int domain, int type, int protocol, int ends[2]), (domain, type, protocol, ends))
ON_NOTHING(epoll_create1, (int flags), (flags))

pid_t fork(void) {
    REAL(fork);
    return fails(START, "fork", "") ? -1 : real();
}
/* What vfork gives must not leave the function that called it: a fork is as good. */
pid_t vfork(void) {
    REAL(fork);
    return fails(START, "vfork", "") ? -1 : real();
}
int posix_spawn(pid_t *process, const char *path, const posix_spawn_file_actions_t *actions,
                const posix_spawnattr_t *attributes, char *const words[], char *const environment[]) {
    REAL(posix_spawn);
    if (fails(START, "posix_spawn", path)) return (int)control->error;
    return real(process, path, actions, attributes, words, environment);
}
int posix_spawnp(pid_t *process, const char *path, const posix_spawn_file_actions_t *actions,
                 const posix_spawnattr_t *attributes, char *const words[], char *const environment[]) {
    REAL(posix_spawnp);
    if (fails(START, "posix_spawn", path)) return (int)control->error;
    return real(process, path, actions, attributes, words, environment);
}
int execve(const char *path, char *const words[], char *const environment[]) {
    REAL(execve);
    return fails(START, "execve", path) ? -1 : real(path, words, environment);
}
int execv(const char *path, char *const words[]) {
    REAL(execv);
    return fails(START, "execv", path) ? -1 : real(path, words);
}
int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *), void *with) {
    REAL(pthread_create);
    return fails(START, "pthread_create", "") ? EAGAIN : real(thread, attributes, run, with);
}
