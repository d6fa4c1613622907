"""FMUs with clocks, as files, and systems of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from zlib import crc32

from reference_fmus.build import compile_c, library_path, write_archive

from dse.domain.fmu import FmuModel, Variable
from dse.domain.system import Element, SystemStructure, Wire
from dse.fmu.unpack import open_fmu

SOURCES = Path(__file__).parent / "c"
CAN = 'mimeType="application/org.fmi-standard.fmi-ls-bus.can; version=&quot;1.0.0&quot;"'


def _real(name: str, reference: int, causality: str, more: str = "") -> str:
    variability = {"parameter": "fixed"}.get(causality, "discrete")
    start = "" if causality == "output" else 'start="0"'
    if "start=" in more:
        start = ""
    said = f'causality="{causality}" variability="{variability}" {start} {more}'
    return f'<Float64 name="{name}" valueReference="{reference}" {said}/>'


def _clock(name: str, reference: int, causality: str, timing: str = 'intervalVariability="triggered"') -> str:
    return f'<Clock name="{name}" valueReference="{reference}" causality="{causality}" {timing}/>'


def _message(name: str, reference: int, causality: str, clock: int) -> str:
    return f'<Binary name="{name}" valueReference="{reference}" causality="{causality}" clocks="{clock}" {CAN}/>'


def _ticker(timing: str) -> list[str]:
    tick, ring = 'clocks="1"', 'clocks="3"'
    return [
        _clock("tick", 1, "input", timing),
        _clock("bell", 2, "output"),
        _clock("ring", 3, "input"),
        *(_real(name, 10 + n, "output", tick) for n, name in ((0, "count"), (1, "at"), (9, "seen"))),
        _real("sum", 12, "output", 'clocks="1 2"'),
        _real("u", 13, "input", tick),
        _real("v", 14, "input", ring),
        _real("heard", 15, "output", ring),
        _real("rings", 16, "output"),
        _real("y", 17, "output").replace('"discrete"', '"continuous"'),
        _real("x", 18, "input").replace('"discrete"', '"continuous"'),
        *(
            _real(name, 20 + n, "parameter")
            for n, name in enumerate(("kind", "period", "shift", "every", "mode", "delay"))
        ),
        _real("parts", 26, "parameter", 'start="1"'),
        _real("bias", 27, "parameter"),
        _real("hasty", 31, "parameter"),
    ]


TICKER_OUTPUTS = (
    '<Output valueReference="2" dependencies="1"/><Output valueReference="12" dependencies="1 13"/>'
    + "".join(
        f'<Output valueReference="{r}" dependencies="{d}"/>'
        for r, d in ((10, "1"), (11, "1"), (15, "3 14"), (16, ""), (17, ""), (19, "1 18"))
    )
)


def _vecu(tx_clock: str) -> list[str]:
    numbers = ("sent", "received", "last_id", "last_payload", "confirmed", "lost", "received_at", "malformed")
    return [
        tx_clock,
        _clock("Rx_Clock", 2, "input"),
        _message("Tx_Data", 4, "output", 1),
        _message("Rx_Data", 5, "input", 2),
        *(_real(name, 10 + n, "output") for n, name in enumerate(numbers)),
        *(_real(name, 20 + 2 * n, "parameter") for n, name in enumerate(("id", "offset"))),
        _real("period", 21, "parameter", 'start="1"'),
        _real("burst", 23, "parameter", 'start="1"'),
        _real("discards", 24, "parameter"),
    ]


def _bus() -> list[str]:
    found = []
    for k in (0, 1):
        found += [
            _clock(f"Node{k + 1}.Tx_Clock", 1 + 2 * k, "input", 'intervalVariability="countdown"'),
            _clock(f"Node{k + 1}.Rx_Clock", 2 + 2 * k, "input"),
            _message(f"Node{k + 1}.Tx_Data", 10 + 2 * k, "output", 1 + 2 * k),
            _message(f"Node{k + 1}.Rx_Data", 11 + 2 * k, "input", 2 + 2 * k),
        ]
    return found


def description(identifier: str, variables: Iterable[str], outputs: str = "", **flags: str) -> str:
    """A model description for co-simulation with event mode; *flags* are attributes of the interface."""
    said = {"hasEventMode": "true", "canHandleVariableCommunicationStepSize": "true"} | flags
    text = " ".join(f'{name}="{value}"' for name, value in said.items())
    return (
        f'<fmiModelDescription fmiVersion="3.0" modelName="{identifier}" instantiationToken="{{}}">\n'
        f'<CoSimulation modelIdentifier="{identifier}" {text}/>\n<ModelVariables>\n'
        '<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>\n'
        + "\n".join(variables)
        + f"\n</ModelVariables>\n<ModelStructure>{outputs}</ModelStructure>\n</fmiModelDescription>\n"
    )


@dataclass
class Workshop:
    """Builds FMUs in *folder*, each once."""

    folder: Path

    def ticker(self, timing: str = 'intervalVariability="countdown"', **flags: str) -> Path:
        """The FMU of ticker.c, whose own clock is described by *timing*."""
        flags = {"mightReturnEarlyFromDoStep": "true"} | flags
        return self.build("ticker", "ticker", description("ticker", _ticker(timing), TICKER_OUTPUTS, **flags))

    def vecu(self, *, timed: bool = False) -> Path:
        """The FMU of vecu.c; *timed*: with a countdown in place of a triggered Tx clock."""
        countdown = 'intervalVariability="countdown"'
        tx = _clock("Tx_Clock", 1, "input", countdown) if timed else _clock("Tx_Clock", 1, "output")
        name = "vecu_timed" if timed else "vecu"
        outputs = '<Output valueReference="4"/>' + "".join(f'<Output valueReference="{10 + n}"/>' for n in range(8))
        return self.build(name, "vecu", description(name, _vecu(tx), outputs), *(["-DTIMED"] if timed else []))

    def bus(self) -> Path:
        """The FMU of bus.c."""
        outputs = '<Output valueReference="10" dependencies="1"/><Output valueReference="12" dependencies="3"/>'
        flags = {"providesEvaluateDiscreteStates": "true"}
        return self.build("bus", "bus", description("bus", _bus(), outputs, **flags))

    def build(self, name: str, source: str, text: str, *defines: str) -> Path:
        """An FMU of this description and the C file *source*."""
        path = self.folder / f"{name}_{crc32(text.encode())}.fmu"
        library = self.folder / f"{name}.so"
        if not library.exists():
            compile_c([f"-I{SOURCES}", *defines, str(SOURCES / f"{source}.c")], library)
        files = {"modelDescription.xml": text.encode(), str(library_path(3, name)): library.read_bytes()}
        return path if path.exists() else write_archive(path, files)

    def open(self, path: Path) -> FmuModel:
        """The FMU in *path*."""
        return open_fmu(path, cache=self.folder / "cache")


def system_of(
    models: Mapping[str, FmuModel],
    wires: Iterable[str] = (),
    start: Mapping[str, float] | None = None,
    record: Iterable[str] = (),
) -> SystemStructure:
    """A system; wires are ``a.y -> b.u``, *start* and *record* name ``element.variable``."""
    pairs = [tuple(end.split(".", 1) for end in wire.split(" -> ")) for wire in wires]
    recorded = [label.split(".", 1) for label in record]
    elements = []
    for name, model in models.items():
        inputs = {b for _, (target, b) in pairs if target == name}
        outputs = {a for (source, a), _ in pairs if source == name} | {v for e, v in recorded if e == name}
        own = {key.split(".", 1)[1]: value for key, value in (start or {}).items() if key.split(".", 1)[0] == name}
        elements.append(Element(name, model, _of(model, inputs, "input"), _of(model, outputs, "output"), own))
    return SystemStructure("test", tuple(elements), tuple(Wire(*a, *b) for a, b in pairs))


def _of(model: FmuModel, names: set[str], causality: str) -> tuple[Variable, ...]:
    return tuple(v for v in model.variables.values() if v.name in names and v.causality == causality)
