"""Models for the runtime, written by hand in the form the Modelica back-end writes them, and the FMUs made of them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from quick_builds import unoptimized

from dse.csolve import headers
from dse.fmu.toolchain import compilation
from dse.fmu.toolchain.compiler import find_compiler
from dse.fmu.toolchain.platforms import this_platform
from dse.formats.zip import pack_zip

RUNTIME = Path(__file__).parents[3] / "dse" / "fmu" / "runtime"

COMMON = (
    "slot.h", "instance.h", "value.h", "random.h", "modelica.h", "arithmetic.h", "tables.h", "evaluate.h",
    "relations.h", "selection.h", "integrate.h", "events.h", "co_simulation.h", "simulation.h", "exchange.h",
)  # fmt: skip
FILES = {
    2: (*COMMON, "fmi2_abi.h", "fmi2_exchange.h", "fmi2.c"),
    3: (*COMMON, "fmi3_abi.h", "fmi3_refused.h", "fmi3_exchange.h", "fmi3.c"),
}
TOKEN = "{handmade}"  # noqa: S105  # an FMU's token is no secret


@dataclass(frozen=True)
class Handmade:
    """A model. *values* have their starts; C code says ``V(name)`` for them.

    *states* name each state's derivative. *roles* are given for what can be set, *kinds* for what is not real, with
    the number of items. *code* holds the bodies of the ``model_…`` functions; what is absent does nothing.
    ``model_event`` and ``model_initial`` run ``derivatives`` and ``outputs`` first.
    """

    name: str
    values: Mapping[str, float]
    states: Mapping[str, str] = field(default_factory=dict)
    roles: Mapping[str, str] = field(default_factory=dict)
    kinds: Mapping[str, tuple[str, int]] = field(default_factory=dict)
    discretes: tuple[str, ...] = ()
    relations: tuple[tuple[str, str, str], ...] = ()
    conditions: int = 0
    triggers: int = 0
    clocks: tuple[tuple[int, int, int], ...] = ()
    checks: int = 0
    failures: tuple[str, ...] = ()
    nominals: Mapping[str, float] = field(default_factory=dict)
    code: Mapping[str, str] = field(default_factory=dict)
    extra: str = ""
    solver: str = "AUTO"
    tolerance: float = 1e-6
    largest_system: int = 1

    def header(self) -> str:
        """model.h"""
        sizes = {
            "VALUES": len(self.values), "STATES": len(self.states), "RELATIONS": len(self.relations),
            "CONDITIONS": self.conditions, "TRIGGERS": self.triggers, "CLOCKS": len(self.clocks),
            "PRE": len(self.discretes), "CHECKS": self.checks, "DATA": 0, "LARGEST_SYSTEM": self.largest_system,
        }  # fmt: skip
        names = list(self.values)
        slots = [
            f"DSE_VALUE({place}, {self.kinds.get(name, ('REAL', 0))[0]}, {self.roles.get(name, 'OUTPUT')}, "
            f"{self.kinds.get(name, ('REAL', 0))[1]})"
            for place, name in enumerate(names)
        ]
        lines = [
            "#ifndef DSE_MODEL_H",
            "#define DSE_MODEL_H",
            "#define DSE_MODEL 1",
            *(f"#define DSE_{name} {size}" for name, size in sizes.items()),
            f"#define DSE_SOLVER DSE_{self.solver}_SOLVER",
            f"#define DSE_DEFAULT_TOLERANCE {self.tolerance!r}",
            '#include "arithmetic.h"',
            '#include "modelica.h"',
            "enum { " + ", ".join(f"place_{name}" for name in names) + " };",
            "#define V(name) m->v[place_##name]",
            "#define PRE(k) m->pre[k]",
            _table("uint32_t dse_state[]", [f"place_{name}" for name in self.states], "0"),
            _table("uint32_t dse_derivative[]", [f"place_{name}" for name in self.states.values()], "0"),
            _table("char *const dse_state_names[]", [f'"{name}"' for name in self.states], '""'),
            _table("uint32_t dse_discrete[]", [f"place_{name}" for name in self.discretes], "0"),
            _table("char *const dse_failure[]", [f'"{text}"' for text in self.failures], '""'),
            _table("char *const dse_relations[]", [f'"{a} {op} {b}"' for a, op, b in self.relations], '""'),
            _table(
                "struct dse_clock dse_clocks[]", [f"{{{a}, {b}, {c}, 0}}" for a, b, c in self.clocks], "{1, 0, 1, 0}"
            ),
            f"#define DSE_SLOT_COUNT {len(names)}u",
            _table("struct dse_slot dse_slots[]", slots, "DSE_VALUE(0, REAL, OUTPUT, 0)"),
            _table("char *const dse_names[]", [f'"{name}"' for name in names], '""'),
            self.extra,
            self._function("int model_parameters(dse_component *m)", "parameters"),
            self._function("int model_guess(dse_component *m)", "guess"),
            self._function("int model_derivatives(dse_component *m)", "derivatives"),
            self._function("int model_outputs(dse_component *m)", "outputs"),
            "static void model_aliases(dse_component *m) { (void)m; }",
            self._continuous("int model_initial(dse_component *m)", "initial"),
            self._continuous("int model_event(dse_component *m)", "event"),
            self._function("int model_reinitialize(dse_component *m)", "reinitialize"),
            "static int model_relations(dse_component *m, double crossing[], uint8_t truth[]) {",
            "    (void)m, (void)crossing, (void)truth;",
            *(
                f"    crossing[{k}] = ({a}) - ({b}); truth[{k}] = ({a}) {op} ({b});"
                for k, (a, op, b) in enumerate(self.relations)
            ),
            "    return 0;",
            "}",
            self._function("int model_check(dse_component *m, dse_tell *tell)", "check"),
            self._function("int model_event_check(dse_component *m, dse_tell *tell)", "event_check"),
            "#undef V",
            "#undef PRE",
            "#endif",
        ]
        return "\n".join(lines) + "\n"

    def start(self, token: str = TOKEN) -> str:
        """start.c"""
        nominals = [repr(self.nominals.get(name, 1.0)) for name in self.states] or ["1.0"]
        return (
            f'const char dse_token[80] = "{token}";\n'
            f"const double dse_starts[] = {{{', '.join(repr(float(v)) for v in self.values.values())}}};\n"
            f"const double dse_nominals[] = {{{', '.join(nominals)}}};\n"
        )

    def _function(self, signature: str, name: str) -> str:
        unused = " (void)tell;" if "tell" in signature else ""
        end = " return 0;" if signature.startswith("int") else ""
        return f"static {signature} {{ (void)m;{unused} {self.code.get(name, '')}{end} }}"

    def _continuous(self, signature: str, name: str) -> str:
        before = "int code = model_derivatives(m); if (code == 0) { code = model_outputs(m); }"
        return f"static {signature} {{ {before} if (code) {{ return code; }} {self.code.get(name, '')} return 0; }}"

    def files(self, version: int) -> dict[str, bytes]:
        """All sources, by path below ``sources``."""
        own = {name: (RUNTIME / name).read_bytes() for name in FILES[version]}
        runtime = {f"runtime/{name}": content for name, content in {**own, **headers()}.items()}
        return {**runtime, "runtime/model.h": self.header().encode(), "start.c": self.start().encode()}

    def fmu(self, folder: Path, version: int) -> Path:
        """The archive, in *folder*; compiled once for equal sources."""
        files = self.files(version)
        content = b"\0".join(text for _, text in sorted(files.items()))
        target = folder / f"{self.name}-{hashlib.sha256(content).hexdigest()[:16]}-{version}.fmu"
        if not target.is_file():
            library = this_platform().library(version, self.name)
            units = [f"runtime/fmi{version}.c", "start.c"]
            with unoptimized():  # it changes no bit
                binary = compilation.compile_library(find_compiler(), files, units, "runtime", library.name)
            description = (_describe_2 if version == 2 else _describe_3)(self)
            target.write_bytes(pack_zip({"modelDescription.xml": description.encode(), str(library): binary}))
        return target


def _table(declaration: str, rows: list[str], empty: str) -> str:
    return f"static const {declaration} = {{{', '.join(rows or [empty])}}};"


_CAUSALITY = {"INPUT": "input", "TUNABLE": "parameter", "FIXED": "parameter", "OUTPUT": "output"}
_VARIABILITY = {"INPUT": "continuous", "TUNABLE": "tunable", "FIXED": "fixed", "OUTPUT": "continuous"}


def _attributes(model: Handmade, name: str) -> tuple[str, str, str]:
    role = model.roles.get(name, "OUTPUT")
    kind = model.kinds.get(name, ("REAL", 0))[0]
    variability = "discrete" if kind != "REAL" and role in ("INPUT", "OUTPUT") else _VARIABILITY[role]
    return _CAUSALITY[role], variability, kind


def _describe_2(model: Handmade) -> str:
    names = list(model.values)
    types = {"REAL": "Real", "INTEGER": "Integer", "BOOLEAN": "Boolean", "ENUMERATION": "Integer"}
    variables, index = [], {name: k + 1 for k, name in enumerate(names)}
    of = {derivative: state for state, derivative in model.states.items()}
    for place, name in enumerate(names):
        causality, variability, kind = _attributes(model, name)
        start = "" if causality == "output" else f' start="{_literal(kind, model.values[name])}"'
        derivative = f' derivative="{index[of[name]]}"' if name in of else ""
        initial = "" if causality == "input" else ' initial="exact"' if causality == "parameter" else ""
        variables.append(
            f'<ScalarVariable name="{name}" valueReference="{place}" causality="{causality}" '
            f'variability="{variability}"{initial}><{types[kind]}{start}{derivative}/></ScalarVariable>'
        )
    outputs = "".join(f'<Unknown index="{index[n]}"/>' for n in names if _attributes(model, n)[0] == "output")
    derivatives = "".join(f'<Unknown index="{index[n]}"/>' for n in model.states.values())
    return (
        f'<fmiModelDescription fmiVersion="2.0" modelName="{model.name}" guid="{TOKEN}" '
        f'numberOfEventIndicators="{len(model.relations)}"><ModelExchange modelIdentifier="{model.name}" '
        f'canGetAndSetFMUstate="true"/><CoSimulation modelIdentifier="{model.name}" canGetAndSetFMUstate="true" '
        f'canHandleVariableCommunicationStepSize="true"/><ModelVariables>{"".join(variables)}</ModelVariables>'
        f"<ModelStructure><Outputs>{outputs}</Outputs><Derivatives>{derivatives}</Derivatives>"
        f"<InitialUnknowns>{outputs}</InitialUnknowns></ModelStructure></fmiModelDescription>"
    )


def _describe_3(model: Handmade) -> str:
    types = {"REAL": "Float64", "INTEGER": "Int32", "BOOLEAN": "Boolean", "ENUMERATION": "Int64"}
    names = list(model.values)
    of = {derivative: names.index(state) for state, derivative in model.states.items()}
    time = f'<Float64 name="time" valueReference="{len(names)}" causality="independent" variability="continuous"/>'
    variables = [time]
    for place, name in enumerate(names):
        causality, variability, kind = _attributes(model, name)
        start = "" if causality == "output" else f' start="{_literal(kind, model.values[name])}"'
        derivative = f' derivative="{of[name]}"' if name in of else ""
        variables.append(
            f'<{types[kind]} name="{name}" valueReference="{place}" causality="{causality}" '
            f'variability="{variability}"{start}{derivative}/>'
        )
    outputs = "".join(
        f'<Output valueReference="{k}"/>' for k, n in enumerate(names) if _attributes(model, n)[0] == "output"
    )
    derivatives = "".join(
        f'<ContinuousStateDerivative valueReference="{names.index(n)}"/>' for n in model.states.values()
    )
    indicators = "".join(
        f'<EventIndicator valueReference="{len(names) + 1 + k}"/>' for k in range(len(model.relations))
    )
    variables += [
        f'<Float64 name="indicator_{k}" valueReference="{len(names) + 1 + k}"/>' for k in range(len(model.relations))
    ]
    return (
        f'<fmiModelDescription fmiVersion="3.0" modelName="{model.name}" instantiationToken="{TOKEN}">'
        f'<ModelExchange modelIdentifier="{model.name}" canGetAndSetFMUState="true"/>'
        f'<CoSimulation modelIdentifier="{model.name}" canGetAndSetFMUState="true" '
        f'canHandleVariableCommunicationStepSize="true"/><ModelVariables>{"".join(variables)}</ModelVariables>'
        f"<ModelStructure>{outputs}{derivatives}{indicators}</ModelStructure></fmiModelDescription>"
    )


def _literal(kind: str, value: float) -> str:
    if kind == "REAL":
        return repr(float(value))
    return ("true" if value else "false") if kind == "BOOLEAN" else str(int(value))
