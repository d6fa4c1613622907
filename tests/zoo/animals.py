"""FMUs that misbehave, each in one way of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from reference_fmus.build import HEADERS, compile_c, library_path, token_of, write_archive
from reference_fmus.declared import Declared, ReferenceModel
from reference_fmus.describe import description

from dse.fmu.toolchain.platforms import Platform, this_platform

MODEL = ReferenceModel(
    "animal",
    (
        Declared("u", "Float64", "input", start=("0",)),
        Declared("y", "Float64", "output", initial="calculated"),
        Declared("bites", "Float64", "parameter", "fixed", start=("0",)),
        Declared("gain", "Float64", "parameter", "fixed", start=("1",)),
        Declared("text", "String", "output", "discrete", "calculated"),
        Declared("text_in", "String", "input", "discrete", start=("",)),
    ),
    stop=1.0,
    step=0.1,
)


@dataclass(frozen=True, slots=True)
class Animal:
    """What an animal does at which occasion (C statements; *before* stands outside of functions), and what is said of
    the run in which it does it.

    *says* are pieces of the problem's text; without any, the run is as good as any other. *every* is set if it bites
    in every run, asked to or not; *needs_tool* if the description says that it needs another program.
    """

    at: Mapping[str, str]
    says: tuple[str, ...] = ()
    before: str = ""
    every: bool = False
    needs_tool: bool = False
    flags: tuple[str, ...] = field(default=())


HALF = "fmi2DoStep at t = 0.5 s"

ANIMALS: Mapping[str, Animal] = {
    "tame": Animal({}),
    # It ends the process, or does not let go of it.
    "crashes": Animal({"step": "*(volatile int *)0 = 1;"}, ("crashed (signal 11)", HALF)),
    "aborts": Animal({"step": "abort();"}, ("crashed (signal 6)", HALF)),
    "divides_by_zero": Animal({"step": "raise(SIGFPE);"}, ("crashed (signal 8)", HALF)),
    "exits": Animal({"step": "exit(0);"}, ("ended by itself (exit code 0)", HALF)),
    "exits_at_once": Animal({"step": "_exit(7);"}, ("ended by itself (exit code 7)", HALF)),
    "overflows_the_stack": Animal(
        {"step": "a->real[Y] = deep(1);"},
        ("crashed (signal 11)", HALF),
        # Each round keeps a page, and the result is needed after the next one returns.
        before="static double deep(double x) { volatile char room[4096]; room[0] = 1; return deep(x + 1) + room[0]; }",
        flags=("-Wno-infinite-recursion",),
    ),
    "hangs": Animal({"step": "for (volatile long i = 0;; i++) { }"}, ("no answer for 2 s", HALF)),
    "stops_itself": Animal({"step": "raise(SIGSTOP);"}, ("stopped by a signal for 2 s", HALF)),
    "is_killed": Animal({"step": "raise(SIGKILL);"}, ("killed from outside", HALF)),
    "hangs_in_initialization": Animal(
        {"initialization": "for (volatile long i = 0;; i++) { }"}, ("no answer for 2 s", "fmi2ExitInitializationMode")
    ),
    "crashes_in_get": Animal(
        {"get": "if (a->time > 0.499) abort();"}, ("crashed (signal 6)", "fmi2GetReal at t = 0.5 s")
    ),
    "crashes_in_terminate": Animal({"terminate": "abort();"}, ("crashed (signal 6)", "fmi2Terminate at t = 1 s")),
    "leaks": Animal(
        {"step": "for (;;) hoard = memset(malloc(1 << 24), 1, 1 << 24);"},
        ("grew beyond 0.3 GB of memory", HALF),
        before="void *volatile hoard;",
    ),
    # It bites before anybody can tell it not to.
    "crashes_in_instantiate": Animal(
        {"instantiate": "abort();"}, ("crashed (signal 6)", "fmi2Instantiate"), every=True
    ),
    "hangs_in_instantiate": Animal(
        {"instantiate": "for (volatile long i = 0;; i++) { }"}, ("no answer for 2 s", "fmi2Instantiate"), every=True
    ),
    "refuses_to_be": Animal(
        {"instantiate": 'say(a, fmi2Error, "no licence found"); free(a); return NULL;'},
        ("head: fmi2Instantiate", "no licence found"),
        every=True,
    ),
    "needs_a_tool": Animal(
        {"instantiate": "free(a); return NULL;"},
        ("head: fmi2Instantiate", "declares that it needs another program"),
        every=True,
        needs_tool=True,
    ),
    "wrong_guid": Animal({}, ("head: fmi2Instantiate", "not of that model description"), every=True),
    "lacks_a_function": Animal(
        {}, ("head: animal: the FMU's library lacks the function fmi2DoStep",), every=True, flags=("-DWITHOUT_STEP",)
    ),
    "no_library": Animal({}, ("head: animal: the FMU's library cannot be loaded: binaries/",), every=True),
    "crashes_when_loaded": Animal(
        {"load": "abort();"}, ("crashed (signal 6) in head: loading its library",), every=True
    ),
    "exits_when_loaded": Animal(
        {"load": "exit(3);"}, ("ended by itself (exit code 3) in head: loading its library",), every=True
    ),
    # It says that something is wrong.
    "returns_an_error": Animal(
        {"step": 'say(a, fmi2Error, "tyre left the road"); return fmi2Error;'}, (f"head: {HALF}", "tyre left the road")
    ),
    "returns_fatal": Animal(
        {"step": 'say(a, fmi2Fatal, "all is lost"); return fmi2Fatal;'}, (f"head: {HALF}", "all is lost", "fatal")
    ),
    "discards": Animal({"step": "return fmi2Discard;"}, (f"head: {HALF}",)),
    "is_pending": Animal({"step": "return fmi2Pending;"}, (f"head: {HALF}",)),
    "returns_garbage": Animal({"step": "return (fmi2Status)77;"}, (f"head: {HALF}", "77")),
    "returns_less_than_nothing": Animal({"step": "return (fmi2Status)-1;"}, (f"head: {HALF}", "-1")),
    "fails_in_initialization": Animal(
        {"initialization": 'say(a, fmi2Error, "no equilibrium"); return fmi2Error;'},
        ("head: fmi2ExitInitializationMode", "no equilibrium"),
    ),
    "fails_in_terminate": Animal(
        {"terminate": 'say(a, fmi2Error, "cannot let go"); return fmi2Error;'}, ("head: fmi2Terminate", "cannot let go")
    ),
    "fails_to_reset": Animal({"reset": "return fmi2Error;"}),
    "returns_nan": Animal({"step": "a->real[Y] = NAN;"}, ("head.y became nan at t = 0.6 s",)),
    "returns_infinity": Animal({"step": "a->real[Y] = -INFINITY;"}, ("head.y became -inf at t = 0.6 s",)),
    # It harms nobody, if all goes well.
    "lies_about_reset": Animal({"reset": "return fmi2OK;"}),
    "prints_a_lot": Animal(
        {"step": "for (int i = 0; i < 5000; i++) puts(line); for (int i = 0; i < 200; i++) fputs(line, stderr);"},
        before=('static const char line[] = "all work and no play makes this FMU a dull component of a car\\n";'),
    ),
    "logs_a_lot": Animal({"step": 'for (int i = 0; i < 100000; i++) say(a, fmi2OK, "and on and on");'}),
    "logs_oddly": Animal(
        {
            "step": r'a->log(a->environment, NULL, 99, NULL, "%s", "\xff\xfe\n\n");'
            " a->log(a->environment, NULL, 0, NULL, NULL);"
            " char *big = malloc(1 << 22); memset(big, 'x', 1 << 22), big[(1 << 22) - 1] = 0; say(a, fmi2OK, big);"
        }
    ),
    "logs_from_a_thread": Animal(
        {
            "instantiate": "a->has_thread = !pthread_create(&a->thread, NULL, chatter, a);",
            "free": "a->done = true; if (a->has_thread) pthread_join(a->thread, NULL);",
        },
        before="static void *chatter(void *c) {"
        ' Animal *a = c; while (!a->done) say(a, fmi2OK, "still here"), usleep(10); return NULL; }',
    ),
    "logs_after_its_end": Animal(
        {"instantiate": "Animal *b = malloc(sizeof *a); *b = *a; pthread_create(&a->thread, NULL, chatter, b);"},
        before="static void *chatter(void *c) {"
        ' Animal *a = c; for (;;) say(a, fmi2OK, "still here"), usleep(100); return NULL; }',
    ),
    "changes_the_folder": Animal({"step": 'if (chdir("/")) return fmi2Error;'}),
    "changes_the_locale": Animal({"step": 'setlocale(LC_ALL, "C.UTF-8");'}),
    "changes_rounding": Animal({"step": "fesetround(FE_UPWARD);"}, (f"head: {HALF}", "floating-point mode")),
    "changes_rounding_first": Animal(
        {"initialization": "fesetround(FE_UPWARD);"}, ("head: fmi2ExitInitializationMode", "floating-point mode")
    ),
    # As libraries compiled with -ffast-math do; nothing of it must be left when the run begins.
    "changes_rounding_when_loaded": Animal({"load": "fesetround(FE_UPWARD);"}),
    "traps_floating_point": Animal(
        {"step": "feenableexcept(FE_INVALID | FE_DIVBYZERO);"}, (f"head: {HALF}", "floating-point mode")
    ),
    "forks": Animal({"step": "if (!fork()) sleep(2), _exit(0);"}),
    "forks_and_goes_on": Animal({"step": "fork();"}),
    "sets_an_alarm": Animal({"step": "alarm(1);"}),
    "hides_its_files": Animal({"step": "umask(0777);"}, before="#include <sys/stat.h>"),
    "scribbles": Animal(
        {"step": "for (int i = 3; i < 64; i++) if (write(i, line, sizeof line) < 0) continue;"},
        before='static const char line[] = "all work and no play";',
    ),
    "leaves_files_open": Animal({"step": "while (dup(0) >= 0) { }"}),
    "crashes_when_freed": Animal({"free": "if (a->real[BITES] == 1) abort();"}),
    "closes_files": Animal({"step": "for (int i = 3; i < 64; i++) close(i);"}),
    "closes_all_files": Animal({"step": "for (int i = 0; i < 1024; i++) close(i);"}),
    "deletes_its_files": Animal(
        {"step": "Dl_info info; if (dladdr((void *)fmi2DoStep, &info)) unlink(info.dli_fname);"},
        before="#include <dlfcn.h>",
    ),
    "handles_signals": Animal(
        {
            "step": "for (int i = 1; i < 32; i++) signal(i, SIG_IGN); sigset_t all; sigfillset(&all);"
            " pthread_sigmask(SIG_BLOCK, &all, NULL);"
        }
    ),
    "locks_memory": Animal({"step": "mlockall(MCL_CURRENT | MCL_FUTURE);"}),
    "leaves_threads_at_work": Animal(
        {"terminate": "for (int i = 0; i < 3; i++) pthread_create(&a->thread, NULL, spin, a);"},
        before="static void *spin(void *c) { for (volatile long i = 0;; i++) { } return c; }",
    ),
    **{
        f"limits_{name.lower()}": Animal(
            {"step": f"setrlimit(RLIMIT_{name}, &(struct rlimit){{{most}, {most}}});"},
            before="#include <sys/resource.h>",
        )
        for name, most in {"AS": 1, "DATA": 1, "FSIZE": 0, "NOFILE": 3}.items()
    },
    # It reaches for the process that has started it: the study's.
    **{
        name: Animal({"step": f"{call};"}, ("tried to signal the study", HALF))
        for name, call in {
            "ends_its_parent": "kill(getppid(), SIGTERM)",
            "stops_its_parent": "kill(getppid(), SIGSTOP)",
            "kills_its_parent": "syscall(SYS_tkill, getppid(), SIGKILL)",
            "ends_its_group": "kill(0, SIGTERM)",
        }.items()
    },
}


def build_animal(animal: Animal, folder: Path, name: str, platform: Platform | None = None) -> Path:
    """``NAME.fmu`` in *folder*, with a library for *platform* or this one."""
    token = token_of(MODEL, 2)
    work = folder / f"{name}_files"
    work.mkdir(parents=True)
    bite = [animal.before, *(f"#define AT_{at.upper()} {code}" for at, code in animal.at.items())]
    (work / "bite.h").write_text("\n".join(bite) + "\n", encoding="utf-8")
    library = work / f"animal{(platform or this_platform()).suffix}"
    known = "another one" if name == "wrong_guid" else token
    include = [f"-I{work}", f"-I{HEADERS}", f'-DTOKEN="{known}"', "-D_DEFAULT_SOURCE", "-pthread"]
    compile_c([*include, *animal.flags, str(Path(__file__).parent / "animal.c")], library)
    content = b"no library at all" if name == "no_library" else library.read_bytes()
    xml = description(MODEL, 2, ["CoSimulation"], token)
    if animal.needs_tool:
        xml = xml.replace("<CoSimulation ", '<CoSimulation needsExecutionTool="true" ')
    files = {
        "modelDescription.xml": xml.encode(),
        str(library_path(2, "animal", platform)): content,
    }
    return write_archive(folder / f"{name}.fmu", files)
