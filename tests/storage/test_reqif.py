"""ReqIF of the requirements: read back by the standard library, with each reference followed.

`reqif validate --use-reqif-schema` (PyPI, 0.1.0) finds nothing in such files; it needs five more packages.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element

import pytest
from defusedxml.ElementTree import fromstring
from hard_contents import SCRIPT

from dse.domain.definition import StudyDefinition
from dse.domain.provenance import Provenance, SourceText, digest_of
from dse.domain.run import Run
from dse.storage.export.headings import Units
from dse.storage.export.tables import to_reqif
from dse.storage.folder import StudyFolder

SPACE = "{http://www.omg.org/spec/ReqIF/20110401/reqif.xsd}"


@pytest.fixture
def written(
    tmp_path: Path,
    definition: StudyDefinition,
    runs: list[Run],
    add: Callable[[StudyFolder, Run], None],
    asked: Callable[[StudyFolder], StudyFolder],
) -> bytes:
    first, second = definition.requirements
    texts = {"text": "shall\nsettle", "source": "R152 \u00a75", "rationale": SCRIPT, "severity": "major"}
    named = replace(definition, requirements=(replace(first, **texts), replace(second, title="a\x00b")))
    with StudyFolder.create(tmp_path / "named", named) as folder:
        asked(folder)
        for run in runs:
            add(folder, run)
        folder.note(Provenance((SourceText("study", "gains.pet.yaml", "x", digest_of("x")),)))
        return to_reqif(folder)


def values_of(document: Element) -> dict[str, dict[str, str]]:
    """The attributes of each object by their names, by its name."""
    names = {
        each.get("IDENTIFIER"): each.get("LONG-NAME") for each in document.iter(f"{SPACE}ATTRIBUTE-DEFINITION-STRING")
    }
    return {
        str(one.get("LONG-NAME")): {
            str(names[each.findtext(f"{SPACE}DEFINITION/*")]): str(each.get("THE-VALUE"))
            for each in one.iter(f"{SPACE}ATTRIBUTE-VALUE-STRING")
        }
        for one in document.iter(f"{SPACE}SPEC-OBJECT")
    }


def test_each_requirement_is_an_object_with_what_is_asked_and_what_the_runs_came_to(written: bytes) -> None:
    values = values_of(fromstring(written))
    assert list(values) == ["R1", "R2"]
    first = values["R1"]
    assert [first[name] for name in ("ReqIF.ForeignID", "ReqIF.Text", "source", "severity", "at most")] == [
        *("R1", "shall\nsettle", "R152 \u00a75", "major", "1.0"),
    ]
    assert first["rationale"] == SCRIPT
    assert values["R2"]["ReqIF.Name"] == "a\ufffdb"
    assert [first[f"configurations that {what}"] for what in ("pass", "fail", "are open")] == ["1", "1", "0"]
    assert first["results"].splitlines() == [
        "c1: fail; of 3 points 1 pass, 1 fail; least margin -1.5 in run 1",
        "c2: pass; of 1 points 1 pass, 0 fail; least margin 0.0 in run 4",
    ]
    assert first["file digests"].splitlines() == ["pd_acc 0123", f"gains.pet.yaml {digest_of('x')}"]
    assert len(first["study fingerprint"]) > 10


def test_each_reference_leads_to_one_element_of_its_kind(written: bytes) -> None:
    document = fromstring(written)
    identified = [each for each in document.iter() if "IDENTIFIER" in each.attrib]
    kinds = {each.attrib["IDENTIFIER"]: each.tag.removeprefix(SPACE) for each in identified}
    assert len(kinds) == len(identified)
    assert all(re.fullmatch(r"_[0-9a-f]{32}", name) for name in kinds)
    references = [each for each in document.iter() if each.tag.endswith("-REF")]
    assert all(kinds[str(each.text)] == each.tag.removeprefix(SPACE).removesuffix("-REF") for each in references)
    placed = [each.text for each in document.iter(f"{SPACE}SPEC-OBJECT-REF")]
    assert placed == [each.get("IDENTIFIER") for each in document.iter(f"{SPACE}SPEC-OBJECT")]
    # The schema has these in this order, and others in any.
    heads = [each.tag.removeprefix(SPACE) for each in document.findall(f"{SPACE}THE-HEADER/*/*")]
    assert heads == ["CREATION-TIME", "REQ-IF-TOOL-ID", "REQ-IF-VERSION", "SOURCE-TOOL-ID", "TITLE"]
    changed = [each for each in identified if each.tag != f"{SPACE}REQ-IF-HEADER"]
    assert all(each.get("LAST-CHANGE") for each in changed)


def test_identifiers_stay_when_results_change(written: bytes, tmp_path: Path, definition: StudyDefinition) -> None:
    with StudyFolder.create(tmp_path / "new", definition) as empty:
        document = fromstring(to_reqif(empty, Units.SI))
    before = [each.get("IDENTIFIER") for each in fromstring(written).iter(f"{SPACE}SPEC-OBJECT")]
    assert [each.get("IDENTIFIER") for each in document.iter(f"{SPACE}SPEC-OBJECT")] == before
    assert values_of(document)["R1"]["results"] == ""
