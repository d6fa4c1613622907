"""Heavy packages are imported by the commands that need them, and by no other."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib import import_module

import pytest
import typer

from dse.cli.app import app
from dse.cli.commands import COMMANDS, register

# pydantic is not among them: typer imports it itself for every command that is run.
HEAVY = {"fmpy", "matplotlib", "networkx", "numpy", "pandas", "pint", "pyarrow", "ruamel.yaml", "scipy", "textual"} | {
    "starlette",
    "uvicorn",
}
SPACE = {"numpy"}
SEARCH = {"numpy", "scipy"}
RUNS = {"numpy", "pint", "pyarrow", "ruamel.yaml", "scipy"}
DRAWN = {*RUNS, "matplotlib"}

# What each command may import in a workspace that was read before; {s} is a study folder, {o} a new name.
MAY_IMPORT = {
    "--help": set(),
    "--version": set(),
    "space --help": set(),
    "init {o}": set(),
    "demo --help": set(),
    "init {o} --example fmus": {"fmpy", "numpy", "pint", "ruamel.yaml", "scipy"},
    "docs": set(),
    "udp --help": set(),
    "mcp --help": set(),
    "udp layout idm_acc": set(),
    "schema design": {"numpy", "pint", "ruamel.yaml", "scipy"},
    "list": {"numpy", "ruamel.yaml"},  # the first to read the benches
    "components": set(),
    "trust": {"numpy"},
    "components --graph {o}": set(),
    "enumerate acc_vehicle": SPACE,
    "enumerate acc_vehicle --count": SPACE,
    "enumerate acc_vehicle --format csv": SPACE,
    "enumerate acc_vehicle --sample 3": SPACE,
    "enumerate acc_vehicle -o {o}.parquet": {"numpy", "pandas", "pyarrow"},  # pyarrow.array asks for pandas
    "space count acc_vehicle": SPACE,
    "space constraints acc_vehicle": SEARCH,
    "space choices acc_vehicle": SPACE,
    "space conflict acc_vehicle": SEARCH,
    "space explain acc_vehicle --choose sensor=lidar_905nm": SEARCH,
    "space best acc_vehicle --minimize cost": SEARCH,
    "space pareto acc_vehicle --minimize cost --minimize mass": SEARCH,
    "space compare acc_vehicle acc_vehicle": SPACE,
    "space offer acc_vehicle": SPACE,
    "space offer acc_vehicle --choose sensor=lidar_905nm": SPACE,
    "space graph acc_vehicle": SPACE,
    "space refine acc_vehicle --choose sensor=lidar_905nm": {"numpy", "ruamel.yaml"},
    "export uvl acc_vehicle -o {o}.uvl": SPACE,
    "export csv acc_vehicle -o {o}.csv": SPACE,
    "world acc_following --layout": {"numpy", "pint", "ruamel.yaml", "scipy"},
    "results {s}": {"numpy"},
    "findings {s}": {"numpy", "pandas", "pint", "pyarrow", "ruamel.yaml", "scipy"},  # scikit-learn's pandas
    "best {s} --minimize consumption": RUNS,
    "pareto {s} --minimize consumption --minimize final_speed": RUNS,
    "refine {s} --around 0": RUNS,
    "status {s}": {"numpy"},
    "drives {o}": RUNS,
    "compare {s} {s}": {"numpy"},
    "compare-components pd_acc pi_time_gap_acc --tolerance 9": RUNS,
    "new component fresh -w {o}": {"pint"},
    "report {s} -o {o}.html": RUNS,
    "figure {s} -o {o}": DRAWN,
    "replay {s} 1": RUNS,
    "check": {"numpy", "pint", "ruamel.yaml", "scipy"},  # the first to read the benches
    "build pd_acc": set(),
    "probe {f}": {"numpy"},
    "cache show": set(),
    "cache verify": set(),
    "cache prune": set(),
    "import fmu {f} -o {o}": RUNS,
    "import simulink components/controllers/pd_acc_coded/acc_ert_rtw --step 10ms -o {o}": RUNS,
    "simulate acc_following": RUNS - {"pyarrow"},
    "run acc_following -o {o}": RUNS,
    "explore small -o {o}": RUNS,
}
SLOW = (
    "results",
    "findings",
    "best",
    "pareto",
    "refine",
    "status",
    "compare",
    "report",
    "figure",
    "replay",
    "check",
    "build",
    "probe",
    "import fmu",
    "import simulink",
    "simulate",
    "run",
    "explore",
)

pytestmark = pytest.mark.thorough
LOOK = f"""
import sys
from dse.cli import main
code = 0
try:
    main()
