"""Arrays, functions, operators, types and parameters: values that follow from the file by hand."""

from __future__ import annotations

import math

import numpy as np
from language_case import Cases, Given, Steps, Values
from scipy.linalg import expm

CASES = Cases()
case = CASES.case

EXACT = 1e-14


@case("ForEquations", given={"u": 1.5}, variants=({"u": -2.0},), stop=0.14, error=EXACT)
def for_equations(t: float, given: Given) -> Values:
    rows = [sum(given["u"] * i / j for j in range(1, i + 1)) for i in range(1, 5)]
    return {"total": rows[0] + rows[2]}


@case("MatrixStateSpace", given={"u": 3.0, "A[2,1]": -4.0, "D[1,1]": 0.25}, variants=({"A[2,1]": -9.0, "D[1,1]": 0.0},))
def matrix_state_space(t: float, given: Given) -> Values:
    a, b = np.array([[0, 1], [given["A[2,1]"], -0.4]]), np.array([0.0, 2.0])
    rest = np.linalg.solve(a, -b * given["u"])
    x = rest + expm(a * t) @ (np.array([1.0, -1.0]) - rest)
    return {"y": x[0] + 0.5 * x[1] + given["D[1,1]"] * given["u"]}


@case("MatrixAlgebra", given={"u": 2.0}, variants=({"u": 0.5},), stop=0.14, error=EXACT)
def matrix_algebra(t: float, given: Given) -> Values:
    u, a = given["u"], np.array([[1.0, 2, 3], [4, 5, 6]])
    p = a @ a.T - u * np.eye(2)
    e = a * a / (a + u) - 1
    c = np.cross([1, u, 3], [u, -1, 0.5])
    return {
        "y": [
            p[0, 1] + p[1, 1],
            e[1, 2],
            c @ [1, 2, 3],
            np.sum(np.outer([1, u], [3, 4, 5])),
            4 + 5 * u + 3 * u,
            91 / 6,
        ]
    }


@case("ArrayConstructors", given={"u": 0.5}, variants=({"u": -3.0},), stop=0.14, error=EXACT)
def array_constructors(t: float, given: Given) -> Values:
    u = given["u"]
    squares = [u, 4 * u, 9 * u, 16 * u]
    return {
        "y": [
            4 + 3 * u,
            2.5 * u,
            u + 16 * u,
            18 * u,
            23 * u - 12 * u,
            (1 + u) * (2 + u) * (3 + u),
            u - 1 + min(squares),
            6 + 5 * u,
        ]
    }


@case("Slices", given={"u": -1.0}, variants=({"u": 2.5},), stop=0.14, error=EXACT)
def slices(t: float, given: Given) -> Values:
    u = given["u"]
    return {"a": u * (6 + 7 + 8) + u * 7, "b": 4 + 80 + 1200, "c": 8 - u * 9}


@case("RunTimeIndex", given={"gear": 1}, variants=({"gear": 2}, {"gear": 3}), stop=0.14, error=EXACT)
def run_time_index(t: float, given: Given) -> Values:
    gear = int(given["gear"])
    return {"y": 10 * gear + t, "z": [4, 5, 6][3 - gear] + gear}


@case("OperatorPrecedence", given={"u": 3.0, "n": 3, "m": 2}, variants=({"n": 5}, {"u": -1.5}), stop=0.14, error=EXACT)
def operator_precedence(t: float, given: Given) -> Values:
    u, n, m = given["u"], given["n"], given["m"]
    return {
        "y": [-(u * u), 50 / u, 8 - u, n / m, 1.5 * u * u, 2 * u, (n + 1) / (4 * m) + 3.5],
        "b": 1.0,
    }


@case("MathFunctions", given={"u": 0.3, "w": -1.7}, variants=({"u": 0.9, "w": 1.2},), stop=0.14, error=EXACT)
def math_functions(t: float, given: Given) -> Values:
    u, w = given["u"], given["w"]
    return {
        "y": [
            *(math.sin(u), math.cos(u), math.tan(u), math.asin(u), math.acos(u), math.atan(w), math.atan2(u, w)),
            *(math.sinh(w), math.cosh(w), math.tanh(w), math.exp(w), math.log(u), math.log10(u), math.sqrt(u)),
            *(abs(w), math.copysign(1, w), min(u, w), max(u, w), u**2.5, w**3, 1 / w**2, 2**w),
        ]
    }


