"""docs/formats.md: its blocks are a workspace that works, and it leaves out nothing the code reads."""

from __future__ import annotations

import json
import re
import sqlite3
import subprocess
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest
from command_line import run_dse
from workspaces import written

from dse.domain.bench import Verdict
from dse.domain.expression import ROLLUPS
from dse.domain.study import Keep
from dse.expression.tokens import KEYWORDS
from dse.loading.bench.bench import BenchFile
from dse.loading.bench.study import StudyFile
from dse.loading.component.component import CollectionFile, ComponentFile
from dse.loading.component.interfaces import InterfacesFile
from dse.loading.component.kind import KINDS
from dse.loading.design.design import DesignFile
from dse.loading.road.road import RoadFile
from dse.loading.sections import Section, _sections
from dse.metrics.catalogue import FUNCTIONS, ROWWISE
from dse.storage.export.tables import EXPORTS
from dse.units import parse_unit

TEXT = (Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"(?:# |/\* )((?:components|designs|roads|testbenches)/\S+)(?: \*/)?\n")
CODE = "\n".join(re.findall(r"`([^`\n]+)`", BLOCK.sub("", TEXT)))
"""What stands between backticks in the text; the example's own files do not count as a description."""

Dse = Callable[..., "subprocess.CompletedProcess[str]"]


def files() -> dict[str, str]:
    """The blocks that name a file, by that name."""
    named = [(match[1], text) for _, text in BLOCK.findall(TEXT) if (match := FILE.match(text))]
    assert len(dict(named)) == len(named)
    return dict(named)


def section(heading: str) -> str:
    """The text under *heading*, without its blocks."""
    return BLOCK.sub("", TEXT.partition(f"\n## {heading}\n")[2].partition("\n## ")[0])


def is_mentioned(word: str) -> bool:
    return re.search(rf"(?<![\w.]){re.escape(word)}(?!\w)", CODE) is not None


def sections() -> Iterator[type[Section]]:
    """Those of the files, and those in them."""
    stack: list[type[Section]] = [
        InterfacesFile,
        ComponentFile,
        CollectionFile,
        DesignFile,
        BenchFile,
        RoadFile,
        StudyFile,
    ]
    while stack:
        yield (section := stack.pop())
        stack += [found for field in section.model_fields.values() for found in _sections(field.annotation)]


