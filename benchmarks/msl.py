"""The Modelica Standard Library against its published reference results: one line a package, and what is not right.

`make msl MODELICA=folder REFERENCES=folder`: the folders of a release of the library (`Modelica/package.mo`) and of the
release's results (https://github.com/modelica/MAP-LIB_ReferenceResults). Neither is part of dse.

A model is right if each signal that `comparisonSignals.txt` names stays in a tube around the reference: 0.2 % of the
time wide to both sides, and 0.2 % of the signal's range, at least 1e-6, high. That is the tube of the library's own
comparisons. *Right by the second opinion*: dse refuses it or cannot solve it, and rumoca's own solver is in the tube.

With `--library NAME`, the examples of another library in the first folder, for which there are no reference results:
models that are not partial, and that no model of the library has as a component. The reference is then rumoca's own
solver, for each variable that both have. *Not compared*: that solver cannot do what dse solved.
"""

from __future__ import annotations

import argparse
import csv
import json
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

PACKAGES = (
    "Blocks",
    "Mechanics.Rotational",
    "Mechanics.Translational",
    "Electrical.Analog",
    "Thermal.HeatTransfer",
    "StateGraph",
)
VERDICTS = ("right", "second", "refused", "failed", "wrong", "alone")
SECONDS = 120
"""Of processor time for a model; more counts as failed."""
POINTS, MOST_POINTS = 500, 2000
STEPS = 1499
"""Without reference results: a prime, so that points are not at ticks, where one solver may be before the jump."""
TUBE, FLOOR = 0.002, 1e-6

Signals = Mapping[str, NDArray[np.float64]]


