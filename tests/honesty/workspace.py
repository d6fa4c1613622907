"""A case as a workspace, simulated as a user does."""

from __future__ import annotations

from pathlib import Path

from workspaces import written

from dse.domain.run import Run, RunRequest
from dse.loading.workspace import Workspace
from dse.testbench.runner import Runner
from dse.testbench.study import bench_study, prepare_study
from honesty.cases import C_MASS, MODELICA, STOP, Case
from honesty.parts import INPUTS, Part


def run_of(case: Case, folder: Path) -> Run:
    """The run of *case*, whose files are written into *folder*."""
    planned = prepare_study(bench_study(lay_out(case, folder).bench("bench")))
    ((identity, prepared),) = planned.benches.items()
    with Runner(prepared) as runner:
        return runner.run(RunRequest(0, identity, {}), keep=False)


def lay_out(case: Case, folder: Path) -> Workspace:
    """The workspace of *case*."""
    texts = {
        "components/interfaces.yaml": "interfaces:\n  part: {inputs: {u: 1}, outputs: {x: 1, v: 1}}\n"
        "  source: {outputs: {x: 1, v: 1}}\n",
        "designs/design.yaml": "design: design\nroot:\n  compound: {"
        + ", ".join(f"{place}: the_{place}" for place in case.parts)
        + "}\n"
        + (f"  connections: [{', '.join(case.connections)}]\n" if case.connections else ""),
        "testbenches/bench.yaml": "testbench: bench\ndesign: design\n"
        f"simulation: {{stop: {STOP} s, step: {case.step} s, check_step: true{case.settings}}}\n"
        "metrics: {end: final(part.x), most: maximum(part.x), mean: mean(part.x), rms: rms(part.x)}\n",
    }
    for place, part in case.parts.items():
        home = f"components/the_{place}"
        has_input = "input" in MODELICA.get(part.split()[1], "input") if isinstance(part, str) else part.model in INPUTS
        head = f"component: the_{place}\nimplements: {'part' if has_input else 'source'}\n"
        if isinstance(part, Part):
            (folder / home).mkdir(parents=True)
            file = part.build(folder / home)
            texts[f"{home}/component.yaml"] = f"{head}source: {{kind: fmu, file: {file.name}{part.says}}}\n"
        elif part.startswith("c "):
            head += "source: {kind: c, files: [plant.c], struct: plant}\nparameters: {k: {start: 1}}\n"
            text = C_MASS.replace("WAY", part[2:])
            texts |= {f"{home}/component.yaml": head, f"{home}/plant.h": text.split("#ifdef")[0]}
            texts[f"{home}/plant.c"] = '#include "plant.h"\n' + text.split("#ifdef BODY")[1].replace("#endif", "")
        else:
            _, model, tolerance = part.split()
            source = f"{{kind: modelica, files: [M.mo], model: M, tolerance: {tolerance}}}"
            texts[f"{home}/component.yaml"] = f"{head}source: {source}\nparameters: {{k: {{start: 1}}}}\n"
            texts[f"{home}/M.mo"] = f"model M {MODELICA[model]} end M;\n"
    return Workspace(written(folder, texts))