@pytest.fixture(scope="module")
def dse(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Dse:
    root = tmp_path_factory.mktemp("formats")
    written(root / "workspace", files())

    cache = built_before(root / "cache")

    def call(*arguments: str) -> subprocess.CompletedProcess[str]:
        return run_dse(root / "workspace", *arguments, cache=cache)

    return call


@pytest.mark.thorough
def test_the_blocks_are_a_workspace_without_a_mistake(dse):
    done = dse("check")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("ok: 5 interfaces, 6 components, 2 design spaces, 1 road, 3 test benches, 3 studies")


@pytest.mark.thorough
def test_the_bench_of_the_document_runs_and_gives_every_metric_and_verdict(dse):
    done = dse("simulate", "speed_step", "--format", "json")
    assert done.returncode == 0, done.stderr
    run = json.loads(done.stdout)
    assert run["outcome"] == "done"
    assert run["metrics"].keys() == {"rise", "speed_overshoot", "reached", "pushing", "work"}
    assert None not in run["metrics"].values()
    assert {judgement["verdict"] for judgement in run["requirements"].values()} == {"pass"}


@pytest.mark.thorough
def test_the_bench_that_is_fed_from_a_file_runs_and_its_waveforms_are_written(dse, tmp_path):
    done = dse("simulate", "delivery", "-o", str(tmp_path / "wave.csv"))
    assert done.returncode == 0, done.stderr
    head, *rows = (tmp_path / "wave.csv").read_text(encoding="utf-8").splitlines()
    assert head == "time,inputs.controller.set_speed [m/s],load.motion.speed [m/s]"
    assert rows[120].startswith("12.0,2.0,")


@pytest.mark.thorough
def test_every_configuration_of_the_document_runs(dse, tmp_path):
    done = dse("run", "speed_step", "-o", str(tmp_path / "all"), "-j", "1")
    assert done.returncode == 0, done.stderr


@pytest.mark.thorough
@pytest.mark.parametrize("design", ["parcel_cart", "fleet"])
def test_the_count_beside_the_design_is_what_enumerate_finds(dse, design):
    claimed = re.search(rf"`dse enumerate {design} --count` finds (\d+) of ([\d,]+)", TEXT)
    found = json.loads(dse("enumerate", design, "--count", "--format", "json").stdout)
    assert claimed
    total = int(claimed[2].replace(",", ""))
    assert found == {"design": design, "total": total, "valid": int(claimed[1]), "exact": True}


@pytest.mark.thorough
def test_the_study_folder_has_the_tables_and_columns_described(dse, tmp_path):
    done = dse("explore", "gains", "-o", str(tmp_path), "-j", "1")
    assert done.returncode == 0, done.stderr
    with closing(sqlite3.connect(tmp_path / "study.sqlite")) as connection:
        tables = [name for (name,) in connection.execute("SELECT name FROM sqlite_schema WHERE type = 'table'")]
        for table in tables:
            (described,) = re.findall(rf"^\| `{table}` \| (.*) \|$", section("The study folder"), re.MULTILINE)
            columns = [row[1] for row in connection.execute(f"PRAGMA table_info({table})")]
            stems = {re.sub(r"^(p|m|verdict|margin|e|v):.*", r"\1:", column) for column in columns}
            assert stems == set(re.findall(r"`(\w+:?)(?:[A-Z]+)?`", described)) - _values_in(table)
        (application,), (version,) = (
            connection.execute(f"PRAGMA {n}").fetchone() for n in ("application_id", "user_version")
        )
        assert f"`application_id` 0x{application:X}, `user_version` {version}" in TEXT


def _values_in(table: str) -> set[str]:
    """Words in the description of *table* that are values, not columns."""
    return {
        "facts": {"definition", "runs", "asked", "era", "base", "earlier", "seal", "notes"},
        "runs": {"done", "failed"},
    }.get(table, set())


def test_every_key_of_every_file_is_described():
    shapes = [*sections(), *(KINDS.get(name).section for name in KINDS.names())]
    keys = {(shape.__name__, key) for shape in shapes for key in shape.model_fields}
    assert len(keys) > 60
    assert not [key for key in sorted(keys) if not is_mentioned(key[1])]


def test_every_function_rollup_and_keyword_of_the_expressions_is_described():
    words = {*FUNCTIONS, *ROWWISE, *ROLLUPS, *KEYWORDS}
    assert not [word for word in sorted(words) if not is_mentioned(word)]


def test_every_unit_listed_can_be_read():
    (listed,) = re.findall(r"SI units and prefixes, and (.*?)\n\(", section("Quantities and units"), re.DOTALL)
    units = " ".join(re.findall(r"`([^`]+)`", listed)).split()
    assert len(units) > 10
    assert [parse_unit(unit).symbol for unit in units] == units


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_arguments_of_a_metric_function_are_described_as_they_are(name):
    (described,) = re.findall(rf"`{name}\(([^)`]*)\)`", section("Metrics"))
    found = [(part[0], part[2] or None) for part in (text.strip().partition(" = ") for text in described.split(","))]
    assert [argument.name for argument in FUNCTIONS[name].arguments] == [argument for argument, _ in found]
    for argument, (_, default) in zip(FUNCTIONS[name].arguments, found, strict=True):
        assert argument.default == (float(default.removesuffix(" s")) if default else None)


def test_every_verdict_result_format_and_choice_of_waveforms_is_described():
    words = {*map(str, Verdict), *EXPORTS, *map(str, Keep)}
    assert not [word for word in sorted(words) if not is_mentioned(word)]


def test_every_exit_code_is_described():
    from dse.cli import endings, signals

    codes = {
        *(endings.DONE, endings.WRONG_FILES, endings.USAGE, endings.RUNS_FAILED),
        *(128 + number for number in signals.SIGNALS),
    }
    assert {int(code) for code in re.findall(r"`(\d+)`", section("Exit codes"))} == codes


def test_every_link_within_the_document_leads_to_a_heading():
    headings = re.findall(r"^#+ (.*)$", BLOCK.sub("", TEXT), re.MULTILINE)
    anchors = {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
    linked = set(re.findall(r"\]\(#([^)]+)\)", TEXT))
    assert len(linked) > 10
    assert linked <= anchors


@pytest.mark.thorough
def test_the_study_on_two_benches_tests_every_design_on_both(dse, tmp_path):
    done = dse("explore", "both_loads", "-o", str(tmp_path), "-j", "1")
    assert done.returncode == 0, done.stderr
    rows = dse("results", str(tmp_path)).stdout.splitlines()
    column = rows[0].split(",").index("testbench")
    counts = {bench: [row.split(",")[column] for row in rows].count(bench) for bench in ("speed_step", "heavy_load")}
    assert counts["speed_step"] == counts["heavy_load"] > 0
