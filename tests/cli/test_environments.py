"""The places commands are started in: each gives the same as an undisturbed one, or one true message.

The table says for every environment which commands give the same; of the others the message is known, or a part of it.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from dse.api import results

pytestmark = [
    pytest.mark.nightly,
    pytest.mark.skipif(sys.platform != "linux", reason="shells, limits and users are those of Linux"),
]

WORKSPACE = Path(__file__).parents[1] / "faults" / "workspace"
SCRIPT = "import sys; from dse.cli import main; sys.exit(main())"
ODD = "h\N{LATIN SMALL LETTER A WITH DIAERESIS}gar \N{SNOWMAN}\n'\"$x"
BYTES = os.fsdecode(b"caf\xe9 \xff")

COMMANDS = {
    "check": "check",
    "enumerate": "enumerate carts --format csv",
    "run": "run start -o {out} -j 2",
    "explore": "explore all -o {out} -j 2",
    "report": "report {study} -o {out}",
    "figure": "figure {study} -o {out} --only margins",
    "results": "results {study}",
    "export": "export ssp start -o {out}.ssp",
    "simulate": "simulate start",
}
READS = ("check", "enumerate", "report", "figure", "results")
"""Commands that start no FMU and build none."""


@dataclass
class Place:
    """Where and how a command is started; *shell* comes before it, and *after* behind it."""

    folder: Path
    """Everything of this case lies in it; made by a case from `base`."""
    environment: dict[str, str]
    shell: str = ""
    after: str = ""
    python: list[str] = field(default_factory=lambda: [sys.executable, "-P", "-c", SCRIPT])
    out: Path = Path()
    cwd: Path = Path()
    study: Path = Path()

    def start(self, command: str) -> subprocess.CompletedProcess[bytes]:
        words = [word.format(out=self.out, study=self.study) for word in COMMANDS[command].split()]
        line = f"{self.shell} {shlex.join([*self.python, *words])} {self.after}"
        shell = ["bash", "-c", f"set -o pipefail; {line}"]
        environment = {os.fsencode(name): os.fsencode(value) for name, value in self.environment.items()}
        return subprocess.run(
            list(map(os.fsencode, shell)),
            cwd=os.fsencode(self.cwd),
            env=environment,
            capture_output=True,
            check=False,
            timeout=600,
        )

    def product(self, command: str, printed: bytes) -> object:
        """What the command made."""
        if command in ("run", "explore"):
            return results(self.out).export("csv")
        if command == "figure":
            return sorted(path.name for path in self.out.iterdir())
        if command == "report":
            return self.out.read_bytes()
        if command == "export":
            return Path(f"{self.out}.ssp").read_bytes()
        return printed


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Place:
    """A workspace, a study and a warm cache."""
    folder = tmp_path_factory.mktemp("base")
    folder.chmod(0o755)
    shutil.copytree(WORKSPACE, folder / "work")
    (folder / "tmp").mkdir()
    # Without the compiler's launcher of these tests, which lies where nobody else may look.
    environment = {name: value for name, value in os.environ.items() if name != "CC"}
    environment |= {"DSE_CACHE": str(folder / "cache"), "TMPDIR": str(folder / "tmp"), "COLUMNS": "100"}
    place = Place(folder, environment, cwd=folder / "work", study=folder / "study", out=folder / "study")
    done = place.start("explore")
    assert done.returncode == 0, done.stderr
    return place


@pytest.fixture(scope="module")
def undisturbed(base: Place) -> dict[str, object]:
    def made(command: str) -> object:
        base.out = base.folder / f"undisturbed-{command}"
        done = base.start(command)
        assert done.returncode == 0, done.stderr
        return base.product(command, done.stdout)

    return {command: made(command) for command in COMMANDS}


@pytest.fixture
def place(base: Place, undisturbed: object, tmp_path: Path) -> Place:
    folder = tmp_path / "case"
    folder.mkdir()
    return Place(folder, dict(base.environment), cwd=base.cwd, study=base.study, out=folder / "out")


def moved(place: Place, name: str) -> None:
    """Everything lies below a folder called *name*, and the cache is cold."""
    folder = place.folder / name
    for what, there in (("work", place.cwd), ("study", place.study)):
        shutil.copytree(there, folder / what)
    (folder / "tmp").mkdir()
    place.cwd, place.study, place.out = folder / "work", folder / "study", folder / "out"
    place.environment |= {"DSE_CACHE": str(folder / "cache"), "TMPDIR": str(folder / "tmp")}


def at_start(place: Place, code: str) -> None:
    """Have every Python of this place carry out *code* first."""
    (place.folder / "site").mkdir()
    (place.folder / "site" / "sitecustomize.py").write_text(f"{code}\n")
    place.environment["PYTHONPATH"] = str(place.folder / "site")


def without_home(place: Place) -> None:
    for name in ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "USER", "LOGNAME"):
        place.environment.pop(name, None)


def without_home_or_cache(place: Place) -> None:
    without_home(place)
    del place.environment["DSE_CACHE"]
    place.environment |= {"HOME": str(place.folder / "nowhere" / "home")}


def without_compiler(place: Place) -> None:
    (place.folder / "bin").mkdir()
    for tool in ("bash", "rm", "sleep", "head"):
        (place.folder / "bin" / tool).symlink_to(shutil.which(tool) or tool)
    place.environment["PATH"] = str(place.folder / "bin")
    at_start(place, "import sys; sys.modules['ziglang'] = None")


def without_compiler_cold(place: Place) -> None:
    without_compiler(place)
    place.environment["DSE_CACHE"] = str(place.folder / "cache")


def c_locale(place: Place) -> None:
    place.environment |= {"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


def odd_settings(place: Place) -> None:
    place.environment |= {"TZ": "Not/AZone-13", "PYTHONHASHSEED": "4242", "LANGUAGE": "xx", "TERM": "nonsense"}


def odd_names(place: Place) -> None:
    moved(place, ODD)


def bytes_in_names(place: Place) -> None:
    moved(place, BYTES)


def few_files(place: Place) -> None:
    place.shell = "ulimit -n 20;"


def little_memory(place: Place) -> None:
    place.shell = "ulimit -v 200000;"


def unwritable_tmp(place: Place) -> None:
    place.environment["TMPDIR"] = "/proc/1"


def full_tmp(place: Place) -> None:
    full = place.folder / "full"
    full.mkdir()
    mount = f"mount -t tmpfs -o size=16k tmpfs {full} && dd if=/dev/zero of={full}/all 2>/dev/null"
    place.shell = f"{mount}; exec"
    place.python = ["unshare", "-m", "bash", "-c", f'{mount}; TMPDIR={full} exec "$@"', "-", *place.python]
    place.shell = ""


def full_disk(place: Place) -> None:
    """For what is written, the cache included, which is cold."""
    full_tmp(place)
    full = place.folder / "full"
    place.out = full / "out"
    place.environment["DSE_CACHE"] = str(full / "cache")


def emptied_tmp(place: Place) -> None:
    folder = place.folder / "tmp"
    folder.mkdir()
    place.environment |= {"TMPDIR": str(folder), "DSE_CACHE": str(place.folder / "cache")}
    place.shell = f"(while sleep 0.05; do rm -rf {folder}/* 2>/dev/null; done) & trap 'kill %1' EXIT;"


def deleted_folder(place: Place) -> None:
    place.cwd = place.folder / "gone"
    place.cwd.mkdir()
    place.shell = 'rmdir "$PWD";'


def deleted_under_way(place: Place) -> None:
    shutil.copytree(place.cwd, place.folder / "going")
    place.cwd = place.folder / "going"
    place.shell = '(sleep 0.7; rm -rf "$PWD") &'


def full_output(place: Place) -> None:
    place.after = "> /dev/full"


def full_target(place: Place) -> None:
    place.out = Path("/dev/full")


def full_errors(place: Place) -> None:
    place.after = "2> /dev/full"


def closed_streams(place: Place) -> None:
    place.after = "<&- >&- 2>&-"


def closed_errors(place: Place) -> None:
    place.after = "<&- 2>&-"


def left_reader(place: Place) -> None:
    place.after = "| head -c 1"


def jumping_clock(place: Place) -> None:
    at_start(
        place,
        "import time\nreal, start = time.time, time.monotonic()\n"
        "time.time = lambda: real() + (0, 1e7, -1e8)[int((time.monotonic() - start) * 3) % 3]",
    )


def another_user(place: Place) -> None:
    """Who may write neither into the installation nor into the workspace, and has neither home nor cache."""
    moved(place, "theirs")
    without_home(place)
    place.environment |= {"HOME": "/nonexistent", "TMPDIR": str(place.folder / "free")}
    place.environment["DSE_CACHE"] = str(place.folder / "free" / "cache")
    for name in ("free", "free/results"):
        (place.folder / name).mkdir()
        os.chown(place.folder / name, 65534, 65534)
    place.out = place.folder / "free" / "results" / "out"
    for above in place.folder.parents:
        if above.stat().st_mode & 0o777 == 0o700:
            above.chmod(0o755)
    place.python = ["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups", *place.python]


def read_only_cache(place: Place) -> None:
    """Its cache is another's, warm, and may only be read."""
    cache = place.environment["DSE_CACHE"]
    another_user(place)
    place.environment["DSE_CACHE"] = cache


