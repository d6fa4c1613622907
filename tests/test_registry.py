"""How what others add is found, and what is said of what cannot be had."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest
from installed_package import install

from dse import plugins
from dse.errors import DseError, Location
from dse.loading.extensions import SAMPLERS
from dse.registry import Registry

WHERE = Location("gains.pet.yaml", 9, 10)


def registry() -> Registry[object]:
    return Registry("dse.samplers", "sampler", room="dse.exploration.samplers", attribute="SAMPLER")


@pytest.fixture
def offer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> object:
    def offer(name: str, source: str, points: Mapping[str, str]) -> None:
        monkeypatch.syspath_prepend(install(tmp_path / name, name, source, {"dse.samplers": points}))

    return offer


def test_a_file_in_the_room_is_all_it_takes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from dse.exploration import samplers

    (tmp_path / "corners.py").write_text("SAMPLER = 'the corners'\n", encoding="utf-8")
    monkeypatch.setattr(samplers, "__path__", [*samplers.__path__, str(tmp_path)])
    assert "corners" in registry().names()
    assert registry().get("corners") == "the corners"


def test_every_sampler_that_comes_with_dse_is_found() -> None:
    assert {"csv", "full_factorial", "halton", "latin_hypercube", "sobol"} <= set(SAMPLERS.names())


def test_what_is_unknown_is_told_where_it_stands(offer: object) -> None:
    offer("others", "X = 1\n", {"saltelli": "X"})
    with pytest.raises(DseError, match=r"gains\.pet\.yaml:9:10: unknown sampler 'saltell'[\s\S]*'saltelli'"):
        registry().get("saltell", WHERE)


def test_two_packages_that_offer_the_same_name_are_both_named(offer: object) -> None:
    offer("one", "X = 1\n", {"saltelli": "X", "sobol": "X"})
    offer("two", "X = 2\n", {"saltelli": "X"})
    with pytest.raises(DseError, match=r"'saltelli' is offered by several packages: (one, two|two, one)"):
        registry().get("saltelli", WHERE)
    with pytest.raises(DseError, match="'sobol' is offered by several packages: dse, one"):
        registry().get("sobol", WHERE)


def test_a_broken_package_stops_only_those_who_use_it(offer: object) -> None:
    offer("broken", "raise RuntimeError('no licence')\n", {"dear": "X"})
    assert registry().get("sobol") is SAMPLERS.get("sobol")
    with pytest.raises(DseError, match=r"'dear' of broken cannot be loaded: RuntimeError: no licence"):
        registry().get("dear", WHERE)


def test_all_that_plug_ins_may_import_is_there_and_is_imported_only_when_it_is_used() -> None:
    assert sorted(plugins.__all__) == sorted(plugins._HOMES)
    for name in plugins.__all__:
        assert getattr(plugins, name).__name__ == name
    script = "import sys; from dse.plugins import metric_function; print('pydantic' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
