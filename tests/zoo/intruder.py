"""An FMU that tries to reach what is none of its business; its output tells what it reached, a bit for each try."""

from __future__ import annotations

from pathlib import Path

from zoo.animals import Animal, build_animal

_TRIES = {
    "a file in the home": "is_made(at(place, \"home/new\"))",
    "the file of results": "opens(at(place, \"out/study.sqlite\"), O_RDWR)",
    "a file beside the study": "is_made(at(place, \"out/new\"))",
    "its own unpacked folder": "renames_its_library()",
    "a file that is there": "!truncate(at(place, \"home/kept\"), 3)",
    "a file that is emptied as it is read": "opens(at(place, \"home/emptied\"), O_RDONLY | O_TRUNC)",
    "what a file allows": "!chmod(at(place, \"home/kept\"), 0644)",
    "when a file was changed": "!utimes(at(place, \"home/kept\"), NULL)",
    "a file in memory": "maps(at(place, \"home/kept\"))",
    "a secret": "opens(at(place, \"home/.ssh/id\"), O_RDONLY)",
    "a link out": "links()",
    "TCP": "is_there(socket(AF_INET, SOCK_STREAM, 0))",
    "UDP": "is_there(socket(AF_INET, SOCK_DGRAM, 0))",
    "a socket with a name": "connects(at(place, \"socket\"))",
    "a nameless socket, sent to one with a name": "is_there(pair(SOCK_DGRAM))",
    "a file, through a process of its own": "forks()",
    "a file, through a shell": "!system(\"echo more >\\\"$INTRUDER_PLACE/home/of_a_shell\\\"\")",
    "a file, through a thread": "threads()",
    "the supervisor, by a signal": "!kill(getppid(), 0)",
    "the limits of the supervisor": "!prlimit(getppid(), RLIMIT_NOFILE, NULL, &limit)",
    "tracing": "traces()",
}  # fmt: skip

_ALLOWED = {
    "a file in the current folder": "is_made(\"own\")",
    "a temporary file": "is_made(at(getenv(\"TMPDIR\"), \"temporary\"))",
    "its limits": "!getrlimit(RLIMIT_NOFILE, &limit)",
    "connected streams": "is_there(pair(SOCK_STREAM))",
    "a system library": "opens(\"/proc/self/status\", O_RDONLY)",
    "a device": "opens(\"/dev/null\", O_WRONLY)",
}  # fmt: skip

_BEFORE = r"""
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <sys/wait.h>

static const char *place;
static struct rlimit limit;
static double reached;

static const char *at(const char *folder, const char *name)
{
    static char paths[4][4096];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof *paths, "%s/%s", folder, name);
    return path;
}
static bool is_there(int handle) { return handle >= 0 && !close(handle); }
static bool opens(const char *path, int flags) { return is_there(open(path, flags)); }
static bool is_made(const char *path) { return is_there(open(path, O_WRONLY | O_CREAT, 0600)); }
static bool renames_its_library(void)
{
    Dl_info info;
    dladdr((void *)renames_its_library, &info);
    const char *other = at(place, "moved");
    return !rename(info.dli_fname, other) && !rename(other, info.dli_fname);
}
static bool maps(const char *path)
{
    int file = open(path, O_RDWR);
    void *mapped = mmap(NULL, 1, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    return mapped != MAP_FAILED && !munmap(mapped, 1);
}
static bool links(void) { unlink("link"); return !symlink("/etc/passwd", "link"); }
static int pair(int type)
{
    int ends[2];
    if (socketpair(AF_UNIX, type, 0, ends)) return -1;
    close(ends[1]);
    return ends[0];
}
static bool connects(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    strncpy(address.sun_path, path, sizeof address.sun_path - 1);
    int end = socket(AF_UNIX, SOCK_STREAM, 0);
    bool done = !connect(end, (struct sockaddr *)&address, sizeof address);
    close(end);
    return done;
}
static bool ends_well(pid_t child)
{
    int status = 1;
    return waitpid(child, &status, 0) == child && status == 0;
}
static bool forks(void)
{
    pid_t child = fork();
    if (!child) _exit(!is_made(at(place, "home/of_a_child")));
    return ends_well(child);
}
static bool traces(void)
{
    pid_t child = fork();
    if (!child) _exit(ptrace(PTRACE_TRACEME, 0, NULL, NULL) != 0);
    return ends_well(child);
}
static void *write_there(void *made) { *(bool *)made = is_made(at(place, "home/of_a_thread")); return NULL; }
static bool threads(void)
{
    bool made = false;
    pthread_t thread;
    return !pthread_create(&thread, NULL, write_there, &made) && !pthread_join(thread, NULL) && made;
}
static double intrude(void)
{
    place = getenv("INTRUDER_PLACE");
    long now = 0;
TRIES
    reached = now > reached ? now : reached;
    return reached;
}
"""


def build_intruder(folder: Path) -> Path:
    """Its archive in *folder*; it looks for things in the folder that INTRUDER_PLACE names."""
    every = [*_TRIES.values(), *_ALLOWED.values()]
    tries = "\n".join(f"    now |= (long)({code}) << {bit};" for bit, code in enumerate(every))
    step = {"step": "a->real[Y] = intrude();"}
    return build_animal(Animal(step, before=_BEFORE.replace("TRIES", tries)), folder, "intruder")


def reached(output: float) -> set[str]:
    """What it has reached, of what it must not."""
    return {what for bit, what in enumerate(_TRIES) if int(output) >> bit & 1}


def missed(output: float) -> set[str]:
    """What it should have reached and has not."""
    return {what for bit, what in enumerate(_ALLOWED, len(_TRIES)) if not int(output) >> bit & 1}


FORBIDDEN = frozenset(_TRIES)
