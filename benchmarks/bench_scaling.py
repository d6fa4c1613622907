"""How the cost of commands grows: CPU seconds at n, 2n, 4n and 8n, and the exponent p of cost = fixed + a·n^p.

``python benchmarks/bench_scaling.py [--quick] [--runs 2] [--only WORD]``; --quick takes about a minute: smaller n, and
of them n/16, 2n and 8n only. Exits with 1 if an exponent is above 1.2 and the table of cases gives no reason for it.

CPU seconds are those of the command and its children, and the least of some runs, as noise only adds. Each command runs
in a fork of a process that has imported what commands import, so that the fixed cost is small; byte code is warm, the
cache temporary and without answers. The fixed cost is that at n/16. From it, the exponent is taken over the last two
doublings: ``log4((cost(8n) - fixed) / (cost(2n) - fixed))``. A cost that grows by less than 0.1 s or a fifth of the
fixed cost is called flat. On a busy machine costs are uncertain by a tenth: an exponent counts as above 1.2
if it is so with the costs that are most in its favour, twice.
"""

from __future__ import annotations

import argparse
import atexit
import contextlib
import gc
import importlib
import math
import os
import resource
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bench_startup import INTERFACES, ROOT, workspace

LIMIT = 1.2
"""The exponent above which a cost needs a reason."""
DOUBT = 0.1

Files = Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Case:
    """Commands that run one after the other in a workspace of a size, with the same cache.

    *full* and *quick* are n; without *quick*, it is left out there.
    """

    name: str
    full: int
    quick: int
    write: Callable[[Path, int], None]
    commands: Mapping[str, str]
    reasons: Mapping[str, str] = field(default_factory=dict)
    """Why an exponent may be above the limit, by the name of the command."""


def written(root: Path, files: Files) -> None:
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def coded(name: str, members: str, step: str, *, more: str = "") -> dict[str, str]:
    """A component in C that is sampled each 10 ms."""
    here = f"components/{name}"
    return {
        f"{here}/component.yaml": f"component: {name}\nimplements: {name}\n"
        f"source: {{kind: c, files: [{name}.c], step: 10 ms}}\n{more}",
        f"{here}/{name}.h": f"#pragma once\ntypedef struct {{ {members} }} {name};\n"
        f"void {name}_init({name} *self);\nvoid {name}_step({name} *self);\n",
        f"{here}/{name}.c": f'#include "{name}.h"\nvoid {name}_step({name} *self) {{ {step} }}\n'
        f"void {name}_init({name} *self) {{ {name}_step(self); }}\n",
    }


def bench(parts: str, connections: str, record: str, *, stop: str = "1 s", more: str = "") -> dict[str, str]:
    """A design of one part, `sink`, and a bench for it."""
    return {
        "designs/one.yaml": "design: one\nroot: {compound: {sink: sink}}\n",
        "testbenches/see.yaml": f"testbench: see\ndesign: one\ntest_components: {{{parts}}}\n"
        f"connections: [{connections}]\nsimulation: {{stop: {stop}, step: 10 ms, record: [{record}]}}\n{more}",
    }


def ports(root: Path, n: int) -> None:
    """Two components in C with n single ports each, connected one by one."""
    names = [f"p{each}" for each in range(n)]
    kinds = ", ".join(f"{name}: m" for name in names)
    written(
        root,
        {
            "components/interfaces.yaml": f"interfaces:\n  give: {{outputs: {{{kinds}}}}}\n"
            f"  sink: {{inputs: {{{kinds}}}, outputs: {{y: m}}}}\n",
            **coded("give", f"struct {{ double {', '.join(names)}; }} out;", f"self->out.p{n - 1} += 1;"),
            **coded(
                "sink",
                f"struct {{ double {', '.join(names)}; }} in; struct {{ double y; }} out;",
                f"self->out.y = self->in.p{n - 1};",
            ),
            **bench("give: {component: give}", ", ".join(f"give.{name} -> sink.{name}" for name in names), "sink.y"),
        },
    )


