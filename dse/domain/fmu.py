"""FMUs as the rest of the program sees them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from dse.domain.component import Kind


@dataclass(frozen=True, slots=True)
class Variable:
    """One scalar variable of an FMU: how it is addressed and typed.

    *fmi_type* names the accessor: ``Real``, ``Integer``, ``Boolean``, ``String`` (FMI 2; enumerations are
    ``Integer``) or ``Float64``, ``Float32``, ``Int8`` … ``UInt64``, ``Boolean``, ``String`` (FMI 3;
    enumerations are ``Int64``). *causality* is FMI's word: input, output, parameter, calculatedParameter,
    structuralParameter, local, independent. *unit* is as the FMU spells it, "" for none.
    """

    name: str
    reference: int
    fmi_type: str
    causality: str
    kind: Kind | None
    unit: str = ""
    start: str | None = None


@dataclass(frozen=True, slots=True)
class FmuModel:
    """An unpacked co-simulation FMU for this platform."""

    archive: Path
    folder: Path
    library: Path
    version: int
    identifier: str
    token: str
    variables: Mapping[str, Variable]
    can_handle_variable_step: bool
    can_save_state: bool
    once_per_process: bool
    fixed_step: float | None = None
    content_hash: str = ""
