"""The reference of the site has everything public, and everything public is described."""

from __future__ import annotations

import inspect
import re
from dataclasses import fields, is_dataclass

import pytest
import reference_pages

import dse
from dse.loading import FILE_KINDS, file_schema
from dse.metrics import FUNCTIONS

CLASSES = [each for name in dse.__all__ if isinstance(each := getattr(dse, name), type)]


@pytest.mark.parametrize("name", dse.__all__)
def test_a_public_name_is_described_and_in_the_reference(name: str) -> None:
    assert inspect.getdoc(getattr(dse, name))
    assert re.search(rf"\.\. auto(class|exception|function):: dse\.{name}$", reference_pages.python(), re.MULTILINE)


@pytest.mark.parametrize("shape", CLASSES, ids=lambda shape: shape.__name__)
def test_every_member_of_a_public_class_is_described(shape: type) -> None:
    ours = [base for base in shape.__mro__ if base.__module__.startswith("dse")]
    data = {field.name for field in fields(shape)} if is_dataclass(shape) else set[str]()
    methods = {name: each for base in ours for name, each in vars(base).items() if not name.startswith("_")}
    text = "".join(f"{base.__doc__}{inspect.getsource(base)}" for base in ours)
    data |= {*re.findall(r"^ +self\.([a-z]\w*)(?:: [^=]+)? = ", text, re.MULTILINE)}
    bare = [name for name, each in methods.items() if name not in data and not inspect.getdoc(each)]
    # Data is described by the text of the class.
    assert [*bare, *(name for name in data if f"*{name}*" not in text)] == []


def test_every_command_and_option_is_in_the_reference() -> None:
    text = reference_pages.commands()
    assert {"## dse explore", "## dse space count", "## dse import ssp"} <= {*text.splitlines()}
    assert text.index("## dse init\n") < text.index("## dse check\n") < text.index("## dse schema\n")
    assert "`--retry-failed`" in text


def test_every_function_of_metrics_is_in_the_reference_with_its_arguments() -> None:
    rows = dict(re.findall(r"^\| `(\w+)` \| (.*) \|$", reference_pages.functions(), re.MULTILINE))
    assert rows.keys() == FUNCTIONS.keys()
    assert rows["settling_time"] == (
        "`x`: a waveform; `target`: a constant in the unit of the first; `band`: a constant (default 0.02) | time"
    )
    assert rows["integral"].endswith("| time × the dimension of x")


@pytest.mark.parametrize("kind", FILE_KINDS)
def test_every_key_of_a_file_is_in_the_reference(kind: str) -> None:
    schema = file_schema(kind)
    text = reference_pages.keys_of(schema)
    sections = [schema, *schema.get("$defs", {}).values()]
    keys = {key for section in sections for key in section.get("properties", {})}
    assert keys
    assert {key for key in keys if f"`{key}`" not in text} == set()
    headings = {line.removeprefix("## ").replace(" ", "-") for line in text.splitlines() if line.startswith("## ")}
    assert {*re.findall(r"\]\(#([\w-]+)\)", text)} <= headings
