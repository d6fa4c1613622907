"""``import dse``: what it exports, how soon it is there, and that its names stay what they are."""

from __future__ import annotations

import subprocess
import sys

import pytest

import dse


def python(code: str, **options: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip()


@pytest.mark.parametrize("name", dse.__all__)
def test_every_name_that_is_exported_is_there(name):
    assert getattr(dse, name) is not None
    assert name in dir(dse)


def test_a_name_that_is_not_there_is_an_attribute_error():
    with pytest.raises(AttributeError, match="No dse attribute simulat"):
        dse.simulat  # noqa: B018  # is looked up


def test_importing_it_imports_nothing_else():
    code = "import sys; before = set(sys.modules); import dse; print(sorted(n for n in set(sys.modules) - before))"
    assert "typing" not in python(code)
    assert [name for name in python(code).split("'") if name.startswith("dse")] == ["dse"]


@pytest.mark.thorough
def test_asking_a_design_space_imports_nothing_that_simulates_or_draws(folder):
    code = (
        f"import sys, dse; ws = dse.open({str(folder)!r}); ws.designs['acc_vehicle'].count();"
        "print([n for n in ('pandas', 'matplotlib', 'fmpy', 'pyarrow', 'dse.exploration.loop', 'dse.report.page.html')"
        " if n in sys.modules])"
    )
    assert python(code) == "[]"


@pytest.mark.parametrize("first", ["import dse", "from dse.storage.folder import StudyFolder; import dse"])
def test_results_can_be_called_whatever_was_imported_before(first):
    code = f"{first}\ntry: dse.results('nothing/here')\nexcept dse.DseError as error: print(error)"
    assert "nothing" in python(code)
