from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path
from typing import NoReturn

import numpy as np
import pytest

from dse.domain.run import Waveforms
from dse.errors import DseError
from dse.storage.disk import UnreadableError
from dse.storage.waveform_check import checked, facts_of, size_of
from dse.storage.waveforms import (
    copy_file,
    gather_waveforms,
    link_file,
    read_waveforms,
    waveform_file,
    write_waveforms,
)


def waves(seed: int, rows: int = 50) -> Waveforms:
    generator = np.random.default_rng(seed)
    return Waveforms(
        np.linspace(0.0, 5.0, rows), {"a.x": generator.normal(size=rows), "b.y": generator.normal(size=rows)}
    )


def test_every_run_of_a_chunk_is_read_back_exactly(tmp_path: Path) -> None:
    file = tmp_path / waveform_file(0, 31)
    write_waveforms(file, [(number, waves(number)) for number in (0, 3, 31)])
    for number in (0, 3, 31):
        read, written = read_waveforms(file, number), waves(number)
        np.testing.assert_array_equal(read.time, written.time)
        assert list(read.values) == ["a.x", "b.y"]
        for name in written.values:
            np.testing.assert_array_equal(read.values[name], written.values[name])


def test_the_same_runs_give_the_same_bytes(tmp_path: Path) -> None:
    for name in ("one", "two"):
        write_waveforms(tmp_path / name, [(number, waves(number)) for number in range(4)])
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()


def test_nothing_is_left_beside_the_file(tmp_path: Path) -> None:
    write_waveforms(tmp_path / "runs.parquet", [(0, waves(0))])
    assert [entry.name for entry in tmp_path.iterdir()] == ["runs.parquet"]


def test_nothing_is_left_beside_a_file_that_gets_its_second_name_again(tmp_path: Path) -> None:
    kept, file = tmp_path / "kept.parquet", tmp_path / "runs.parquet"
    write_waveforms(kept, [(0, waves(0))])
    for _ in range(2):
        gather_waveforms(file, [0], [(kept, 0)], ["a.x", "b.y"])
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["kept.parquet", "runs.parquet"]


def test_a_file_that_the_system_does_not_give_is_neither_gone_nor_damaged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "runs.parquet"
    write_waveforms(file, [(0, waves(0))])
    facts = facts_of(file)
    with monkeypatch.context() as broken:
        for place in ("stat", "open"):
            broken.setattr(Path, place, refusing)
            for known in (facts, None):
                with pytest.raises(UnreadableError, match=f"^{file}: waveforms cannot be read: Input/output error"):
                    checked(file, known)
        with pytest.raises(UnreadableError):
            size_of(file)
        with pytest.raises(UnreadableError):
            read_waveforms(file, 0)
    assert checked(file, facts) == facts
    file.unlink()
    assert checked(file, facts) is None
    assert size_of(file) is None


def test_a_second_name_or_a_copy_that_cannot_be_made_leaves_nothing_beside_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source, target = tmp_path / "a.parquet", tmp_path / "b.parquet"
    source.write_bytes(b"x")
    with monkeypatch.context() as broken:
        broken.setattr(Path, "replace", refusing)
        assert not link_file(source, target)
        with pytest.raises(OSError, match="Input/output"):
            copy_file(source, target)
    assert [*tmp_path.iterdir()] == [source]


def refusing(*_arguments: object, **_options: object) -> NoReturn:
    raise OSError(errno.EIO, os.strerror(errno.EIO))


def test_other_programs_read_the_file_as_one_table(tmp_path: Path) -> None:
    import pyarrow.parquet as pq

    write_waveforms(tmp_path / "runs.parquet", [(5, waves(5, 3)), (6, waves(6, 3))])
    table = pq.read_table(tmp_path / "runs.parquet")
    assert table.column_names == ["run", "time", "a.x", "b.y"]
    assert table.column("run").to_pylist() == [5, 5, 5, 6, 6, 6]


def test_waveforms_without_a_variable_are_times_alone(tmp_path: Path) -> None:
    write_waveforms(tmp_path / "runs.parquet", [(5, Waveforms(np.array([0.0, 1.0]), {}))])
    assert read_waveforms(tmp_path / "runs.parquet", 5).values == {}


def test_runs_that_recorded_different_things_do_not_share_a_file(tmp_path: Path) -> None:
    other = Waveforms(np.array([0.0]), {"c.z": np.array([0.0])})
    with pytest.raises(ValueError, match="run 1 recorded other variables"):
        write_waveforms(tmp_path / "runs.parquet", [(0, waves(0)), (1, other)])
    assert not (tmp_path / "runs.parquet").exists()


def test_a_run_that_is_not_in_the_file_is_named(tmp_path: Path) -> None:
    write_waveforms(tmp_path / "runs.parquet", [(0, waves(0))])
    with pytest.raises(DseError, match="no waveforms of run 9"):
        read_waveforms(tmp_path / "runs.parquet", 9)


def test_a_torn_file_is_named(tmp_path: Path) -> None:
    file = tmp_path / "runs.parquet"
    write_waveforms(file, [(0, waves(0))])
    file.write_bytes(file.read_bytes()[:-100])
    with pytest.raises(DseError, match="cannot be read"):
        read_waveforms(file, 0)


WITHOUT_PANDAS = """
import sys
from pathlib import Path
import numpy as np
from dse.domain.run import Waveforms
from dse.storage.waveforms import read_waveforms, write_waveforms

file = Path(sys.argv[1])
write_waveforms(file, [(0, Waveforms(np.zeros(3), {"a": np.ones(3)}))])
assert read_waveforms(file, 0).values["a"].tolist() == [1.0] * 3
assert "pandas" not in sys.modules
"""


def test_waveforms_go_to_and_from_a_file_without_pandas(tmp_path: Path) -> None:
    root = Path(__file__).parents[2]
    subprocess.run([sys.executable, "-c", WITHOUT_PANDAS, tmp_path / "runs.parquet"], cwd=root, check=True)


@pytest.mark.thorough
def test_reading_leaves_no_thread_of_arrow_behind(tmp_path: Path) -> None:
    """One that lets go of a buffer of Python's while Python ends aborts the process: "terminate called without …"."""
    file = tmp_path / waveform_file(0, 1)
    write_waveforms(file, [(0, waves(0)), (1, waves(1))])
    lines = (
        "from pathlib import Path",
        "import pandas, psutil, pyarrow.parquet",
        "from dse.errors import Location",
        "from dse.series.columns import Place",
        "from dse.series.parquet_table import read_parquet",
        "from dse.storage.waveforms import read_all_waveforms, read_waveforms",
        f"file, threads = Path({str(file)!r}), psutil.Process().num_threads()",
        "read_waveforms(file, 1)",
        "list(read_all_waveforms(file))",
        "read_parquet(file, lambda names: [Place(i, '') for i in range(len(names))], Location('here'))",
        "assert psutil.Process().num_threads() == threads, psutil.Process().num_threads()",
    )
    done = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
