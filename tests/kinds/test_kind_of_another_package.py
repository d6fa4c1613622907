"""A kind in one file of another package is all it takes: it is read, checked, built, fused and listed by its name."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from fusion.conftest import Workshop, both_ways, system_of
from kinds.examples import EXAMPLES, written

from dse.errors import DseError
from dse.loading.component.kind import KINDS
from dse.testing.kinds import Files, KindSuite, lay_out, the_component

EXAMPLE = Path(__file__).parents[2] / "examples" / "plugin" / "dse_example"
SOURCE = "{kind: table, points: [[0, 0], [2, 3]]}"


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The folder of an installed distribution that offers the kind ``table``."""
    folder = tmp_path / "site"
    facts = folder / "dse_table-1.0.dist-info"
    facts.mkdir(parents=True)
    (facts / "METADATA").write_text("Metadata-Version: 2.1\nName: dse-table\nVersion: 1.0\n", encoding="utf-8")
    (facts / "entry_points.txt").write_text("[dse.kinds]\ntable = dse_table:KIND\n", encoding="utf-8")
    (folder / "dse_table.py").write_bytes((EXAMPLE / "table.py").read_bytes())
    monkeypatch.syspath_prepend(folder)
    forget()
    yield folder
    forget()


def forget() -> None:
    """Have the packages looked up again."""
    KINDS.__dict__.pop("_offered", None)
    sys.modules.pop("dse_table", None)


@pytest.mark.usefixtures("package")
class TestTable(KindSuite):
    @pytest.fixture
    def example(self) -> Files:
        return written(SOURCE)


@pytest.mark.usefixtures("package")
def test_its_key_is_required_and_its_own_words_have_a_place(tmp_path):
    for source, place, what in (
        ("{kind: table}", "3:1", "'points' is missing in 'source'"),
        ("{kind: table, points: [[0]]}", "3:32", "a point has two numbers"),
    ):
        with pytest.raises(DseError) as caught:
            the_component(lay_out(written(source), tmp_path))
        (problem,) = caught.value.problems
        assert str(problem.where).endswith(f"component.yaml:{place}")
        assert problem.what == what


@pytest.mark.usefixtures("package")
def test_what_is_built_of_generated_c_is_fused_with_c_of_the_workspace(tmp_path):
    shop = Workshop(tmp_path, tmp_path / "cache")
    table = shop.built(the_component(lay_out(written(SOURCE), tmp_path / "a")))
    gain = shop.built(the_component(lay_out(EXAMPLES["c"](), tmp_path / "b")))
    system = system_of({"gain": gain, "table": table}, ["gain.y -> table.u"], ["table.y"])
    (found,) = both_ways(shop, system, ["table.y"], [{"gain.u": 0.5, "table.factor": 10.0}])
    assert found[-1] == pytest.approx(15.0)


@pytest.mark.thorough
def test_the_command_line_lists_checks_and_builds_it(package, tmp_path):
    root = lay_out(written(SOURCE), tmp_path / "workspace")
    settings = {**os.environ, "PYTHONPATH": str(package), "DSE_CACHE": str(tmp_path / "cache")}
    for command, said in ((["components"], "Table"), (["check"], "1 component"), (["build"], "twice: ")):
        line = [sys.executable, "-m", "dse", *command]
        done = subprocess.run(line, cwd=root, env=settings, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
        assert said in done.stdout


def test_without_the_package_the_kind_is_unknown(tmp_path):
    with pytest.raises(DseError, match="unknown component kind 'table'"):
        the_component(lay_out(written(SOURCE), tmp_path))
