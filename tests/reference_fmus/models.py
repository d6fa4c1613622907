"""Seven models after the idea of the Reference FMUs, and what is known about each of them."""

from __future__ import annotations

from reference_fmus.declared import Declared, ReferenceModel, Unit

TIME = Declared("time", "Float64", "independent", description="Simulation time")

DAHLQUIST = ReferenceModel(
    "Dahlquist",
    (
        TIME,
        Declared("x", "Float64", "output", initial="exact", start=("1",), depends=()),
        Declared("der(x)", "Float64", initial="calculated", derivative_of="x", depends=("x", "k")),
        Declared("k", "Float64", "parameter", "fixed", start=("1",)),
    ),
    stop=10.0,
    step=0.1,
    partial_derivatives=True,
    description="x' = -k x",
)

_BALL_UNITS = (Unit("m", {"m": 1}), Unit("m/s", {"m": 1, "s": -1}), Unit("m/s2", {"m": 1, "s": -2}))

BOUNCING_BALL = ReferenceModel(
    "BouncingBall",
    (
        TIME,
        Declared("h", "Float64", "output", initial="exact", start=("1",), unit="m", depends=()),
        Declared("der(h)", "Float64", initial="calculated", derivative_of="h", unit="m/s", depends=("v",)),
        Declared("v", "Float64", "output", initial="exact", start=("0",), unit="m/s", depends=()),
        Declared("der(v)", "Float64", initial="calculated", derivative_of="v", unit="m/s2", depends=("g",)),
        Declared("z", "Float64", initial="calculated", unit="m", depends=("h",), description="its event indicator"),
        Declared("g", "Float64", "parameter", "fixed", start=("-9.81",), unit="m/s2"),
        Declared("e", "Float64", "parameter", "tunable", start=("0.7",), minimum=0.0),
        Declared("v_min", "Float64", "parameter", "fixed", start=("0.1",), unit="m/s"),
        Declared("bounces", "Int32", "output", "discrete", initial="calculated", depends=()),
        Declared("resting", "Boolean", "output", "discrete", initial="calculated", depends=()),
    ),
    stop=3.0,
    step=0.01,
    indicators=("z",),
    event_mode=True,
    units=_BALL_UNITS,
    description="A ball that loses a part of its speed each time it hits the ground, until it rests",
)

VAN_DER_POL = ReferenceModel(
    "VanDerPol",
    (
        TIME,
        Declared("x0", "Float64", "output", initial="exact", start=("2",), depends=()),
        Declared("der(x0)", "Float64", initial="calculated", derivative_of="x0", depends=("x1",)),
        Declared("x1", "Float64", "output", initial="exact", start=("0",), depends=()),
        Declared("der(x1)", "Float64", initial="calculated", derivative_of="x1", depends=("x0", "x1", "mu")),
        Declared("mu", "Float64", "parameter", "fixed", start=("1",)),
    ),
    stop=20.0,
    step=0.01,
    partial_derivatives=True,
    description="x0' = x1, x1' = mu (1 - x0^2) x1 - x0",
)

STAIR = ReferenceModel(
    "Stair",
    (
        TIME,
        Declared("counter", "Int32", "output", "discrete", initial="exact", start=("1",), depends=()),
        Declared("last", "Int32", "parameter", "fixed", start=("12",)),
    ),
    stop=10.0,
    step=0.2,
    event_mode=True,
    description="Counts the seconds with time events; asks to end the simulation at the last one",
)

_WHOLE = ("Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")
_OPTIONS = {"Option 1": 1, "Option 2": 2, "Option 7": 7}


def _through(name: str, fmi_type: str, variability: str, start: tuple[str, ...], **more: object) -> list[Declared]:
    source = Declared(f"{name}_input", fmi_type, "input", variability, start=start, **more)  # type: ignore[arg-type]
    depends = (source.name,)
    return [
        source,
        Declared(f"{name}_output", fmi_type, "output", variability, "calculated", depends=depends, **more),  # type: ignore[arg-type]
    ]


