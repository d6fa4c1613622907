"""FMUs of others that integrate one small model in one way, and what they are to have come to."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from reference_fmus.build import HEADERS, compile_c, library_path, write_archive

NAMES = ("u", "x", "v", "der(x)", "der(v)", "k")
INPUTS = ("MASS", "GAIN", "CONTROLLER", "LAG")
Solution = Callable[[float, NDArray[np.float64]], list[float]]


@dataclass(frozen=True)
class Part:
    """*model* integrated by *mode*; *defines* are for the compiler. *exchange*: it has both interfaces. *says* is what
    its component adds to ``source``, *tolerance* that of its default experiment; *discrete* outputs are declared so.
    """

    model: str
    mode: str
    defines: Mapping[str, str] = field(default_factory=dict)
    exchange: bool = False
    says: str = ""
    tolerance: float | None = None
    discrete: bool = False

    @property
    def key(self) -> str:
        """A name for the file."""
        said = repr((self.model, self.mode, sorted(self.defines.items()), self.exchange, self.tolerance, self.discrete))
        return f"p{hashlib.sha256(said.encode()).hexdigest()[:12]}"

    def build(self, folder: Path) -> Path:
        """The archive, in *folder*."""
        work = folder / self.key
        work.mkdir(parents=True, exist_ok=True)
        library = work / "solver.so"
        defines = {"MODEL": self.model, "MODE": self.mode, **self.defines}
        flags = ["-Wno-unused-variable", "-Wno-unused-but-set-variable", f"-I{HEADERS}"]
        compile_c(
            [*flags, *(f"-D{k}={v}" for k, v in defines.items()), str(Path(__file__).parent / "solver.c")], library
        )
        files = {
            "modelDescription.xml": self.description().encode(),
            str(library_path(2, "solver")): library.read_bytes(),
        }
        return write_archive(folder / f"{self.key}.fmu", files)

    def description(self) -> str:
        """The model description."""
        varies = "discrete" if self.discrete else "continuous"
        kinds = {
            "u": 'causality="input" variability="continuous"><Real start="0"/>',
            "x": f'causality="output" variability="{varies}" initial="calculated"><Real/>',
            "v": f'causality="output" variability="{varies}" initial="calculated"><Real/>',
            "der(x)": 'causality="local" variability="continuous" initial="calculated"><Real derivative="2"/>',
            "der(v)": 'causality="local" variability="continuous" initial="calculated"><Real derivative="3"/>',
            "k": 'causality="parameter" variability="fixed" initial="exact"><Real start="1"/>',
        }
        if self.model not in INPUTS:
            kinds["u"] = 'causality="local" variability="continuous" initial="calculated"><Real/>'
        if not self.exchange or self.discrete:
            kinds["der(x)"] = kinds["der(v)"] = kinds["der(x)"].replace(' derivative="2"', "")
        variables = "".join(
            f'<ScalarVariable name="{name}" valueReference="{number}" {kinds[name]}</ScalarVariable>'
            for number, name in enumerate(NAMES)
        )
        states = self.exchange and not self.discrete
        derivatives = '<Derivatives><Unknown index="4"/><Unknown index="5"/></Derivatives>' if states else ""
        exchange = '<ModelExchange modelIdentifier="solver"/>' if self.exchange else ""
        tolerance = f' tolerance="{self.tolerance!r}"' if self.tolerance else ""
        return (
            '<?xml version="1.0" encoding="UTF-8"?>\n'
            '<fmiModelDescription fmiVersion="2.0" modelName="solver" guid="one" '
            f'numberOfEventIndicators="0">{exchange}'
            '<CoSimulation modelIdentifier="solver" canHandleVariableCommunicationStepSize="true"/>'
            f'<DefaultExperiment startTime="0" stopTime="3"{tolerance}/>'
            f"<ModelVariables>{variables}</ModelVariables><ModelStructure>"
            f'<Outputs><Unknown index="2"/><Unknown index="3"/></Outputs>{derivatives}</ModelStructure>'
            "</fmiModelDescription>\n"
        )


def solutions() -> dict[str, Callable[[NDArray[np.float64]], NDArray[np.float64]]]:
    """x(t) of every model without inputs, in closed form."""

    def spring(t: NDArray[np.float64]) -> NDArray[np.float64]:
        d, w = 0.2, math.sqrt(4.0 - 0.04)
        return np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t))

    def ball(t: NDArray[np.float64]) -> NDArray[np.float64]:
        # Between two bounces v' = -9.81 - v / 2; where they are is found by halving.
        def fallen(since: NDArray[np.float64], x: float, v: float) -> NDArray[np.float64]:
            return x + (v + 19.62) * 2 * (1 - np.exp(-since / 2)) - 19.62 * since

        x, at, height, speed = np.zeros_like(t), 0.0, 1.0, 0.0
        while at < t[-1]:
            later = t >= at
            x[later] = fallen(t[later] - at, height, speed)
            low, high = 1e-6 if height else 2 * math.log1p(speed / 19.62), 4.0  # from its highest point on
            for _ in range(80):
                middle = (low + high) / 2
                low, high = (middle, high) if fallen(np.float64(middle), height, speed) > 0 else (low, middle)
            speed = 0.9 * (19.62 - (speed + 19.62) * math.exp(-low / 2))
            at, height = at + low, 0.0
        return x

    return {
        "DECAY": lambda t: np.exp(-t),
        "SPRING": spring,
        "FORCED": lambda t: 0.4 * np.exp(-t) + 0.2 * np.sin(2 * t) - 0.4 * np.cos(2 * t),
        "STIFF": lambda t: (250000 * np.cos(t) + 500 * np.sin(t) + np.exp(-500 * t)) / 250001,
        "LOGISTIC": lambda t: 1 / (1 + 9 * np.exp(-3 * t)),
        "BALL": ball,
        "SINE": np.sin,
    }
