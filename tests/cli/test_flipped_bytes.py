"""One byte of a file is another one: whatever is read of it, there are problems that are told, or none."""

from __future__ import annotations

import random
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse

from dse.errors import DseError
from dse.interchange import import_component, import_ssp
from dse.loading import Workspace, read_uvl, to_uvl
from dse.testbench import check_workspace

WORKSPACE = Path(__file__).parents[1] / "faults" / "workspace"


def flipped(path: Path, chance: random.Random, times: int) -> list[bytes]:
    """The content of the file with one byte changed: to any other, or by one bit."""
    content = path.read_bytes()
    made = []
    for _ in range(times):
        place, other = (
            chance.randrange(len(content)),
            chance.choice([1 << chance.randrange(8), chance.randrange(1, 256)]),
        )
        made.append(content[:place] + bytes([content[place] ^ other]) + content[place + 1 :])
    return made


def is_told_or_nothing(read: Callable[[], object], content: bytes) -> None:
    try:
        read()
    except DseError as error:
        assert error.problems  # noqa: PT017  # that it is raised is not asked for
    except Exception as error:
        raise AssertionError(f"with {content!r}") from error


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An FMU, an SSP package and a UVL model."""
    folder = tmp_path_factory.mktemp("made")
    shutil.copytree(WORKSPACE, folder / "work")
    for words in ("export ssp start -o ../made.ssp", "build weak -o ..", "export uvl carts -o ../made.uvl"):
        done = run_dse(folder / "work", *words.split(), cache=folder / "cache")
        assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.thorough
@pytest.mark.parametrize("file", [str(f.relative_to(WORKSPACE)) for f in sorted(WORKSPACE.rglob("*.yaml"))])
def test_a_workspace_with_a_flipped_byte_is_checked(tmp_path, monkeypatch, file):
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
    shutil.copytree(WORKSPACE, tmp_path / "work")
    target = tmp_path / "work" / file
    for content in flipped(target, random.Random(file), 30):  # noqa: S311  # no secret
        target.write_bytes(content)
        is_told_or_nothing(lambda: check_workspace(Workspace.around(tmp_path / "work")), content)


@pytest.mark.thorough
@pytest.mark.parametrize("file", ["weak.fmu", "made.ssp", "made.uvl"])
def test_what_is_imported_with_a_flipped_byte_is_told(made, tmp_path, monkeypatch, file):
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
    reads = {
        ".fmu": lambda: import_component(target, tmp_path / "into", None),
        ".ssp": lambda: import_ssp(target, tmp_path / "into", stop=None, step=None),
        ".uvl": lambda: to_uvl(read_uvl(target)),
    }
    target = tmp_path / file
    for content in flipped(made / file, random.Random(file), 150):  # noqa: S311  # no secret
        target.write_bytes(content)
        shutil.rmtree(tmp_path / "into", ignore_errors=True)
        is_told_or_nothing(reads[target.suffix], content[:0])