FEEDTHROUGH = ReferenceModel(
    "Feedthrough",
    (
        TIME,
        *_through("Float64_continuous", "Float64", "continuous", ("0",)),
        *_through("Float64_discrete", "Float64", "discrete", ("0",)),
        *_through("Float32_continuous", "Float32", "continuous", ("0",)),
        *_through("Float32_discrete", "Float32", "discrete", ("0",)),
        *(v for whole in _WHOLE for v in _through(whole, whole, "discrete", ("0",))),
        *_through("Boolean", "Boolean", "discrete", ("false",)),
        *_through("String", "String", "discrete", ("Set me!",)),
        *_through("Binary", "Binary", "discrete", ("666f6f",)),
        *_through("Enumeration", "Enumeration", "discrete", ("1",), items=_OPTIONS),
        *_through("Float64_array", "Float64", "continuous", ("1", "2", "3", "4", "5", "6"), shape=(2, 3)),
        *_through("Int32_array", "Int32", "discrete", ("7",), shape=(3,)),
        *_through("Boolean_array", "Boolean", "discrete", ("true", "false"), shape=(2,)),
        *_through("String_array", "String", "discrete", ("one", "two"), shape=(2,)),
        *_through("Binary_array", "Binary", "discrete", ("00ff", "10"), shape=(2,)),
        Declared("fixed_parameter", "Float64", "parameter", "fixed", start=("2.5",)),
        Declared("tunable_parameter", "Float64", "parameter", "tunable", start=("0",)),
        Declared("text_parameter", "String", "parameter", "fixed", start=("<a & 'b'>",)),
        Declared(
            "sum", "Float64", "output", "continuous", "calculated", description="of the reals that have no output"
        ),
        Declared("text_digest", "Int32", "output", "discrete", "calculated", description="of all texts that came in"),
        Declared("fixed_double", "Float64", "calculatedParameter", "fixed", "calculated", depends=("fixed_parameter",)),
    ),
    stop=2.0,
    step=0.1,
    event_mode=True,
    partial_derivatives=True,
    description="Every input appears at an output of the same type, within the same instant",
)

RESOURCE = ReferenceModel(
    "Resource",
    (TIME, Declared("y", "Int32", "output", "discrete", "calculated", depends=())),
    stop=1.0,
    step=0.1,
    resources={"y.txt": b"97\n"},
    description="y is the number that stands in resources/y.txt",
)


def _size(name: str, description: str) -> Declared:
    return Declared(name, "UInt64", "structuralParameter", "fixed", start=("3",), description=description)


def _matrix(name: str, *shape: str) -> Declared:
    identity = tuple("1" if i == j else "0" for i in range(3) for j in range(3))
    return Declared(name, "Float64", "parameter", "fixed", start=identity, shape=shape)


STATE_SPACE = ReferenceModel(
    "StateSpace",
    (
        TIME,
        _size("m", "number of inputs"),
        _size("n", "number of states"),
        _size("r", "number of outputs"),
        _matrix("A", "n", "n"),
        _matrix("B", "n", "m"),
        _matrix("C", "r", "n"),
        _matrix("D", "r", "m"),
        Declared("x0", "Float64", "parameter", "fixed", start=("1", "2", "3"), shape=("n",)),
        Declared("u", "Float64", "input", start=("1", "2", "3"), shape=("m",)),
        Declared("y", "Float64", "output", initial="calculated", shape=("r",)),
        Declared("x", "Float64", initial="calculated", shape=("n",)),
        Declared("der(x)", "Float64", initial="calculated", shape=("n",), derivative_of="x"),
    ),
    stop=1.0,
    step=0.1,
    description="x' = A x + B u, y = C x + D u, x(0) = x0",
)

MODELS = {
    model.name: model for model in (DAHLQUIST, BOUNCING_BALL, VAN_DER_POL, STAIR, FEEDTHROUGH, RESOURCE, STATE_SPACE)
}