@case("NumberEnds", given={"u": 1.0}, variants=({"u": -0.5},), stop=0.14, error=EXACT)
def number_ends(t: float, given: Given) -> Values:
    u = given["u"]
    return {"y": [0.49406564584124654 * u, 1.7976931348623157e308 * u, u / 3, 123456789012345680.0 * u, 1000 * u + 7]}


@case("FunctionLoop", given={"u": 0.7, "c[3]": 0.0}, variants=({"c[3]": 2.0},), stop=0.14, error=EXACT)
def function_loop(t: float, given: Given) -> Values:
    u = given["u"]
    return {"y": 2 * (u**3 - 2 * u**2 + given["c[3]"] * u + 5), "z": 2 * (u * (u + t) + 1)}


@case("FunctionWhile", given={"u": 2.0}, variants=({"u": 0.0}, {"u": 120.0}), stop=0.14, error=1e-13)
def function_while(t: float, given: Given) -> Values:
    return {"y": math.sqrt(given["u"] + 1)}


@case("FunctionBranches", given={"u": 0.5}, variants=({"u": 0.9}, {"u": 1.5}, {"u": 3.0}), stop=0.14, error=EXACT)
def function_branches(t: float, given: Given) -> Values:
    def shape(x: float) -> float:
        if x > 2:
            y = (x - 2) ** 2 + 10 * (x - 2)
        elif x > 1:
            y = 11 * x
        else:
            y = -10 * x
        return y + x if y > 15 else y

    u = given["u"]
    return {"low": shape(u), "middle": shape(u + 1), "high": shape(u + 2.25)}


@case("FunctionSwap", given={"u": 2.0}, variants=({"u": -0.25},), stop=0.14, error=EXACT)
def function_swap(t: float, given: Given) -> Values:
    u = given["u"]
    return {"y": [100 * u, 10 + 100 * u, u + 10 + 100 * u]}


@case("FunctionOutputs", given={"u": 4.0}, variants=({"u": -1.0},), stop=0.14, error=EXACT)
def function_outputs(t: float, given: Given) -> Values:
    u = given["u"]
    a, b = 3 * u, u - 1
    return {
        "y": a + 10 * b + 100 * (a + b) + 1000 * a * b,
        "z": 6 * u + 1.5 * u + (6 * u + 2 * u - 1),
    }


@case("FunctionArguments", given={"u": 0.8}, variants=({"u": -0.3},), stop=0.14, error=EXACT)
def function_arguments(t: float, given: Given) -> Values:
    def gauss(x: float, mean: float, width: float) -> float:
        return math.exp(-(((x - mean) / width) ** 2))

    u = given["u"]
    return {"a": gauss(u, 0, 1), "b": gauss(u, 0.25, 1.25), "c": gauss(gauss(u, 0, 2), 0.5, 1.5)}


@case("FunctionRecord", given={"u": 3.0}, variants=({"u": -1.0},), stop=0.14, error=EXACT)
def function_record(t: float, given: Given) -> Values:
    u = given["u"]
    return {"y": 2 * (u**2 + 1), "z": 1 - 2 * u}


@case("FunctionDerivative")
def function_derivative(t: float, given: Given) -> Values:
    phi = 2 * t
    return {"lift": 0.1 * math.sin(phi) + 0.02 * phi**2, "speed": 2 * (0.1 * math.cos(phi) + 0.04 * phi)}


@case("FunctionInterpolation", given={"ys[3]": -2.0}, variants=({"ys[3]": 5.0},), error=1e-12)
def function_interpolation(t: float, given: Given) -> Values:
    xs, ys = [0.0, 1, 3, 4], [0.0, 2, given["ys[3]"], 6]
    x = 5 * t - 0.5
    k = 0 if x < 1 else 1 if x < 3 else 2
    return {"y": ys[k] + (ys[k + 1] - ys[k]) * (x - xs[k]) / (xs[k + 1] - xs[k])}


@case("WholeNumberFunctions", events=tuple((1.7 + k / 2) / 4 for k in range(-3, 5)), error=EXACT)
def whole_number_functions(t: float, given: Given) -> Values:
    x = 4 * t - 1.7
    return {"down": math.floor(x), "up": math.ceil(x), "whole": math.floor(2 * x)}