def generated_ports(root: Path, n: int) -> None:
    """A model in the shape of Simulink's coder, with n inputs, and its source in C."""
    names = [f"p{each}" for each in range(n)]
    kinds = ", ".join(f"{name}: m" for name in names)
    inputs = "\n".join(f"  real_T {name};  /* '<Root>/{name}' */" for name in names)
    here = "components/sink"
    written(
        root,
        {
            "components/interfaces.yaml": f"interfaces:\n  give: {{outputs: {{{kinds}}}}}\n"
            f"  sink: {{inputs: {{{kinds}}}, outputs: {{y: m}}}}\n",
            **coded("give", f"struct {{ double {', '.join(names)}; }} out;", f"self->out.p{n - 1} += 1;"),
            f"{here}/component.yaml": "component: sink\nimplements: sink\n"
            "source: {kind: simulink, folder: sink_ert_rtw, step: 10 ms}\n",
            f"{here}/sink_ert_rtw/rtwtypes.h": "#ifndef RTWTYPES_H\n#define RTWTYPES_H\ntypedef double real_T;\n"
            "typedef char char_T;\n#endif\n",
            f"{here}/sink_ert_rtw/sink.h": "/*\n * Code generated for Simulink model 'sink'.\n */\n"
            '#ifndef RTW_HEADER_sink_h_\n#define RTW_HEADER_sink_h_\n#include "rtwtypes.h"\n'
            f"typedef struct {{\n{inputs}\n}} ExtU_sink_T;\n"
            "typedef struct {\n  real_T y;  /* '<Root>/y' */\n} ExtY_sink_T;\n"
            "extern ExtU_sink_T sink_U;\nextern ExtY_sink_T sink_Y;\n"
            "extern void sink_initialize(void);\nextern void sink_step(void);\n"
            "extern void sink_terminate(void);\n#endif\n",
            f"{here}/sink_ert_rtw/sink.c": "/*\n * Code generated for Simulink model 'sink'.\n */\n"
            '#include "sink.h"\nExtU_sink_T sink_U;\nExtY_sink_T sink_Y;\n'
            f"void sink_step(void)\n{{\n  sink_Y.y = sink_U.p{n - 1};\n}}\n"
            "void sink_initialize(void)\n{\n}\nvoid sink_terminate(void)\n{\n}\n",
            **bench("give: {component: give}", ", ".join(f"give.{name} -> sink.{name}" for name in names), "sink.y"),
        },
    )


def values(root: Path, n: int) -> None:
    """Two components in C that exchange one array of n values, all recorded."""
    written(
        root,
        {
            "components/interfaces.yaml": f'interfaces:\n  give: {{outputs: {{v: "m[{n}]"}}}}\n'
            f'  sink: {{inputs: {{v: "m[{n}]"}}, outputs: {{y: m}}}}\n',
            **coded("give", f"struct {{ double v[{n}]; }} out;", f"self->out.v[{n - 1}] += 1;"),
            **coded(
                "sink",
                f"struct {{ double v[{n}]; }} in; struct {{ double y; }} out;",
                f"self->out.y = self->in.v[{n - 1}];",
            ),
            **bench(
                "give: {component: give}", "give.v -> sink.v", "give.v", more=f'metrics: {{m: "final(give.v[{n}])"}}\n'
            ),
        },
    )


SINK = {
    "components/interfaces.yaml": "interfaces:\n  sink: {inputs: {u: m}, outputs: {y: m}}\n",
    **coded(
        "sink",
        "struct { double u; } in; struct { double y; } out; struct { double k, l, m; } par;",
        "self->out.y += 0.01 * (self->par.k * self->in.u - self->par.l * self->out.y) + 0 * self->par.m;",
        more="parameters: {k: {start: 1}, l: {start: 1}, m: {start: 1}}\nproperties: {cost: 1 EUR}\n",
    ),
}
METRIC = "metrics: {end: final(sink.y)}\nrequirements: {R1: {metric: end, at_most: 0.2 m}}\n"


def parts(root: Path, n: int) -> None:
    """A chain of n components on a bench."""
    names = ", ".join(f"t{each}: {{component: sink}}" for each in range(n))
    links = [f"t{each}.y -> t{each + 1}.u" for each in range(n - 1)] + [f"t{n - 1}.y -> sink.u"]
    written(root, {**SINK, **bench(names, ", ".join(links), "sink.y", more="parameters: {t0.u: 1 m}\n")})


def library(root: Path, n: int) -> None:
    """A component library of n components in one file, all of them alternatives of a design."""
    root.rmdir()
    workspace(root, max(n, INTERFACES), collected=True)


def folders(root: Path, n: int) -> None:
    """The same with a file for each component."""
    root.rmdir()
    workspace(root, max(n, INTERFACES), collected=False)


def steps(root: Path, n: int) -> None:
    """A run of n steps, all recorded."""
    more = METRIC + "parameters: {sink.u: 1 m}\n"
    written(root, {**SINK, **bench("", "", "sink.y", stop=f"{n * 10} ms", more=more)})


def study(root: Path, sampler: str) -> None:
    """Three variables, in runs of ten steps."""
    variables = ", ".join(f"sink.{name}: {{range: [0, 2]}}" for name in "klm")
    text = f"study: all\ntestbench: see\ndesign_variables: {{{variables}}}\nsampler: {sampler}\nkeep_waveforms: none\n"
    more = METRIC + "parameters: {sink.u: 1 m}\n"
    written(root, {**SINK, **bench("", "", "sink.y", stop="100 ms", more=more), "testbenches/all.pet.yaml": text})


