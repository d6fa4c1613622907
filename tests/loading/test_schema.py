"""The JSON Schemas that editors check files against: what dse reads they accept, and usual mistakes they find."""

from __future__ import annotations

import json
import re
from copy import deepcopy
from pathlib import Path

import pytest
from jsonschema import Draft7Validator
from ruamel.yaml import YAML

from dse.loading.extensions import EXECUTORS, SAMPLERS
from dse.loading.schema import FILE_KINDS, file_schema

ROOT = Path(__file__).parents[2]
FOLDERS = ("components", "designs", "roads", "testbenches")
# What is only for including has but a part of a file's keys.
FILES = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("[!_]*.yaml"))
MODELINE = re.compile(r"# yaml-language-server: \$schema=(\S+)\n")


def load(text: str) -> object:
    return YAML(typ="safe", pure=True).load(text)


def validator(kind: str) -> Draft7Validator:
    schema = file_schema(kind)
    Draft7Validator.check_schema(schema)
    return Draft7Validator(schema)


def faults(kind: str, text: str) -> list[str]:
    """What is wrong with *text*, by the paths of the innermost errors."""
    return [error.message for error in validator(kind).iter_errors(load(text))]


@pytest.mark.parametrize("kind", FILE_KINDS)
def test_the_schemas_that_come_along_are_those_of_this_version(kind):
    # 'dse schema -o schemas' writes them anew.
    assert json.loads((ROOT / "schemas" / f"{kind}.json").read_text(encoding="utf-8")) == file_schema(kind)


@pytest.mark.thorough
def test_every_file_of_the_example_names_the_schema_that_accepts_it():
    schemas = {(ROOT / "schemas" / f"{kind}.json").resolve(): validator(kind) for kind in FILE_KINDS}
    assert len(FILES) > 80
    for path in FILES:
        text = path.read_text(encoding="utf-8")
        named = MODELINE.match(text)
        assert named, path
        errors = list(schemas[(path.parent / named[1]).resolve()].iter_errors(load(text)))
        assert errors == [], path


EXAMPLES = {
    "component": "components/controllers/pd_acc/component.yaml",
    "interfaces": "components/interfaces.yaml",
    "design": "designs/acc_vehicle.yaml",
    "bench": "testbenches/acc_following.yaml",
    "study": "testbenches/acc_gains.pet.yaml",
}
MISTAKES = [
    ("component", "component: pd_acc", "compnent: pd_acc"),
    ("component", "kind: c,", "kind: cpp,"),
    ("component", "files: [pd_acc.c, ../acc/acc.c]", "file: pd_acc.c"),
    ("component", "header: pd_acc.h", "header: [pd_acc.h]"),
    ("component", "start: 1.2 1/s, min: 0 1/s", "start: 1.2 1/s, minimum: 0 1/s"),
    ("component", "max: 0.05}", "max: 0.05, tunable: no}"),
    ("interfaces", "    inputs:\n", "    input:\n"),
    ("interfaces", "      speed: m/s\n", "      speed: [m/s]\n"),
    ("design", "{optional: camera_mono}", "{option: camera_mono}"),
    ("design", "{alternatives: [hydraulic_booster, brake_by_wire]}", "{alternatives: hydraulic_booster}"),
    ("design", "design: acc_vehicle\n", ""),
    ("design", "constraints:\n", "constraint:\n"),
    ("bench", "stop: 60 s", "end: 60 s"),
    ("bench", "design: acc_vehicle", "design: [acc_vehicle]"),
    ("bench", "    component: straight_road\n", ""),
    ("study", "sampler:\n  full_factorial:", "sampler:\n  fullfactorial:"),
    ("study", "    slices:", "    slice:"),
    ("study", "range: [0, 1]", "range: [0, 0.5, 1]"),
    ("study", "keep_waveforms: all", "keep_waveforms: always"),
    ("study", "seed: 1", "seed: one"),
    ("study", "levels: 33, nominal: 0.5", "level: 33, nominal: 0.5"),
]


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("kind", "right", "wrong"), MISTAKES, ids=[case[2].strip() or case[1] for case in MISTAKES])
def test_a_usual_mistake_is_found(kind, right, wrong):
    text = (ROOT / EXAMPLES[kind]).read_text(encoding="utf-8")
    assert right in text
    assert faults(kind, text) == []
    assert faults(kind, text.replace(right, wrong, 1)) != []


@pytest.mark.parametrize(("registry", "key"), [(SAMPLERS, "sampler"), (EXECUTORS, "executor")])
def test_every_example_of_a_sampler_or_executor_is_accepted_and_other_options_are_not(registry, key):
    check = validator("study")
    study = {"study": "s", "testbench": "b"}
    for name in registry.names():
        for example in registry.get(name).examples:
            wanted = {**study, key: {name: dict(example)}}
            assert list(check.iter_errors(json.loads(json.dumps(wanted)))) == [], name
            odd = deepcopy(wanted)
            odd[key][name]["nosuchoption"] = 1
            assert list(check.iter_errors(odd)) != [], name


def test_what_an_included_file_says_need_not_be_said_again():
    assert faults("study", "include: [_common.yaml]\nseed: 3\n") == []
    assert faults("study", "seed: 3\n") != []
    assert faults("study", "include: _common.yaml\n") != []


def test_texts_for_people_are_kept_and_titles_of_classes_are_not():
    schema = file_schema("bench")
    assert schema["properties"]["title"]["type"] == "string"
    assert "title" not in schema["properties"]["design"]