def main() -> int:
    """Compare all models, or the one of `--one`."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("modelica", type=Path)
    parser.add_argument("references", type=Path, nargs="?", default=Path())
    parser.add_argument("--library", default="", help="examples of this library, with rumoca's solver as reference")
    parser.add_argument("--only", default="", help="a regular expression of the models' names")
    parser.add_argument("--every", type=int, default=1, help="only each n-th model")
    parser.add_argument("--one", default="", help=argparse.SUPPRESS)
    parser.add_argument("--engine", default="dse", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one and given.library:
        print(json.dumps(_other(given.one, given.modelica, given.references, given.engine)))
        return 0
    needed = ((given.modelica / "Modelica", "library"), (given.references / "Modelica", "reference results"))
    for folder, of in needed[: 1 if given.library else 2]:
        if not folder.is_dir():
            print(f"there is no folder {folder}: fetch the {of} and name the folder that contains it")
            return 1
    if given.one:
        print(json.dumps(_one(given.one, given.modelica, given.references, given.engine)))
        return 0
    if given.library:
        every = _examples(given.modelica / given.library)
        results = {}
        for name in [name for name in every if re.search(given.only, name)][:: given.every]:
            with tempfile.TemporaryDirectory() as folder:
                results[name] = _judged(name, given.modelica, Path(folder), given.library)
        _print_table(results, (given.library,))
        return int(any(result["verdict"] == "wrong" for result in results.values()))
    models = [name for name in _models(given.references) if re.search(given.only, name)][:: given.every]
    results = {name: _judged(name, given.modelica, given.references) for name in models}
    _print_table(results, tuple(f"Modelica.{package}" for package in PACKAGES))
    return int(any(result["verdict"] == "wrong" for result in results.values()))


def _models(references: Path) -> Iterator[str]:
    for package in PACKAGES:
        for listed in sorted((references / "Modelica" / package.replace(".", "/")).rglob("comparisonSignals.txt")):
            if (listed.parent / f"{listed.parent.name}.csv").is_file():
                yield ".".join(listed.parent.relative_to(references).parts)


def _examples(library: Path) -> list[str]:
    """The models of a library that are not partial, nor components of another, nor in one."""
    from dse.modelica.frontend.source_text import SourceText, code
    from dse.modelica.frontend.syntax import KINDS, Forest

    files = sorted(library.rglob("*.mo"))
    texts = [SourceText(str(file), code(file.read_text(encoding="utf-8-sig"))) for file in files]
    declared = re.compile(r"(?<!end )(?<!extends )(?<!extends\n)(?<![\w.])(?:\w+\.)*(\w+)\s+\w+\s*[\[(;\"=,)]")
    types = {word for text in texts for word in declared.findall(text.text)}
    models = [
        own.full
        for own in Forest(texts).elements
        if own.kind == "model" and not own.is_argument and "partial" not in own.prefixes and own.name not in types
        if own.parent is None or own.parent.kind not in KINDS or own.parent.kind == "package"
    ]
    return sorted(models)


def _other(name: str, modelica: Path, scratch: Path, engine: str) -> dict[str, Any]:
    """A model without reference results, by dse and then by rumoca, which leaves its signals in *scratch*."""
    from dse.modelica.frontend.buses import with_members
    from dse.modelica.frontend.other_words import with_variables
    from dse.modelica.frontend.redeclarations import with_redeclarations
    from dse.modelica.frontend.sources import LIBRARIES, read_sources

    if engine == "dse":
        sources = read_sources("model", name, [], [modelica])
        parts = with_variables(with_members(with_redeclarations(name, sources.parts)))
        replace(sources, parts=parts).lay_out_parts(scratch)
        modelica = scratch / LIBRARIES
    declared = re.compile(rb"\bmodel\s+" + name.rpartition(".")[2].encode() + rb"\b")
    texts = [file.read_bytes() for file in sorted(modelica.rglob("*.mo"))]
    own = next((text for text in texts if declared.search(text)), b"")
    stop = re.search(rb"\bStopTime\s*=\s*([\d.eE+-]+)", own)
    times = np.linspace(0, float(stop[1]) if stop else 10.0, STEPS + 1)
    found = (_run_dse if engine == "dse" else _run_rumoca)(name, modelica, None, times)
    if "signals" not in found:
        return found
    signals: Signals = found.pop("signals")
    if engine == "rumoca":
        np.savez(scratch / "signals.npz", **signals)  # type: ignore[arg-type]  # its stubs
        return {"verdict": "right", "said": ""}
    second = _asked(name, modelica, scratch, "rumoca", "any")
    if second["verdict"] != "right":
        return {**found, "verdict": "alone", "said": second["said"]}
    reference = np.load(scratch / "signals.npz")
    both = sorted(set(signals) & set(reference.files))
    outside = [signal for signal in both if not _is_inside(times, signals[signal], times, reference[signal])]
    verdict = "wrong" if outside else "right" if both else "alone"
    return {**found, "verdict": verdict, "said": ", ".join(outside)}


def _judged(name: str, modelica: Path, references: Path, library: str = "") -> dict[str, Any]:
    result = _asked(name, modelica, references, "dse", library)
    if result["verdict"] in ("refused", "failed") and not library:
        second = _asked(name, modelica, references, "rumoca")
        result["second"] = second["said"] or second["verdict"]
        if second["verdict"] == "right":
            result["verdict"] = "second"
    said = re.sub(r"\s+", " ", result["said"])[:300]
    spent = f"build {result.get('build', 0):.1f} s, step {result.get('step', 0):.1f} us"
    print(f"{result['verdict']:8} {name}: {spent} {said}", flush=True)
    return result


def _asked(name: str, modelica: Path, references: Path, engine: str, library: str = "") -> dict[str, Any]:
    """The answer of a process of its own, which may crash or not end."""
    command = [sys.executable, __file__, str(modelica), str(references), "--one", name, "--engine", engine]
    command += ["--library", library]
    limited = ["bash", "-c", f'ulimit -t {SECONDS}; exec "$@"', "msl", *command]
    answer = subprocess.run(limited, capture_output=True, text=True, check=False)
    try:
        return dict(json.loads(answer.stdout.splitlines()[-1]))
    except (IndexError, ValueError):
        last = (answer.stderr.strip().splitlines() or [f"more than {SECONDS} s, or a crash"])[-1]
        return {"verdict": "failed", "said": last}


def _one(name: str, modelica: Path, references: Path, engine: str) -> dict[str, Any]:
    folder = references / name.replace(".", "/")
    wanted = [line for line in (folder / "comparisonSignals.txt").read_text().split() if line != "time"]
    with (folder / f"{folder.name}.csv").open(encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    table = np.array(rows, dtype=float).T
    reference = dict(zip(head, table, strict=True))
    # At instants of the reference: between them, noise is not what is interpolated.
    times = np.unique(table[0])
    is_fine = len(times) > POINTS
    times = times[:: -(-len(times) // MOST_POINTS)] if is_fine else np.linspace(times[0], times[-1], POINTS + 1)
    run = _run_dse if engine == "dse" else _run_rumoca
    found = run(name, modelica, [signal for signal in wanted if signal in reference], times)
    if "signals" not in found:
        return found
    signals: Signals = found.pop("signals")
    outside = [signal for signal in signals if not _is_inside(times, signals[signal], table[0], reference[signal])]
    missing = [signal for signal in wanted if signal in reference and signal not in signals]
    if missing:
        return {**found, "verdict": "failed", "said": f"no signals {', '.join(missing)}"}
    return {**found, "verdict": "wrong" if outside else "right", "said": ", ".join(outside)}


def _run_dse(name: str, modelica: Path, wanted: Sequence[str] | None, times: NDArray[np.float64]) -> dict[str, Any]:
    from fmpy import read_model_description
    from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

    from dse.domain.component import NO_INTERFACE, Component, ModelicaSource
    from dse.errors import DseError
    from dse.fmu.component_build import build
    from dse.fmu.unpack import open_fmu

    component = Component("model", NO_INTERFACE, source=ModelicaSource(name, (), (modelica,)))
    with tempfile.TemporaryDirectory() as cache:
        begun = _processor_time()
        try:
            model = open_fmu(build(component, version=2, cache=Path(cache)), cache=Path(cache))
        except DseError as error:
            return {"verdict": "refused", "said": str(error), "build": _processor_time() - begun}
        spent = {"build": _processor_time() - begun}
        known = {v.name: v for v in read_model_description(str(model.folder)).modelVariables}
        messages: list[str] = []
        logger = fmi2CallbackLoggerTYPE(lambda *given: messages.append(str(given[-1])))
        slave = FMU2Slave(
            guid=model.token, unzipDirectory=str(model.folder), modelIdentifier=model.identifier, instanceName="m"
        )
        callbacks = fmi2CallbackFunctions(logger=logger)
        slave.instantiate(callbacks=callbacks)
        names = [signal for signal in wanted if signal in known] if wanted is not None else _changing(known)
        found = np.zeros((len(names), len(times)))

        def read(k: int) -> None:
            for row, signal in enumerate(names):
                variable = known[signal]
                reader = getattr(slave, f"get{'Integer' if variable.type == 'Enumeration' else variable.type}")
                found[row, k] = reader([variable.valueReference])[0]

        k, steps = 0, []
        try:
            slave.setupExperiment(tolerance=None, startTime=times[0])
            slave.enterInitializationMode()
            slave.exitInitializationMode()
            read(0)
            for k in range(1, len(times)):
                begun = time.perf_counter()
                slave.doStep(times[k - 1], times[k] - times[k - 1])
                steps.append(time.perf_counter() - begun)
                read(k)
        except Exception as error:  # noqa: BLE001  # FMPy raises nothing narrower
            said = messages[-1] if messages else str(error)
            return {**spent, "verdict": "failed", "said": f"at {times[max(k - 1, 0)]:g} s: {said}"}
        spent["step"] = float(np.median(steps)) * 1e6  # not disturbed by other processes
        return {**spent, "signals": dict(zip(names, found, strict=True))}


def _changing(known: Mapping[str, Any]) -> list[str]:
    return [name for name, v in known.items() if v.causality in ("output", "local") and v.type != "String"]


def _processor_time() -> float:
    import resource

    spent = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in spent)


def _run_rumoca(name: str, modelica: Path, wanted: Sequence[str] | None, times: NDArray[np.float64]) -> dict[str, Any]:
    import rumoca

    from dse.modelica.frontend.sources import read_sources

    with tempfile.TemporaryDirectory() as folder:
        read_sources("model", name, [], [modelica]).lay_out_parts(Path(folder))
        text = f"model Whole extends {name}; end Whole;"
        try:
            model = rumoca.Session([f"{folder}/libraries"]).loads(text, model="Whole", filename="whole.mo")
            result = model.simulate((times[0], times[-1]), dt=times[1] - times[0])
            at = np.asarray(result.time)
            signals = {
                signal: np.interp(times, at, np.asarray(result[signal], dtype=float))
                for signal in (result.names if wanted is None else wanted)
                if signal in result.names
            }
        except BaseException as error:  # noqa: BLE001  # a panic is no Exception
            return {"verdict": "failed", "said": str(error)[:300]}
    return {"signals": signals}


def _is_inside(
    times: NDArray[np.float64], signal: NDArray[np.float64], at: NDArray[np.float64], reference: NDArray[np.float64]
) -> bool:
    """Whether *signal* stays in the tube around *reference*, which has two values where it jumps."""
    width = TUBE * (times[-1] - times[0])
    height = max(TUBE * (reference.max() - reference.min()), FLOOR, FLOOR * np.abs(reference).max())
    for t, value in zip(times, signal, strict=True):
        near = reference[np.searchsorted(at, t - width, "left") : np.searchsorted(at, t + width, "right")]
        ends = np.interp([max(t - width, at[0]), min(t + width, at[-1])], at, reference)
        low, high = min(ends.min(), *near, ends.min()), max(ends.max(), *near, ends.max())
        if not low - height <= value <= high + height:
            return False
    return True


def _print_table(results: Mapping[str, Mapping[str, Any]], packages: Sequence[str]) -> None:
    print("\n| Package | Models | Right | Right by the second opinion | Refused | Not solved | Wrong | Not compared |")
    print("|---|---|---|---|---|---|---|---|")
    rows = {package: [v for n, v in results.items() if n.startswith(f"{package}.")] for package in packages}
    for package, found in {**rows, "all": list(results.values())}.items():
        counts = [sum(each["verdict"] == verdict for each in found) for verdict in VERDICTS]
        print(f"| {package} | {len(found)} | {' | '.join(map(str, counts))} |")


if __name__ == "__main__":
    sys.exit(main())
