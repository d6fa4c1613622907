"""The prefabs of clients/unity: their references, as Unity resolves them, and that they fit the code."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "clients" / "unity"
PREFABS = sorted((PACKAGE / "Prefabs").glob("*.prefab"))
BUILT_IN = {("10202", "0000000000000000e000000000000000"), ("10303", "0000000000000000f000000000000000")}  # cube, grey
SCRIPT = "11500000"


def guids() -> dict[str, Path]:
    metas = sorted(PACKAGE.rglob("*.meta"))
    found = {re.findall(r"^guid: ([0-9a-f]{32})$", meta.read_text("utf-8"), re.MULTILINE)[0]: meta for meta in metas}
    assert len(found) == len(metas)
    return {guid: meta.with_suffix("") for guid, meta in found.items()}


def objects(prefab: Path) -> dict[str, tuple[str, str]]:
    """By their fileID, the class and the text of the objects of a prefab."""
    head, *parts = re.split(r"^--- !u!(\d+) &(\d+)\n", prefab.read_text("utf-8"), flags=re.MULTILINE)
    assert head == "%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n"
    found = {id_: (kind, text) for kind, id_, text in zip(parts[::3], parts[1::3], parts[2::3], strict=True)}
    assert len(found) == len(parts) // 3
    return found


def test_every_file_and_folder_has_a_guid_of_its_own() -> None:
    files = {path for path in PACKAGE.rglob("*") if path.suffix != ".meta"}
    assert set(guids().values()) == files


@pytest.mark.parametrize("prefab", PREFABS, ids=lambda prefab: prefab.stem)
def test_every_reference_of_a_prefab_leads_to_what_is_there(prefab: Path) -> None:
    found, known = objects(prefab), guids()
    for kind, text in found.values():
        for id_, guid in re.findall(r"\{fileID: (\d+)(?:, guid: ([0-9a-f]{32}), type: \d)?\}", text):
            if not guid:
                assert id_ == "0" or id_ in found
            elif (id_, guid) not in BUILT_IN:
                target = known[guid]
                assert id_ == SCRIPT if target.suffix == ".cs" else objects(target)[id_][0] == "1"
        owner = re.findall(r"m_GameObject: \{fileID: (\d+)\}", text)
        assert (kind == "1") == (not owner)
    for id_, (kind, text) in found.items():
        if kind == "1":
            parts = re.findall(r"component: \{fileID: (\d+)\}", text)
            assert [each for each, (_, other) in found.items() if f"m_GameObject: {{fileID: {id_}}}" in other] == parts
        if kind == "4":
            children = re.findall(r"^  - \{fileID: (\d+)\}", text, re.MULTILINE)
            assert [each for each, (_, other) in found.items() if f"m_Father: {{fileID: {id_}}}" in other] == children


def test_the_movers_have_a_prefab_for_cars_in_a_field_of_their_script() -> None:
    (text,) = (text for kind, text in objects(PACKAGE / "Prefabs" / "Movers.prefab").values() if kind == "114")
    fields = re.findall(r"^  ([a-z]\w*):$", text, re.MULTILINE)
    code = (PACKAGE / "Runtime" / "DseMovers.cs").read_text("utf-8")
    (count,) = re.findall(r"public GameObject\[\] prefabs = new GameObject\[(\d+)\];", code)
    assert fields == ["prefabs"]
    items = re.findall(r"^  - \{fileID: (\d+)", text, re.MULTILINE)
    assert (len(items), [n for n, id_ in enumerate(items) if id_ != "0"]) == (int(count), [1])
