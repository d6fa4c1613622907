"""The requirements of a study with their results as ReqIF (OMG, Requirements Interchange Format 1.2), for other tools.

Identifiers follow from the study's and the requirement's name, so that a second import updates the first. ReqIF asks
for times: they are all 1970-01-01, as the same study gives the same bytes.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Mapping, Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from dse.domain.bench import Verdict
from dse.domain.provenance import SourceText
from dse.storage.database.table import RunTable
from dse.storage.export.headings import Scale
from dse.storage.export.requirements import HEADS, asked_cells, sheet_rows

_NAMESPACE = "http://www.omg.org/spec/ReqIF/20110401/reqif.xsd"
_TIME = "1970-01-01T00:00:00Z"
_FORBIDDEN = re.compile("[^\t\n\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

_ASKED = HEADS[: HEADS.index("configuration")]
_RESULTS = (
    "configurations that pass",
    "configurations that fail",
    "configurations that are open",
    "results",
    "study",
    "study fingerprint",
    "file digests",
)
_ATTRIBUTES = {"title": "ReqIF.Name", "text": "ReqIF.Text", "id": "ReqIF.ForeignID"}
"""What the ReqIF implementation guide calls attributes that every tool has."""


def reqif(table: RunTable, scales: Mapping[str, Scale], files: Sequence[SourceText] = ()) -> bytes:
    """A SPEC-OBJECT for each requirement, in one SPECIFICATION; numbers are in the units of *scales*.

    All attributes are strings: what `requirement_sheet` has of a requirement, how many configurations pass, fail or are
    open, ``results``, a line for each configuration, and the SHA-256 digests of the FMUs and of the study's *files*.
    """
    definition = table.header.definition
    study, names = definition.study, (*_ASKED, *_RESULTS)
    root = Element("REQ-IF", {"xmlns": _NAMESPACE})
    header = SubElement(SubElement(root, "THE-HEADER"), "REQ-IF-HEADER", IDENTIFIER=_id(study, "header"))
    about = {
        "CREATION-TIME": _TIME,
        "REQ-IF-TOOL-ID": f"dse {definition.dse}".strip(),
        "REQ-IF-VERSION": "1.0",  # that of the schema, which is the same up to ReqIF 1.2
        "SOURCE-TOOL-ID": "dse",
        "TITLE": _clean(definition.title or study),
    }
    for tag, text in about.items():
        SubElement(header, tag).text = text
    content = SubElement(SubElement(root, "CORE-CONTENT"), "REQ-IF-CONTENT")
    string = _identified(SubElement(content, "DATATYPES"), "DATATYPE-DEFINITION-STRING", study, "text", "text")
    string.set("MAX-LENGTH", "1000000")
    types = SubElement(content, "SPEC-TYPES")
    kind = _identified(types, "SPEC-OBJECT-TYPE", study, "requirement", "Requirement with results")
    attributes = SubElement(kind, "SPEC-ATTRIBUTES")
    for name in names:
        title = _ATTRIBUTES.get(name, name)
        entry = _identified(attributes, "ATTRIBUTE-DEFINITION-STRING", study, f"attribute {name}", title)
        _refer(entry, "TYPE", "DATATYPE-DEFINITION-STRING-REF", _id(study, "text"))
    _identified(types, "SPECIFICATION-TYPE", study, "specification type", "Study")
    objects = SubElement(content, "SPEC-OBJECTS")
    places = SubElement(content, "SPECIFICATIONS")
    place = _identified(places, "SPECIFICATION", study, "specification", definition.title or study)
    _refer(place, "TYPE", "SPECIFICATION-TYPE-REF", _id(study, "specification type"))
    children = SubElement(place, "CHILDREN")
    for requirement, values in _values(table, scales, files):
        one = _identified(objects, "SPEC-OBJECT", study, f"requirement {requirement}", requirement)
        filled = SubElement(one, "VALUES")
        for name, value in zip(names, values, strict=True):
            attribute = SubElement(filled, "ATTRIBUTE-VALUE-STRING", {"THE-VALUE": _clean(value)})
            _refer(attribute, "DEFINITION", "ATTRIBUTE-DEFINITION-STRING-REF", _id(study, f"attribute {name}"))
        _refer(one, "TYPE", "SPEC-OBJECT-TYPE-REF", _id(study, "requirement"))
        child = _identified(children, "SPEC-HIERARCHY", study, f"place {requirement}", "")
        _refer(child, "OBJECT", "SPEC-OBJECT-REF", _id(study, f"requirement {requirement}"))
    indent(root)
    body: bytes = tostring(root, encoding="utf-8")
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + body + b"\n"


def _values(
    table: RunTable, scales: Mapping[str, Scale], files: Sequence[SourceText]
) -> Iterator[tuple[str, list[str]]]:
    """Each requirement with the values of its attributes."""
    definition = table.header.definition
    digests = (*definition.fmus.items(), *((each.file, each.digest) for each in files))
    rows: dict[str, list[dict[str, str]]] = {requirement.name: [] for requirement in definition.requirements}
    for cells in sheet_rows(table, scales):
        row = dict(zip(HEADS, map(str, cells), strict=True))
        rows[row["id"]].append(row)
    for requirement in definition.requirements:
        name, about = requirement.name, map(str, asked_cells(requirement, scales))
        verdicts = [row["verdict"] for row in rows[name]]
        passed, failed = (verdicts.count(str(verdict)) for verdict in (Verdict.PASS, Verdict.FAIL))
        counts = (passed, failed, len(verdicts) - passed - failed)
        results = "\n".join(_result(row) for row in rows[name])
        yield (
            name,
            [
                *about,
                *map(str, counts),
                results,
                definition.study,
                table.header.fingerprint,
                "\n".join(map(" ".join, digests)),
            ],
        )


def _result(row: Mapping[str, str]) -> str:
    """The result of a configuration in a line."""
    unit = f" {row['unit']}".rstrip()
    text = f"{row['configuration']}: {row['verdict']}; of {row['points']} points {row['pass']} pass, {row['fail']} fail"
    if row["run"]:
        bar = f" ± {row['error bar']}" if row["error bar"] else ""
        text += f"; least margin {row['least margin']}{bar}{unit} in run {row['run']}"
    if row["met in"]:
        text += f"; met in {row['met in']} of the draws there ({row['from']} to {row['to']})"
    return text


def _identified(parent: Element, tag: str, study: str, what: str, name: str) -> Element:
    attributes = {"IDENTIFIER": _id(study, what), "LAST-CHANGE": _TIME}
    return SubElement(parent, tag, attributes | ({"LONG-NAME": _clean(name)} if name else {}))


def _refer(parent: Element, tag: str, kind: str, identifier: str) -> None:
    SubElement(SubElement(parent, tag), kind).text = identifier


def _id(study: str, what: str) -> str:
    return "_" + hashlib.sha256(f"{study}\n{what}".encode("utf-8", "surrogatepass")).hexdigest()[:32]


def _clean(text: str) -> str:
    """*text* without what no XML can contain."""
    return _FORBIDDEN.sub("\ufffd", text)
