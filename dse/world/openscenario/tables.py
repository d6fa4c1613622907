"""The tables that the C core of a scenario walks, row by row, and the numbers that they refer to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from dse.world.openscenario.expressions import Number, Value, constant

NONE = -1
CHORDS = 64
"""Of each segment of a curve."""

_ROWS: dict[str, str] = {
    "lanes": "sb_lane",
    "branches": "sb_branch",
    "entities": "sb_entity",
    "positions": "sb_position",
    "trajectories": "sb_trajectory",
    "vertices": "sb_vertex",
    "knots": "int32_t",
    "actions": "sb_action",
    "entries": "int32_t",
    "states": "int32_t",
    "controllers": "sb_controller",
    "phases": "sb_phase",
    "conditions": "sb_condition",
    "triggering": "sb_triggering",
    "groups": "sb_range",
    "triggers": "sb_range",
    "elements": "sb_element",
}
Row = Mapping[str, object]


@dataclass(slots=True)
class Tables:
    """Rows by table; *numbers* are the values that rows refer to by index, the first is 0."""

    rows: dict[str, list[Row | int | tuple[int, int]]] = field(default_factory=lambda: {name: [] for name in _ROWS})
    numbers: dict[str, int] = field(default_factory=lambda: {"0.0": 0})
    variables: dict[str, Number] = field(default_factory=dict)
    signals: dict[str, int] = field(default_factory=dict)
    texts: dict[str, float] = field(default_factory=dict)
    points: int = 0
    gaps: dict[object, int] = field(default_factory=dict)
    """Distances that conditions measure, each once: from where to where, and how."""
    init_count: int = 0
    stop: int = NONE
    clock: float = 0.0
    """The time of day at the start, in s."""
    has_off_road: bool = False

    def add(self, table: str, row: Row | int | tuple[int, int]) -> int:
        """The number of the new row."""
        self.rows[table].append(row)
        return len(self.rows[table]) - 1

    def count(self, table: str) -> int:
        """How many rows there are."""
        return len(self.rows[table])

    def number(self, number: Number | float) -> int:
        """The index of a number."""
        c = number.c if isinstance(number, Number) else constant(number).c
        return self.numbers.setdefault(c, len(self.numbers))

    def compared(self, value: Value) -> Number:
        """A value as the number that it, or its text, is compared by."""
        return constant(self.texts.setdefault(value, 1e6 + len(self.texts))) if isinstance(value, str) else value

    def variable(self, name: str) -> int:
        """The index of a variable."""
        return list(self.variables).index(name)

    def signal(self, kind: str, name: str) -> int:
        """The index of the variable that has the state of a traffic signal, or the phase of a controller of signals."""
        full = f"<{kind}> {name}"
        if full not in self.signals:
            self.signals[full] = len(self.variables)
            self.variables[full] = constant(0.0)
        return self.signals[full]

    def sizes(self) -> str:
        """The C header with the sizes of what changes during a run; none is 0."""
        sizes = {
            "SB_VALUES": len(self.numbers),
            "SB_VARIABLES": len(self.variables),
            "SB_ENTITIES": self.count("entities"),
            "SB_ACTIONS": self.count("actions"),
            "SB_CONDITIONS": self.count("conditions"),
            "SB_GAPS": len(self.gaps),
            "SB_ELEMENTS": self.count("elements"),
            "SB_POINTS": self.points,
            "SB_CONTROLLERS": self.count("controllers"),
        }
        lines = [f"#define {name} {max(1, size)}" for name, size in sizes.items()]
        return "\n".join([*lines, f"#define SB_CHORDS {CHORDS}", ""])

    def c(self, host: int) -> str:
        """The C of the tables; *host* is the number of the entity that is simulated, or NONE."""
        parts = ['#include "storyboard.h"\n', "#include <math.h>\n"]
        fields = {}
        for name, type_ in _ROWS.items():
            rows = self.rows[name]
            fields[name] = name if rows else "0"
            if rows:
                width = "[2]" if name in {"entries", "states"} else ""
                body = ",\n".join(f"    {_c(row)}" for row in rows)
                parts.append(f"static const {type_} {name}[]{width} = {{\n{body},\n}};\n")
        fields |= {
            "lane_count": str(self.count("lanes")),
            "branch_count": str(self.count("branches")),
            "entity_count": str(self.count("entities")),
            "host": str(host),
            "action_count": str(self.count("actions")),
            "init_count": str(self.init_count),
            "element_count": str(self.count("elements")),
            "trajectory_count": str(self.count("trajectories")),
            "condition_count": str(self.count("conditions")),
            "stop": str(self.stop),
            "variable_count": str(len(self.variables)),
            "controller_count": str(self.count("controllers")),
            "clock": repr(self.clock),
            "has_off_road": str(self.has_off_road).lower(),
        }
        listed = ", ".join(f".{name} = {value}" for name, value in fields.items())
        parts.append(f"const sb_tables scenario_tables = {{{listed}}};\n")
        return "\n".join(parts)

    def numbers_c(self) -> str:
        """The body of the C function that computes the numbers and the variables at the start."""
        lines = [f"    values[{index}] = {_own(c)};" for c, index in self.numbers.items()]
        lines += [f"    variables[{i}] = {_own(number.c)};" for i, number in enumerate(self.variables.values())]
        return "\n".join(lines)


def _own(c: str) -> str:
    return f"defined(self, {c.replace('par->', 'self->par.')})" if "par->" in c else c


def _c(row: object) -> str:
    if isinstance(row, Mapping):
        return "{" + ", ".join(f".{name} = {_c(value)}" for name, value in row.items()) + "}"
    if isinstance(row, bool):
        return str(row).lower()
    if isinstance(row, Sequence) and not isinstance(row, str):
        return "{" + ", ".join(map(_c, row)) + "}"
    return repr(row) if isinstance(row, float) else str(row)
