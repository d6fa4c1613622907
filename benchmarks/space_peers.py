"""The same design spaces in other people's solvers: OR-tools CP-SAT, clingo, and Gecode's FlatZinc interpreter."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from dse.space.flat import FlatSpace, Linear, Table


@dataclass(frozen=True, slots=True)
class Figures:
    """Seconds to the first configuration, None if there was none in time; configurations per second after that."""

    first: float | None
    rate: float


def peers() -> dict[str, Callable[[FlatSpace, float], Figures]]:
    """The solvers that are installed here."""
    found: dict[str, Callable[[FlatSpace, float], Figures]] = {}
    try:
        import ortools  # noqa: F401  # whether it is there

        found["CP-SAT"] = cp_sat
    except ImportError:
        pass
    try:
        import clingo  # noqa: F401  # whether it is there

        found["clingo"] = asp
    except ImportError:
        pass
    if shutil.which("fzn-gecode"):
        found["Gecode"] = gecode
    return found


def forbidden(flat: FlatSpace) -> Iterator[tuple[tuple[int, int], ...]]:
    """Every combination of (variable, value) that hierarchy and tables forbid; the last value is 'absent'."""
    for number, variable in enumerate(flat.variables):
        last = len(variable.values)
        if variable.parent is None:
            yield ((number, last),)
            continue
        parent, chosen = variable.parent
        for value in range(len(flat.variables[parent].values) + 1):
            if value == chosen:
                yield ((parent, value), (number, last))
            else:
                yield from (((parent, value), (number, own)) for own in range(last))
    for rule in flat.rules:
        if isinstance(rule, Table):
            for cell in np.argwhere(~rule.allowed).tolist():
                yield tuple(zip(rule.scope, cell, strict=True))
        elif not isinstance(rule, Linear):
            raise TypeError("the peers are given tables and sums only")


def cp_sat(flat: FlatSpace, seconds: float) -> Figures:
    """All solutions of a CP-SAT model, on one worker."""
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    taken = [[model.new_bool_var("") for _ in range(len(v.values) + 1)] for v in flat.variables]
    for values in taken:
        model.add_exactly_one(values)
    for cells in forbidden(flat):
        model.add_bool_or([taken[variable][value].negated() for variable, value in cells])
    for rule in flat.linears():
        terms = sum(int(w) * taken[i][a] for i, ws in rule.weights.items() for a, w in enumerate(ws) if w)
        if rule.high is not None:
            model.add(terms <= rule.high)
        if rule.low is not None:
            model.add(terms >= rule.low)

    class Counter(cp_model.CpSolverSolutionCallback):
        def __init__(self) -> None:
            super().__init__()
            self.times: list[float] = []

        def on_solution_callback(self) -> None:
            self.times.append(time.perf_counter())

    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.enumerate_all_solutions = True
    solver.parameters.max_time_in_seconds = seconds
    counter = Counter()
    start = time.perf_counter()
    solver.solve(model, counter)
    return _figures(start, counter.times)


def asp(flat: FlatSpace, seconds: float) -> Figures:
    """All answer sets of a clingo program."""
    import clingo

    lines = [f"1 {{ x({i},0..{len(v.values)}) }} 1." for i, v in enumerate(flat.variables)]
    lines += [":- " + ", ".join(f"x({i},{a})" for i, a in cells) + "." for cells in forbidden(flat)]
    for rule in flat.linears():
        terms = "; ".join(f"{w},{i},{a}: x({i},{a})" for i, ws in rule.weights.items() for a, w in enumerate(ws) if w)
        if rule.high is not None:
            lines.append(f":- #sum {{ {terms} }} > {rule.high}.")
        if rule.low is not None:
            lines.append(f":- #sum {{ {terms} }} < {rule.low}.")
    control = clingo.Control(["0", "--warn=none"])
    start = time.perf_counter()
    control.add("base", [], "\n".join(lines))
    control.ground([("base", [])])
    times: list[float] = []
    with control.solve(yield_=True, async_=True) as handle:
        while time.perf_counter() - start < seconds:
            handle.resume()
            if not handle.wait(max(0.0, seconds - (time.perf_counter() - start))):
                break
            if handle.model() is None:
                break
            times.append(time.perf_counter())
        handle.cancel()
    return _figures(start, times)


def gecode(flat: FlatSpace, seconds: float) -> Figures:
    """All solutions of a FlatZinc model in fzn-gecode."""
    lines, rules = [], []
    for i, v in enumerate(flat.variables):
        lines.append(f"var 0..{len(v.values)}: x{i} :: output_var;")
    for scope in sorted({tuple(variable for variable, _ in cells) for cells in forbidden(flat)}):
        bad = {tuple(a for _, a in cells) for cells in forbidden(flat) if tuple(i for i, _ in cells) == scope}
        sizes = [range(len(flat.variables[i].values) + 1) for i in scope]
        good = [cell for cell in product(*sizes) if cell not in bad]
        flattened = ",".join(str(a) for cell in good for a in cell)
        rules.append(f"constraint gecode_table_int([{','.join(f'x{i}' for i in scope)}],[{flattened}]);")
    for number, rule in enumerate(flat.linears()):
        names = []
        for i, ws in rule.weights.items():
            name = f"w{number}_{i}"
            lines.append(f"var {ws.min()}..{ws.max()}: {name};")
            # Elements count from 1.
            shifted = f"y{i}"
            if not any(line.endswith(f": {shifted};") for line in lines):
                lines.append(f"var 1..{len(ws)}: {shifted};")
                rules.append(f"constraint int_lin_eq([1,-1],[{shifted},x{i}],1);")
            rules.append(f"constraint array_int_element({shifted},[{','.join(map(str, ws.tolist()))}],{name});")
            names.append(name)
        for bound, sign in ((rule.high, 1), (rule.low, -1)):
            if bound is not None:
                signs = ",".join([str(sign)] * len(names))
                rules.append(f"constraint int_lin_le([{signs}],[{','.join(names)}],{sign * bound});")
    variables = ",".join(f"x{i}" for i in range(len(flat.variables)))
    solve = f"solve :: int_search([{variables}],first_fail,indomain_min,complete) satisfy;"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "space.fzn"
        path.write_text("\n".join([*lines, *rules, solve]) + "\n", encoding="utf-8")
        start = time.perf_counter()
        command = ["fzn-gecode", "-a", "-time", str(round(1000 * seconds)), str(path)]
        times: list[float] = []
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, bufsize=1 << 16) as process:
            assert process.stdout is not None
            times = [time.perf_counter() for line in process.stdout if line.startswith("-----")]
    return _figures(start, times)


def _figures(start: float, times: list[float]) -> Figures:
    if not times:
        return Figures(None, 0.0)
    return Figures(times[0] - start, len(times) / (times[-1] - start))