def read_only_target(place: Place) -> None:
    another_user(place)
    place.out = place.cwd.parent / "out"


ALL, NONE = tuple(COMMANDS), ()
NO_ROOM = ("No space left on device", "no space left on device", "there is no room")
MEMORY = ("memory", "ulimit -v")
WORKS: dict[Callable[[Place], None], tuple[tuple[str, ...], tuple[str, ...]]] = {
    without_home: (ALL, ()),
    without_home_or_cache: (ALL, ()),
    without_compiler: (ALL, ()),
    without_compiler_cold: (READS, ("there is no C compiler on this machine",)),
    c_locale: (ALL, ()),
    odd_settings: (ALL, ()),
    odd_names: (ALL, ()),
    bytes_in_names: (ALL, ()),
    few_files: (READS, ("open files",)),
    little_memory: (NONE, MEMORY),
    unwritable_tmp: (ALL, ()),
    full_tmp: (ALL, ()),
    full_disk: (("check", "enumerate", "results"), NO_ROOM),
    emptied_tmp: (READS, ("dse-", "temporary", "emptied")),
    deleted_folder: (("report", "figure", "results"), ("/gone: the current folder was deleted",)),
    deleted_under_way: (NONE, ("/going: the current folder was deleted",)),
    full_output: (NONE, ("standard output cannot be written: No space left on device",)),
    full_target: (("check", "enumerate", "results", "simulate"), ("/dev/full",)),
    full_errors: (ALL, ()),
    closed_streams: (ALL, ()),
    closed_errors: (ALL, ()),
    left_reader: (ALL, ()),
    jumping_clock: (ALL, ()),
    another_user: (ALL, ()),
    read_only_cache: (ALL, ()),
    read_only_target: (("check", "enumerate", "results", "simulate"), ("there is no right to", "Permission denied")),
}
"""What of the commands gives the same, and words of which one is in the message of the others.

Where it depends on the moment, or on how much the system needs, commands that may fail may also succeed.
"""