def rows(root: Path, n: int) -> None:
    """A study of n runs."""
    study(root, f"{{latin_hypercube: {{samples: {n}}}}}")


def candidates(root: Path, n: int) -> None:
    """A study of n points that is only planned."""
    study(root, f"{{halton: {{samples: {n}}}}}")


def choices(root: Path, n: int) -> None:
    """A design with n valid configurations, of components without a source."""
    places = [[f"c{place}_{each}" for each in range(size)] for place, size in enumerate((10, 10, max(1, n // 100)))]
    parts = "".join(f"  {name}: {{properties: {{cost: 1 EUR}}}}\n" for names in places for name in names)
    tree = ", ".join(f"p{place}: {{alternatives: [{', '.join(names)}]}}" for place, names in enumerate(places))
    rule = "constraints: {low: {require: sum(cost) <= 3 EUR}}\n"
    design = f"design: many\nroot: {{compound: {{{tree}}}}}\n{rule}"
    written(root, {"components/parts.yaml": f"components:\n{parts}", "designs/many.yaml": design})


def configurations(root: Path, n: int) -> None:
    """A design of 2^12 configurations of one component in C, and studies of n of them."""
    places = [f"p{place}" for place in range(12)]
    tree = ", ".join(f"{place}: {{optional: sink}}" for place in places)
    inputs = ", ".join(f"{place}.u: 1 m" for place in (*places, "last"))
    study = "testbench: all\nkeep_waveforms: none\ndesign_variables: {last.l: {range: [0, 2]}}\n"
    goals = f"sampler: {{nsga2: {{evaluations: {n}}}}}\nobjectives: [minimize end, minimize sum(cost)]\n"
    files = {
        "designs/many.yaml": f"design: many\nroot: {{compound: {{{tree}, last: sink}}}}\n",
        "testbenches/all.yaml": f"testbench: all\ndesign: many\nparameters: {{{inputs}}}\n"
        "simulation: {stop: 100 ms, step: 10 ms, record: [last.y]}\nmetrics: {end: final(last.y)}\n"
        "requirements: {R1: {metric: end, at_most: 0.2 m}}\n",
        "testbenches/some.pet.yaml": f"study: some\n{study}sampler: {{uniform: {{configurations: {n}}}}}\n",
        "testbenches/best.pet.yaml": f"study: best\n{study}{goals}",
    }
    written(root, {**SINK, **files})


SAMPLED = {"explore": "explore {0} -o out -j 1", "resume": "explore {0} -o out -j 1"}
ASKED = {"results": "results out -o out.csv", "findings": "findings out", "report": "report out --waveforms 0"}
BUILT = {"check": "check", "simulate": "simulate see", "simulate again": "simulate see"}

CASES = (
    Case("ports", 1000, 500, ports, BUILT),
    Case("ports of generated code", 500, 250, generated_ports, BUILT),
    Case("values of an array", 1000, 500, values, BUILT),
    Case("parts of a bench", 100, 25, parts, BUILT),
    Case("components in one file", 1250, 500, library, {"check": "check", "check again": "check"}),
    Case("components in files", 1250, 0, folders, {"check": "check", "check again": "check"}),
    Case("steps", 50_000, 25_000, steps, {"simulate": "simulate see", "to a file": "simulate see -o out.csv"}),
    Case("rows", 2500, 500, rows, {each: text.format("all") for each, text in (SAMPLED | ASKED).items()}),
    Case("candidates", 25_000, 5_000, candidates, {"explore --dry-run": "explore all --dry-run"}),
    Case("valid configurations", 25_000, 5_000, choices, {"enumerate": "enumerate many -o out.csv"}),
    Case(
        "configurations of a study",
        100,
        25,
        configurations,
        {each: text.format("some") for each, text in (SAMPLED | ASKED).items()},
    ),
    Case("proposed designs", 100, 0, configurations, {each: text.format("best") for each, text in SAMPLED.items()}),
)


def cost(folder: Path, arguments: str, modules: Path | None = None) -> tuple[float, float]:
    """CPU seconds of the command in *folder*, children included, and MB that its process takes at most.

    Writes the names of the modules that are imported at its end to *modules*.
    """
    child = os.fork()
    if not child:
        os.chdir(folder)
        output = os.open(folder / "output", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(output, 1)
        os.dup2(output, 2)
        sys.argv = ["dse", *arguments.split()]
        code = 99
        try:
            from dse.cli.entry import run

            run()
        except SystemExit as end:
            code = int(end.code or 0)
        finally:
            if modules:
                modules.write_text("\n".join(sys.modules))
            atexit._run_exitfuncs()  # noqa: SLF001  # parsed documents are kept then
            os._exit(code)
    _, status, used = os.wait4(child, 0)
    if status:
        said = (folder / "output").read_text()
        sys.exit(f"dse {arguments}: exit code {os.waitstatus_to_exitcode(status)}\n{said}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1e3


def import_what_commands_import(folder: Path, cases: Sequence[Case]) -> None:
    """Import in this process what the commands of *cases* import, which also compiles it."""
    names = folder / "modules"
    for case in cases:
        root = folder / case.name
        root.mkdir()
        case.write(root, sizes(case, quick=bool(case.quick))[0])
        for command in case.commands.values():
            cost(root, command, names)
            for name in names.read_text().splitlines():
                with contextlib.suppress(ImportError):
                    importlib.import_module(name)


def sizes(case: Case, *, quick: bool) -> list[int]:
    """Those that are measured, the one for the fixed cost first."""
    n = case.quick if quick else case.full
    return [max(1, n // 16), *([2 * n, 8 * n] if quick else [n, 2 * n, 4 * n, 8 * n])]


def exponent(fixed: float, second: float, last: float) -> float | None:
    """The exponent of the costs at n/16, 2n and 8n; None if they are flat."""
    if last - fixed < max(0.1, fixed / 5):
        return None
    return math.log((last - fixed) / max(second - fixed, 1e-3), 4)


def is_above(fixed: float, second: float, last: float) -> bool:
    """Whether the exponent is above the limit beyond doubt."""
    least = exponent(fixed, second * (1 + DOUBT), last * (1 - DOUBT))
    return least is not None and least > LIMIT


def measured(case: Case, folder: Path, size: int) -> dict[str, tuple[float, float]]:
    """CPU seconds and MB of each command of *case*, in an empty *folder*."""
    root = folder / "workspace"
    root.mkdir(parents=True)
    case.write(root, size)
    os.environ["DSE_CACHE"] = str(folder / "cache")
    return {name: cost(root, command) for name, command in case.commands.items()}


def least(case: Case, folder: Path, *, quick: bool, runs: int) -> Iterator[tuple[str, list[float], float, bool]]:
    """Each command of *case*: its name, the least CPU seconds at each size, MB at the largest, and whether it is above.

    Beyond *runs*, once more if there is something above.
    """
    costs: dict[str, list[float]] = {}
    above: set[str] = set()
    for run in range(runs + 1):
        if run == runs and not above:
            break
        found = [measured(case, folder / f"{case.name} {size} {run}", size) for size in sizes(case, quick=quick)]
        for name in case.commands:
            now = [each[name][0] for each in found]
            costs[name] = list(map(min, now, costs.get(name, now)))
        above = {name for name, each in costs.items() if is_above(each[0], each[-2 if quick else -3], each[-1])}
    for name, each in costs.items():
        yield name, each, found[-1][name][1], name in above


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--only", default="", metavar="WORD", help="only cases with this in their name")
    options = parser.parse_args()
    os.environ |= {"DSE_ANSWERS": "0", "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False
    above = []
    folder = Path(tempfile.mkdtemp())  # the other way, the first command that ends would delete it
    try:
        os.environ["DSE_CACHE"] = str(folder / "cache")
        cases = [case for case in CASES if options.only in case.name and (case.quick or not options.quick)]
        import_what_commands_import(folder, cases)
        gc.freeze()
        heads = "".join(
            f"{head:>8}" for head in (["n/16", "2n", "8n"] if options.quick else ["n/16", "n", "2n", "4n", "8n"])
        )
        print(f"{'CPU seconds':42}{heads}{'8n =':>10}{'MB':>6}  exponent")
        for case in cases:
            for name, costs, memory, is_over in least(case, folder, quick=options.quick, runs=options.runs):
                p = exponent(costs[0], costs[-2 if options.quick else -3], costs[-1])
                reason = case.reasons.get(name, "no reason") if is_over else ""
                above += [f"{case.name}, {name}"] if reason == "no reason" else []
                numbers = "".join(f"{each:8.2f}" for each in costs)
                size = sizes(case, quick=options.quick)[-1]
                shown = "flat" if p is None else f"{p:.2f}"
                print(f"{f'{case.name}, {name}':42}{numbers}{size:10,}{memory:6.0f}{shown:>10}  {reason}", flush=True)
    finally:
        shutil.rmtree(folder)
    own = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{own.ru_utime + own.ru_stime:.0f} CPU seconds in all")
    if above:
        sys.exit("exponents above 1.2 without a reason: " + "; ".join(above))


if __name__ == "__main__":
    main()