@case("Remainders", given={"u": -2.3}, stop=4.0, step=0.13, events=(0.05, 0.8, 1.55, 2.3, 3.05, 3.8), error=1e-13)
def remainders(t: float, given: Given) -> Values:
    x = given["u"] + t
    return {
        "m": x - math.floor(x / 0.75) * 0.75,
        "r": math.fmod(x, 0.75),
        "d": math.trunc(x / 0.75),
        "folded": -4,
    }


@case("AbsSignMinMax", events=(0.5,), error=EXACT)
def abs_sign_min_max(t: float, given: Given) -> Values:
    x = 1 - 2 * t
    return {"a": abs(x), "s": math.copysign(1, x), "low": min(x, 0.5), "high": max(x * x, 0.25)}


@case("QuotedNames", given={"'gain (1)'": 2.0, "'u in'": 3.0}, variants=({"'gain (1)'": 5.0},), stop=0.14, error=EXACT)
def quoted_names(t: float, given: Given) -> Values:
    return {"'y+1'": given["'gain (1)'"] * given["'u in'"] + 1}


@case(
    "BooleanSignals",
    given={"a": 1, "b": 0, "inverted": 0},
    variants=({"b": 1}, {"a": 0}, {"inverted": 1}, {"a": 0, "b": 1, "inverted": 1}),
    stop=0.14,
    error=EXACT,
)
def boolean_signals(t: float, given: Given) -> Values:
    a, b, inverted = (bool(given[name]) for name in ("a", "b", "inverted"))
    return {
        "both": a and b,
        "either": (a or b) != inverted,
        "differ": a != b,
        "ordered": a == (b or not inverted),
        "y": 3 if a and b else 2 if a != b else 1,
    }


@case("IntegerSignals", given={"n": -3, "k": 7}, variants=({"n": 1200}, {"k": -4}), stop=0.14, error=EXACT)
def integer_signals(t: float, given: Given) -> Values:
    n, k = given["n"], given["k"]
    return {"sum": n + k, "power": n**3, "bigger": max(n, k - 12), "half": n / 2}


@case(
    "EnumerationSignals",
    given={"wanted": 2, "fallback": 3, "u": 0.2},
    variants=({"u": 0.7}, {"u": 0.7, "fallback": 1}, {"wanted": 3}),
    stop=0.14,
    error=EXACT,
)
def enumeration_signals(t: float, given: Given) -> Values:
    mode = int(given["fallback"] if given["u"] > 0.5 else given["wanted"])
    return {"mode": mode, "later": mode > 1, "gain": [1, 20, 300][mode - 1]}


@case("NestedPackages", given={"u": 2.0}, stop=0.14, error=EXACT)
def nested_packages(t: float, given: Given) -> Values:
    return {"f": 9.81 * given["u"], "y": 1000 * given["u"] + 9810, "z": 2000}


@case("ProtectedFinal", given={"u": 1.0, "c": 0.5}, variants=({"c": 2.0}, {"u": 4.0}), stop=0.14, error=EXACT)
def protected_final(t: float, given: Given) -> Values:
    k = 2 * given["c"]
    return {"y": k * k * (9 * given["u"] + 3) + k}


@case("DependentParameters", given={"radius": 1.0, "shift": 0.0}, variants=({"radius": 2.0}, {"shift": -1.5}))
def dependent_parameters(t: float, given: Given) -> Values:
    middle = 3 * given["radius"] ** 2 - 1
    last = 2 * middle + given["shift"]
    return {"y": last * math.exp(-given["radius"] * t), "z": given["radius"] + middle + last}


@case(
    "FoldedParameters",
    given={"is_fast": 0, "order": 2, "x0": 1.0, "limit": 5.0, "zero": 0.0},
    variants=({"is_fast": 1}, {"order": 3}, {"x0": 2.0}, {"limit": 50.0}, {"zero": 0.5}),
)
def folded_parameters(t: float, given: Given) -> Values:
    x = given["x0"] * math.exp(-2 * t if given["is_fast"] else -t)
    return {
        "y": 100 if given["zero"] > 0 else x ** given["order"],
        "z": min(given["limit"], given["zero"] * t + 10) + given["zero"] * x,
        "w": given["x0"] if given["order"] == 2 else -given["x0"],
    }


@case("RecursiveFunction", given={"u": 2.0}, variants=({"u": -3.0},), stop=0.14, error=EXACT)
def recursive_function(t: float, given: Given) -> Values:
    return {"y": given["u"] ** 3}


