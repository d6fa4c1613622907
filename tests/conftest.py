"""What holds for all tests: how much hypothesis tries, that nothing is compiled twice, and which are left out."""

from __future__ import annotations

import gc
import os
import shutil
import signal
import sys
import threading
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import compile_cache
import processor_time
import pytest
from hypothesis import HealthCheck, is_hypothesis_test, settings

# How many examples hypothesis tries, by profile, as a factor of what a test says or of hypothesis's own number. They
# are the same each time, but nightly, when new ones are looked for; a busy machine is never to blame.
_EXAMPLES = {"everyday": 0.25, "thorough": 0.5, "nightly": 10}
for _profile in _EXAMPLES:
    settings.register_profile(
        _profile,
        derandomize=_profile != "nightly",
        deadline=None,
        print_blob=True,
        suppress_health_check=[HealthCheck.too_slow],
    )
settings.load_profile("everyday")

# Tests survive no power cut; waiting for the disk would take them longer than all else.
os.fsync = lambda _file: None

# Hundreds of tests start a Python of their own; without its bytecode each would compile all it imports.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# What a shell starts in the background ignores interrupts, and so would all that tests start and interrupt.
if threading.current_thread() is threading.main_thread():
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if sys.platform != "win32":
        signal.signal(signal.SIGHUP, signal.SIG_DFL)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Which tests are run, how C is compiled, and where processor times are written."""
    what = "only tests that can reach these rooms of dse (cosim,fmu) or what differs from main (changed), or those of"
    what += " what differs from the commit in .ci/base and, by turns, a fifth of the others (base)"
    parser.addoption("--rooms", metavar="WHICH", help=what)
    parser.addoption("--optimized", action="store_true", help="compile C with the optimizer, as users do")
    what = "in CI, fail if an everyday test, or all of them together, cost too much processor time"
    parser.addoption("--budget", action="store_true", help=what)
    parser.addoption("--processor-time", metavar="FILE", help="write the processor time of each test to FILE, as JSON")


def pytest_configure(config: pytest.Config) -> None:
    """Keep what the C compiler makes in pytest's cache (``pytest --cache-clear`` empties it); charge tests."""
    if hasattr(config, "cache"):
        compile_cache.use(config.cache.mkdir("compiled"), optimized=config.getoption("--optimized"))
    config.pluginmanager.register(processor_time.ProcessorTime(config))
    if which := config.getoption("--rooms"):
        from affected import ByRooms

        config.pluginmanager.register(ByRooms(config, which))


def pytest_sessionstart() -> None:
    """Do not collect garbage while thousands of tests, which stay, are made; afterwards they are left out of it."""
    gc.disable()


def pytest_collection_finish() -> None:
    """See pytest_sessionstart."""
    gc.collect()
    gc.freeze()
    gc.enable()


@pytest.fixture(scope="session")
def built_before(request: pytest.FixtureRequest) -> Callable[[Path], Path]:
    """Makes a new folder the cache of dse that holds FMUs and models built before, by any test, and nothing else.

    They are kept between runs as long as what can take part in building is what it was, to the byte.
    """
    from dse.cache import content_key

    room = Path(request.config.cache.mkdir("built"))
    rooms = [folder for folder in _DSE.iterdir() if folder.is_dir() and folder.name not in _ABOVE_BUILDING]
    code = [*_DSE.glob("*.py"), *(path for folder in rooms for path in folder.rglob("*.[pch]*"))]
    sources = [(path.relative_to(_DSE).as_posix(), path.read_bytes()) for path in sorted(code) if path.suffix in _CODE]
    ours = room / content_key([*sources, ("optimized", os.environ.get(compile_cache.OPTIMIZED, "").encode())])
    ours.mkdir(exist_ok=True)
    os.utime(ours)
    for other in room.iterdir():
        if other.stat().st_mtime < time.time() - 86400:
            shutil.rmtree(other, ignore_errors=True)

    def fill(folder: Path) -> Path:
        folder.mkdir(exist_ok=True)
        if sys.platform != "win32":  # whose links are for administrators
            for shelf in ("built", "checked", "coded", "modelica", "objects"):
                (ours / shelf).mkdir(exist_ok=True)
                with suppress(FileExistsError):  # another worker of a parallel run was first
                    (folder / shelf).symlink_to(ours / shelf)
        return folder

    return fill


@pytest.fixture(scope="module")
def kept_cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Iterator[None]:
    """The tests of a module use one cache of dse: FMUs are built once for all of them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DSE_CACHE", str(built_before(tmp_path_factory.mktemp("cache"))))
        yield


_DSE = Path(__file__).parents[1] / "dse"
_CODE = (".py", ".c", ".h")
# Rooms above `kinds`, which builds; the contract of the layers has it import none of them.
_ABOVE_BUILDING = frozenset(
    ("cli", "plugins", "serving", "testing", "api", "report", "analysis", "exploration", "interchange", "testbench")
)


@pytest.fixture(scope="session")
def wine_cache(request: pytest.FixtureRequest) -> Path:
    """A cache folder of dse that is kept between runs, as wine's folder of Windows is large and takes its time."""
    from dse.cache import CacheWarning
    from dse.fmu.windows import find_wine, folder_of_windows

    wine = find_wine()
    if not wine:
        pytest.skip("there is no wine on this machine")
    cache = Path(request.config.cache.mkdir("wine"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CacheWarning)
        folder_of_windows(wine, cache)
    return cache


@pytest.hookimpl(tryfirst=True)  # before tests are chosen by their marks
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave all but every n-th case of tests marked ``sampled(n)`` to the thorough run; set numbers of examples."""
    counted: Counter[str] = Counter()
    for item in items:
        sampled = item.get_closest_marker("sampled")
        if sampled and not item.get_closest_marker("thorough"):
            name = item.nodeid.partition("[")[0]
            if counted[name] % sampled.args[0]:
                item.add_marker(pytest.mark.thorough)
            counted[name] += 1
    factor = _EXAMPLES[config.getoption("--hypothesis-profile") or "everyday"]
    # Most tests say their own number, which no profile changes; there is no public way to.
    for test in {item.obj for item in items if isinstance(item, pytest.Function) and is_hypothesis_test(item.obj)}:
        own = test._hypothesis_internal_use_settings
        examples = max(5, round(factor * own.max_examples))
        test._hypothesis_internal_use_settings = settings(own, max_examples=examples)


@pytest.fixture
def real_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    """For tests of what compiling the same sources twice gives: nothing is taken from what was kept."""
    compile_cache.leave(monkeypatch)


@pytest.fixture
def few_files() -> Iterator[None]:
    """Processes that are started from here can open only a few hundred files, and be let open more."""
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (400, hard))
    yield
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
