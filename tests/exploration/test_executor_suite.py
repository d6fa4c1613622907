"""Every executor that is found, those of installed packages too, in the suite that others run over theirs."""

from __future__ import annotations

import pickle
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from dse.cache import cache_folder
from dse.domain.fmu import FmuModel
from dse.errors import DseError
from dse.exploration.remote import packed, parcel
from dse.loading.extensions import EXECUTORS
from dse.testing.executors import ExecutorSuite, SmallBench, batches, work_in

for _name in EXECUTORS.names():
    globals()[f"Test_{_name}"] = type(f"Test_{_name}", (ExecutorSuite,), {"executor": EXECUTORS.get(_name)})


@dataclass(frozen=True)
class Filed(SmallBench):
    model: FmuModel | None = None
    file: Path | None = None


def model(folder: Path) -> FmuModel:
    return FmuModel(Path("/home/me/radar.fmu"), folder, folder / "radar.so", 2, "radar", "", {})


def test_a_bench_finds_its_fmus_in_the_cache_of_the_machine_it_is_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "here"))
    content, elsewhere = packed(Filed("plain", model=model(cache_folder() / "unpacked" / "0123")))
    assert elsewhere == ()
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


def test_a_file_that_only_this_machine_has_is_named_before_it_is_missed(tmp_path: Path) -> None:
    work = work_in(tmp_path)
    lonely = Filed("plain", file=tmp_path / "lead.csv")
    with pytest.raises(DseError, match=r"plain needs .*lead\.csv, which only this machine has"):
        parcel(replace(work, configurations={"plain": lonely}), batches(keep=False)[0])
