"""Start values of an FMU's variables: one text per value, each fit for its type."""

from __future__ import annotations

import re

from dse.errors import Problem
from dse.fmu.reading.declared_types import NUMBER_RANGES
from dse.formats import XmlElement, flag_of, real_of, shortened, whole_of

_HEXADECIMAL = re.compile(r"(?:[0-9A-Fa-f]{2})*")
_LARGEST_FLOAT32 = 3.4028235677973366e38


def read_start(
    typed: XmlElement, fmi_type: str, version: int, subject: str, problems: list[Problem]
) -> tuple[str, ...]:
    """The start values that *typed* gives for *subject*; a problem if one of them is none of *fmi_type*.

    FMI 3.0 gives strings and binaries as ``Start`` elements and all else as a list; FMI 1.0 and 2.0 give one value.
    """
    if version == 3 and fmi_type in ("String", "Binary"):
        texts = tuple(element.get("value") for element in typed.all("Start"))
    elif "start" not in typed.attributes:
        return ()
    elif version == 3:
        texts = tuple(typed.get("start").split()) or ("",)
    else:
        texts = (typed.get("start") if fmi_type == "String" else typed.get("start").strip(),)
    for text in texts:
        expected = _expected(fmi_type, text)
        if expected:
            problems.append(Problem(f"{subject}: the start value '{shortened(text)}' is not {expected}", typed.where))
            return ()
    return texts


def _expected(fmi_type: str, text: str) -> str:
    """What the text of a start value should have been; "" if it is right."""
    if fmi_type in ("Real", "Float64", "Float32"):
        value = real_of(text)
        if value is None:
            return "a number"
        too_large = fmi_type == "Float32" and _LARGEST_FLOAT32 <= abs(value) < float("inf")
        return "in the range of Float32" if too_large else ""
    if fmi_type in NUMBER_RANGES:
        number, (least, most) = whole_of(text), NUMBER_RANGES[fmi_type]
        if number is None:
            return "a whole number"
        return "" if least <= number <= most else f"from {least} to {most}"
    if fmi_type == "Boolean":
        return "" if flag_of(text) is not None else "true or false"
    if fmi_type == "Binary":
        return "" if _HEXADECIMAL.fullmatch(text) else "a text of hexadecimal digits"
    return ""