except SystemExit as end:
    code = end.code
print(code or 0, *sorted({HEAVY} & {{*sys.modules}}), file=sys.stderr)
"""


@pytest.fixture(scope="module")
def imported(example, cache):
    def imported(*arguments):
        environment = {**os.environ, "DSE_CACHE": str(cache)}
        command = [sys.executable, "-c", LOOK, *arguments]
        done = subprocess.run(command, cwd=example, env=environment, capture_output=True, text=True, check=True)
        code, *names = done.stderr.splitlines()[-1].split()
        return code, set(names), done.stderr

    imported("components")
    imported("enumerate", "acc_vehicle", "--count")
    return imported


@pytest.mark.parametrize(
    "command",
    [
        # Running every configuration imports what exploring a few does.
        pytest.param(line, marks=[pytest.mark.nightly if line.startswith("run ") else pytest.mark.thorough])
        if line.startswith(SLOW)
        else line
        for line in MAY_IMPORT
    ],
)
@pytest.mark.sampled(4)
def test_a_command_imports_what_it_needs(imported, tmp_path, request, command):
    words = {"o": tmp_path / "new"}
    if "{s}" in command:
        words["s"] = request.getfixturevalue("explored")
        imported("results", words["s"])  # remembers its units
    if "{f}" in command:
        dse = request.getfixturevalue("dse")
        words["f"] = dse("build", "pd_acc", "--output", str(tmp_path)).stdout and next(tmp_path.rglob("*.fmu"))
    code, names, said = imported(*command.format(**words).split(" "))
    assert code == "0", said
    assert names <= MAY_IMPORT[command]


def test_every_command_is_in_the_table():
    register()
    known = typer.main.get_command(app)
    lines = {
        f"{name} {below}" if hasattr(group, "commands") else name
        for name, group in known.commands.items()
        for below in getattr(group, "commands", [""])
    }
    # Most of these write into new folders what the others read: designs, packages, studies.
    assert {line for line in lines if not any(tried.startswith(line) for tried in MAY_IMPORT)} <= {
        "import uvl",
        "import scenario",
        "import ssp",
        "export mesh",
        "export opendrive",
        "export openscenario",
        "export ssp",
        "export trace",
        "merge",
        "rate",  # simulates for a minute; tests/docs/test_rating.py runs it
        "verify",  # as rate; tests/rating/test_verification.py runs it
        "serve",  # goes on for ever; tests/cli/test_serve.py starts it
        "new design",
        "new bench",
        "new road",
        "new study",
        "udp check",  # these three talk with somebody; tests/live has him
        "udp record",
        "udp show",
    }


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_is_found_without_the_others(name):
    assert import_module(f"dse.cli.commands.{name}")
    words = name.removesuffix("_").split(".")
    code = (
        "import sys; from dse.cli.commands import register\n"
        f"register({words!r})\n"
        "print(*[m.removeprefix('dse.cli.commands.') for m in sys.modules if m.startswith('dse.cli.commands.')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    found = done.stdout.split()
    assert name in found
    assert {*found} <= {name, name.partition(".")[0], "simulate"}  # whose settings `export` reads


def test_the_package_is_imported_at_once():
    code = "import sys; before = {*sys.modules}; import dse; print(*({*sys.modules} - before))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {name.partition(".")[0] for name in done.stdout.split()} & {*HEAVY, "pydantic", "rich", "typer"}


@pytest.mark.thorough
def test_a_worker_imports_what_simulating_needs():
    """Each run that is simulated alone, and each process of a study, waits for it."""
    names = "from dse.exploration.supervision import worker; from dse.testbench import make_runner"
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; {names}; print(*sys.modules)"], capture_output=True, text=True, check=True
    )
    unneeded = (HEAVY - {"numpy"}) | {
        "concurrent.futures",
        "dse.domain.study",
        "dse.loading",
        "psutil",
        "pydantic",
        "rich",
        "typer",
    }
    assert unneeded.isdisjoint(done.stdout.split())
