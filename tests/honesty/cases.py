"""What is simulated to see whether error bars are honest: systems whose solution is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from honesty.parts import Part, solutions

STOP = 3.0


@dataclass(frozen=True)
class Case:
    """*parts* by place and what is connected; ``part.x`` is measured. *step* is the bench's, *settings* the rest of its
    ``simulation``. *solution* names x(t); *unmeasured*: it is right to say that nobody can tell.
    """

    parts: Mapping[str, Part | str]
    solution: str
    step: float = 0.02
    connections: tuple[str, ...] = ()
    unmeasured: bool = False
    settings: str = ""


def one(model: str, mode: str, step: float = 0.02, *, unmeasured: bool = False, **more: object) -> Case:
    """A part by itself; what is in capitals is for the compiler."""
    defines = {key: str(value) for key, value in more.items() if key.isupper()}
    part = Part(model, mode, defines, **{key: value for key, value in more.items() if not key.isupper()})
    return Case({"part": part}, model, step, unmeasured=unmeasured)


def pair(
    mass: Part | str,
    other: Part | str,
    solution: str,
    step: float = 0.02,
    *,
    unmeasured: bool = False,
    settings: str = "",
) -> Case:
    """A loop of two parts."""
    return Case(
        {"part": mass, "other": other},
        solution,
        step,
        ("part.x -> other.u", "other.x -> part.u"),
        unmeasured,
        settings,
    )


SPRING = Part("GAIN", "EXACT")
C_MASS = """\
typedef struct {
    struct { double u; } in; struct { double x, v; } out; struct { double k; } par; double t; long n;
} plant;
void plant_init(plant *self);
void plant_step(plant *self, double h);
#ifdef BODY
void plant_init(plant *self) { self->out.x = 1.0; self->out.v = self->t = 0.0; self->n = 0; }
static void euler(plant *self, double h) { self->out.x += h * self->out.v; self->out.v += h * self->in.u; }
void plant_step(plant *self, double h) { WAY }
#endif
"""
C_EULER = "euler(self, h);"
C_EXACT = "euler(self, h); self->out.x += h * h / 2 * self->in.u;"
C_INNER = "for (double t = 0; t < h - 1e-12; t += 0.005) euler(self, h - t < 0.005 ? h - t : 0.005);"
C_HELD = "for (self->t += h; (self->n + 1) * 0.01 <= self->t + 1e-9; self->n++) euler(self, 0.01);"
MODELICA = {
    "decay": "output Real x(start = 1, fixed = true); output Real v; parameter Real k = 1;"
    " equation der(x) = -k * x; v = 0;",
    "ball": "output Real x(start = 1, fixed = true); output Real v(start = 0, fixed = true);"
    " parameter Real k = 1; equation der(x) = v; der(v) = -9.81 * k - v / 2;"
    " when x < 0 then reinit(v, -0.9 * pre(v)); end when;",
    "mass": "input Real u; output Real x(start = 1, fixed = true); output Real v(start = 0, fixed = true);"
    " parameter Real k = 1; equation der(x) = v; der(v) = k * u;",
}

CASES: Mapping[str, Case] = {
    # As fine as the communication step, or in parts of it.
    "euler": one("DECAY", "EULER"),
    "euler of a spring": one("SPRING", "EULER", 0.01),
    "euler in ten parts": one("LOGISTIC", "EULER", PARTS=10),
    "runge": one("SPRING", "RK4", 0.1),
    "runge in twenty parts, stiff": one("STIFF", "RK4", PARTS=20),
    "runge with bounces": one("BALL", "RK4", 0.01),
    # Steps of its own, the last one cut.
    "finer": one("SPRING", "EULER", GRID=0.01),
    "much finer": one("SPRING", "EULER", 0.1, GRID=0.001),
    "finer, not dividing": one("FORCED", "EULER", GRID=0.007),
    "equal": one("SPRING", "EULER", GRID=0.02),
    "coarser": one("DECAY", "EULER", GRID=0.1),
    "finer runge": one("FORCED", "RK4", 0.5, GRID=0.25),
    "finer, stiff": one("STIFF", "EULER", GRID=0.001),
    "finer with bounces": one("BALL", "EULER", GRID=0.001),
    # Steps of its own on a grid.
    "held": one("SPRING", "EULER_HELD", GRID=0.005, unmeasured=True),
    "held, equal": one("DECAY", "EULER_HELD", GRID=0.02, unmeasured=True),
    "held, coarser": one("FORCED", "EULER_HELD", GRID=0.1, unmeasured=True),
    "held runge": one("SPRING", "RK4_HELD", GRID=0.01, unmeasured=True),
    "held, with model exchange": one("SPRING", "EULER_HELD", GRID=0.01, exchange=True),
    "held but for longer steps": one("DECAY", "EULER_LONG", GRID=0.02),
    "held but for longer steps, finer": one("SPRING", "EULER_LONG", 0.01, GRID=0.005),
    # To a tolerance.
    "tolerance": one("DECAY", "ADAPTIVE", 0.1),
    "tolerance of the experiment": one("SPRING", "ADAPTIVE", 0.1, tolerance=1e-3),
    "tolerance, tight": one("LOGISTIC", "ADAPTIVE", 0.1, tolerance=1e-6),
    "tolerance, stiff": one("STIFF", "ADAPTIVE", 0.1, tolerance=1e-3),
    "tolerance with bounces": one("BALL", "ADAPTIVE", 0.05),
    "tolerance and model exchange": one("FORCED", "ADAPTIVE", 0.1, exchange=True),
    "own tolerance": one("SPRING", "OWN_TOLERANCE", 0.5, TOLERANCE=1e-3),
    "own tolerance and model exchange": one("FORCED", "OWN_TOLERANCE", 0.5, TOLERANCE=1e-3, exchange=True),
    "free": one("SPRING", "FREE", TOLERANCE=1e-3, unmeasured=True),
    "free with model exchange": one("SPRING", "FREE", TOLERANCE=1e-3, exchange=True),
    # Without an error.
    "exact": one("DECAY", "EXACT", unmeasured=True),
    "exact, as is said": one("DECAY", "EXACT", says=", exact: true"),
    "source": one("SINE", "EXACT", unmeasured=True),
    "source, as is said": one("SINE", "EXACT", 0.1, says=", exact: true"),
    # What depends on more than it is told.
    "clock": one("DECAY", "EULER", BY_CLOCK=1, unmeasured=True),
    "process": one("DECAY", "EULER", BY_PROCESS=1, unmeasured=True),
    "count": one("DECAY", "EULER", BY_COUNT=1, unmeasured=True),
    # Pairs: x'' = -x.
    "pair": pair(Part("MASS", "EULER"), SPRING, "COSINE"),
    "pair, finer": pair(Part("MASS", "EULER", {"GRID": "0.005"}), SPRING, "COSINE"),
    "pair, exact": pair(Part("MASS", "EXACT", says=", exact: true"), SPRING, "COSINE"),
    "pair, exact but unsaid": pair(Part("MASS", "EXACT"), SPRING, "COSINE", unmeasured=True),
    # Its method makes no error with a force that is held, so no tolerance shows.
    "pair, tolerance": pair(Part("MASS", "ADAPTIVE"), SPRING, "COSINE", unmeasured=True),
    "pair, held": pair(Part("MASS", "RK4_HELD", {"GRID": "0.01"}), SPRING, "COSINE", unmeasured=True),
    "pair, held with model exchange": pair(
        Part("MASS", "EULER_HELD", {"GRID": "0.01"}, exchange=True), SPRING, "COSINE"
    ),
    "pair in turns": pair(
        Part("MASS", "EULER", {"GRID": "0.005"}), SPRING, "COSINE", settings=", algorithm: gauss_seidel"
    ),
    "pair with lines": pair(
        Part("MASS", "EULER", {"GRID": "0.005"}), SPRING, "COSINE", settings=", extrapolation: linear"
    ),
    "pair with steps of its own": pair(
        Part("MASS", "EULER", {"GRID": "0.005"}), SPRING, "COSINE", settings=", steps: {part: 10 ms}"
    ),
    # Sampled controllers, and their plant.
    "controlled": pair(
        Part("LAG", "EULER", {"GRID": "0.005"}),
        Part("CONTROLLER", "EXACT", {"GRID": "0.1"}, says=", sampled: 100 ms"),
        "CONTROLLED",
    ),
    "controlled by discrete outputs": pair(
        Part("LAG", "ADAPTIVE"), Part("CONTROLLER", "EXACT", {"GRID": "0.1"}, discrete=True), "CONTROLLED"
    ),
    "controlled by nobody knows what": pair(
        Part("LAG", "EULER"), Part("CONTROLLER", "EXACT", {"GRID": "0.1"}), "CONTROLLED", unmeasured=True
    ),
    # Our own.
    "c, euler": pair("c " + C_EULER, SPRING, "COSINE"),
    "c, exact": pair("c " + C_EXACT, SPRING, "COSINE"),
    "c, inner steps": pair("c " + C_INNER, SPRING, "COSINE"),
    "c, held": pair("c " + C_HELD, SPRING, "COSINE", unmeasured=True),
    "modelica": Case({"part": "modelica decay 1e-4"}, "DECAY", 0.1),
    "modelica with bounces": Case({"part": "modelica ball 1e-4"}, "BALL", 0.05),
    "modelica, coupled": pair("modelica mass 1e-5", SPRING, "COSINE"),
}


def truth(name: str) -> dict[str, float]:
    """The metrics of the solution called so, from 1.5 million points of it."""
    t = np.linspace(0.0, STOP, 1_500_001)
    x = ({"CONTROLLED": _controlled, "COSINE": np.cos} | solutions())[name](t)
    mean = float(np.trapezoid(x, t)) / STOP
    return {
        "end": float(x[-1]),
        "most": float(x.max()),
        "mean": mean,
        "rms": float(np.sqrt(np.trapezoid(x**2, t) / STOP)),
    }


def _controlled(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """x' = u - x with u held between samples a tenth of a second apart."""
    x, integral, now = np.zeros_like(t), 0.0, 0.0
    for sample in range(round(STOP / 0.1) + 1):
        integral += 0.1 * (1.0 - now)
        u = 2.0 * (1.0 - now) + integral
        later = t >= sample * 0.1 - 1e-12
        x[later] = u + (now - u) * np.exp(-(t[later] - sample * 0.1))
        now = u + (now - u) * np.exp(-0.1)
    return x