@case("InputWithDefault", given={"u": 3.0}, stop=0.14, error=EXACT)
def input_with_default(t: float, given: Given) -> Values:
    return {"y": given["u"]}


@case("DerivativeAnnotation", error=EXACT)
def derivative_annotation(t: float, given: Given) -> Values:
    return {"y": 2 * t}


MOTION = (Steps((0, 0.21), (1.0, 3.0)), Steps((0, 0.35), (0.5, -2.0)), Steps((0, 0.49), (7.0, 4.0)))


@case(
    "NoDerivative",
    inputs={f"motion[{place}]": signal for place, signal in enumerate(MOTION, 1)},
    given={"m": 2.0},
    variants=({"m": 0.5},),
)
def no_derivative(t: float, given: Given) -> Values:
    return {"place": MOTION[0].before(t), "force": given["m"] * MOTION[2].before(t), "copied_speed": -math.exp(-t)}


@case("ColumnEquation", given={"k": 2.0}, variants=({"k": -0.5},), error=1e-12)
def column_equation(t: float, given: Given) -> Values:
    return {"y": [t, given["k"] * t, t * t]}


def stairs(x: float) -> tuple[float, float]:
    total = rows = 0.0
    for i in range(1, 4):
        row = 0.0
        for j in range(1, 4):
            row += j * x
            if row > 2 * i:
                break
            if total > 5:
                return total, rows
            total += 1
        rows += 1
        total += row
    return -total, rows


JUMPS_AT = (0.2, 0.4, 0.7, *(n / 2 / k for n in (2, 4, 6) for k in (1, 3, 6)))


@case("FunctionJumps", events=JUMPS_AT, error=1e-12)
def function_jumps(t: float, given: Given) -> Values:
    total, rows = stairs(2 * t)
    place = next((k for k, value in enumerate((0.2, 0.4, 0.7), 1) if value > t), -1)
    return {"place": place, "sum": total, "rows": rows}


def interval(c: float) -> tuple[float, float]:
    turns = max(0, math.ceil(math.log(5 / c, 1.5) + 1e-12))
    return 0, 1.5**turns


OPEN_AT = tuple(k for n in range(1, 7) for k in (n * n / 60, 5 / 1.5**n - 1))


@case("FunctionOpenLoops", events=OPEN_AT, error=1e-12)
def function_open_loops(t: float, given: Given) -> Values:
    lo, hi = interval(1 + t)
    n = next((n for n in range(1, 7) if n * n > 60 * t), -1)
    return {"y": math.floor(t) + 1, "lo": lo, "hi": hi, "n": n}


@case("EnumerationLoops", error=1e-12)
def enumeration_loops(t: float, given: Given) -> Values:
    return {"force": [t, 2 * t, 4 * t], "total": 11 * t, "squares": [1, 4, 16]}


@case("FunctionAsserts", events=(0.5,), error=1e-12)
def function_asserts(t: float, given: Given) -> Values:
    return {"y": 1 / max(t, 0.2), "z": t / (t - 0.3) if t > 0.5 else 0}


LIMITS = [np.polysub(np.poly1d([-1, 2]) ** k, [2, 4]).roots for k in range(1, 14)]
POWERS_AT = (*(t.real for roots in LIMITS for t in roots if abs(t.imag) < 1e-9), 1.5**4 / 2 - 2)


@case("LoopsInLoops", stop=1.2, events=(*POWERS_AT, 0.95), error=1e-12)
def loops_in_loops(t: float, given: Given) -> Values:
    """The first power takes 2 turns; the others take as many as are left of 13, but one."""
    if t > 0.95:
        return {"first": [9, -1, -1], "turns": 2}
    turns, found = 2, [9.0]
    for base in (2 - t, 1.5):
        wanted = math.floor(math.log(4 + 2 * t) / math.log(base)) + 1
        taken = min(wanted, max(13 - turns, 1))
        found.append(base**taken)
        turns += taken
    return {"first": found, "turns": -turns}


@case("Comprehensions", error=1e-12)
def comprehensions(t: float, given: Given) -> Values:
    nested = (1 + t) * (2 + t) + (4 + t) * (6 + t)
    return {"largest": 6, "nested": nested, "rows": [1 - t, 3 - 2 * t], "wheels": [8, 13]}
