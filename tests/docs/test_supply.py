"""requirements.lock and docs/licences.md name what pyproject.toml asks for, and all that this needs in turn."""

from __future__ import annotations

import re
import sys
import tomllib
from importlib.metadata import PackageNotFoundError, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
LOCK = (ROOT / "requirements.lock").read_text("utf-8")


def installed_with(wanted: list[str]) -> set[str]:
    """The packages of *wanted*, and all they need on this machine."""
    found: set[tuple[str, str]] = set()
    todo = [(Requirement(text), "") for text in wanted]
    while todo:
        requirement, extra = todo.pop()
        if requirement.marker is not None and not requirement.marker.evaluate({"extra": extra}):
            continue
        asked = {(canonicalize_name(requirement.name), each) for each in ("", *requirement.extras)} - found
        found |= asked
        todo += [(Requirement(text), each) for name, each in asked for text in requires(name) or ()]
    return {name for name, _ in found}


def locked() -> dict[str, str]:
    return {
        canonicalize_name(name): version for name, version in re.findall(r"^([\w.-]+)==([\w.]+)", LOCK, re.MULTILINE)
    }


def test_what_is_asked_for_is_locked_with_hashes_and_without_a_place_to_get_it() -> None:
    groups = [each for name in ("dev", "docs") for each in PROJECT["dependency-groups"][name]]
    assert groups.count({"include-group": "docs"}) == 1
    texts = [*PROJECT["project"]["dependencies"], *(each for each in groups if isinstance(each, str))]
    asked = [Requirement(text) for text in texts]
    versions = locked()
    assert {r.name for r in asked if not r.specifier.contains(versions.get(canonicalize_name(r.name), "0"))} == set()
    assert "://" not in LOCK
    assert all("--hash=sha256:" in entry for entry in re.split(r"^(?=\w)", LOCK, flags=re.MULTILINE)[1:])


@pytest.mark.skipif(sys.platform != "linux", reason="the list is of Linux")
def test_the_list_of_licences_names_what_is_installed_with_dse() -> None:
    listed = re.findall(r"^\| ([\w.-]+) +\|", (ROOT / "docs/licences.md").read_text("utf-8"), re.MULTILINE)
    try:
        needed = installed_with(PROJECT["project"]["dependencies"])
    except PackageNotFoundError as missing:
        pytest.skip(f"{missing.name} is not installed")
    # What only some versions of Python need may be missing here.
    assert needed <= {canonicalize_name(name) for name in listed} - {"name"} <= locked().keys()