def may_run(case: Callable[[Place], None]) -> str:
    """Why the case cannot be tried here, if it cannot."""
    needed = {"mount": (full_tmp, full_disk), "setpriv": (another_user, read_only_cache, read_only_target)}
    for tool, cases in needed.items():
        if case in cases and (os.geteuid() != 0 or not shutil.which(tool)):
            return f"only root can use {tool}"
    if case in needed["setpriv"] and any(
        not above.stat().st_mode & 0o001 for above in Path(sys.executable).resolve().parents
    ):
        return "Python itself lies where nobody else may look"
    return ""


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("case", WORKS, ids=lambda case: case.__name__)
def test_a_command_gives_the_same_anywhere_or_one_true_message(place, undisturbed, case, command):
    if reason := may_run(case):
        pytest.skip(reason)
    works, words = WORKS[case]
    case(place)
    done = place.start(command)
    said = done.stderr.decode("utf-8", "surrogateescape")
    assert "Traceback" not in said
    assert "mistake in dse" not in said
    assert done.returncode in (0, 1, 2, 3), said
    if done.returncode == 0:
        if not place.after.startswith((">", "|", "<&- >&-")) or command not in (
            "check",
            "enumerate",
            "results",
            "simulate",
        ):
            assert place.product(command, done.stdout) == undisturbed[command], said
        return
    assert command not in works, said
    message = [line for line in said.splitlines() if line and not line.startswith(("    hint: ", "runs ", "note: "))]
    assert len(message) == 1, said
    assert any(word in said for word in words), said
