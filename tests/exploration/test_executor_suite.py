"""Every executor that is found, those of installed packages too, in the suite that others run over theirs."""

from __future__ import annotations

import pickle
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from dse.cache import cache_folder
from dse.domain.component import Kind
from dse.domain.fmu import FmuModel, Variable
from dse.exploration.packed_configuration import Packer, unpacked
from dse.loading.extensions import EXECUTORS
from dse.testing.executors import ExecutorSuite, SmallBench

_SLOW = {"dask"}

for _name in EXECUTORS.names():
    _marks = [pytest.mark.thorough] if _name in _SLOW else []
    _members = {"executor": EXECUTORS.get(_name), "pytestmark": _marks}
    globals()[f"Test_{_name}"] = type(f"Test_{_name}", (ExecutorSuite,), _members)


@dataclass(frozen=True)
class Filed(SmallBench):
    model: FmuModel | None = None
    file: Path | None = None
    wired: tuple[Variable, ...] = ()


def model(folder: Path) -> FmuModel:
    return FmuModel(Path("/home/me/radar.fmu"), folder, folder / "radar.so", 2, "radar", "", {})


def test_a_bench_finds_its_fmus_in_the_cache_of_the_machine_it_is_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "here"))
    sent = Packer().pack(Filed("plain", model=model(cache_folder() / "unpacked" / "0123")))
    content = sent.content
    assert sent.elsewhere == ()
    assert sent.entries == ("unpacked/0123",)
    assert str(tmp_path).encode() not in content
    assert b"/home/me" not in content
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "there"))
    found = pickle.loads(content)  # noqa: S301  # ours
    assert found.model == model(tmp_path / "there" / "unpacked" / "0123").__class__(
        Path("radar.fmu"),
        tmp_path / "there" / "unpacked" / "0123",
        tmp_path / "there" / "unpacked" / "0123" / "radar.so",
        2,
        "radar",
        "",
        {},
    )


def test_elsewhere_its_fmus_are_where_they_were_received(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "here"))
    sent = Packer().pack(Filed("plain", model=model(cache_folder() / "unpacked" / "0123")))
    found = unpacked(sent.content, {"unpacked/0123": tmp_path / "received"})
    assert found.model.library == tmp_path / "received" / "radar.so"
    assert found.model.folder == tmp_path / "received"


def test_a_file_that_only_this_machine_has_is_noticed_before_it_is_missed(tmp_path: Path) -> None:
    assert Packer().pack(Filed("plain", file=tmp_path / "lead.csv")).elsewhere == (tmp_path / "lead.csv",)


def test_an_fmu_of_many_benches_is_pickled_once_and_unpickled_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DSE_CACHE", str(tmp_path))
    speed = Variable("speed", 1, "Real", "output", Kind.REAL)
    shared = replace(model(tmp_path / "unpacked" / "0123"), variables={"speed": speed})
    packer, alike = Packer(), replace(speed)
    sent = [packer.pack(Filed(name, model=shared, wired=(speed, alike))) for name in ("plain", "other")]
    assert packer.model(shared).content in sent[0].content
    first, second = (pickle.loads(each.content) for each in sent)  # noqa: S301  # ours
    assert first.model is second.model
    assert first.wired[0] is first.model.variables["speed"]
    assert first.wired[1] == speed
    assert first.wired[1] is not first.wired[0]
    assert [each.entries for each in sent] == [("unpacked/0123",)] * 2
