"""Documents and units kept between two commands say what the files and pint say, whatever happened to the cache."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from contextlib import nullcontext
from pathlib import Path

import pytest
from hypothesis import given, settings, strategies as st

from dse.cache import CacheWarning, keep, kept
from dse.formats import parse_cache as documents
from dse.formats.parse_cache import _document, _Kept, _written
from dse.formats.yaml import parse_yaml, read_yaml

REPOSITORY = Path(__file__).parents[2]
EVERY_YAML = sorted(
    path
    for folder in ("components", "designs", "testbenches", "tests")
    for path in (REPOSITORY / folder).rglob("*.yaml")
)


@pytest.fixture
def cache(tmp_path, monkeypatch):
    folder = tmp_path / "cache"
    monkeypatch.setenv("DSE_CACHE", str(folder))
    return folder


@pytest.fixture
def parsed(monkeypatch):
    """The files that were parsed."""
    files = []

    def parse(path, content):
        files.append(path.name)
        return parse_yaml(path, content)

    monkeypatch.setattr(documents, "parse_yaml", parse)
    return files


@pytest.fixture
def workspace(tmp_path):
    root = tmp_path / "work"
    root.mkdir()
    (root / "a.yaml").write_text('a: 1\nb: [x, {c: "two\\twords"}]\n')
    age(root / "a.yaml")
    return root


def age(path, seconds=60):
    """Let *path* have been left alone, as far as times can be set."""
    then = path.stat().st_mtime_ns - seconds * 10**9
    os.utime(path, ns=(then, then))


def settle(monkeypatch):
    monkeypatch.setattr(documents, "_SETTLED", -(10**18))


def read_and_keep(root, name="a.yaml"):
    store = _Kept(root)
    document = store.read(root / name)
    store.save()
    return document


@pytest.mark.sampled(4)
@pytest.mark.parametrize("path", EVERY_YAML, ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_a_kept_document_is_the_one_that_was_read(path):
    document = read_yaml(path)
    assert _document(path, _written(document)) == document


TEXTS = st.text(st.characters(exclude_categories=["Cc", "Cs", "Cf"]), max_size=12)
VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | TEXTS
    | st.sampled_from(["a\nb", "x\ty", " "]),
    lambda below: st.lists(below, max_size=3) | st.dictionaries(TEXTS, below, max_size=3),
    max_leaves=12,
)


@settings(max_examples=60, deadline=None)
@given(st.dictionaries(TEXTS, VALUES, max_size=4), st.booleans())
def test_any_document_is_kept_with_every_place(data, flow):
    # JSON is YAML: so are keys in quotes and values in brackets.
    text = json.dumps(data, ensure_ascii=False, indent=None if flow else 1)
    document = parse_yaml(Path("file.yaml"), text.encode())
    again = _document(Path("file.yaml"), _written(document))
    assert again == document
    assert again.data == data


def test_numbers_without_end_are_kept():
    document = parse_yaml(Path("file.yaml"), b"a: .inf\nb: -.inf\n")
    assert _document(Path("file.yaml"), _written(document)).data == {"a": float("inf"), "b": -float("inf")}


def test_a_document_is_parsed_once(cache, workspace, parsed, monkeypatch):
    settle(monkeypatch)
    first = read_and_keep(workspace)
    assert read_and_keep(workspace) == first == read_yaml(workspace / "a.yaml")
    assert parsed == ["a.yaml"]


def test_a_file_of_the_same_size_and_times_is_read_by_its_content(cache, workspace, parsed):
    before = (workspace / "a.yaml").stat()
    read_and_keep(workspace)
    (workspace / "a.yaml").write_text((workspace / "a.yaml").read_text().replace("1", "2"))
    os.utime(workspace / "a.yaml", ns=(before.st_atime_ns, before.st_mtime_ns))
    assert read_and_keep(workspace).data["a"] == 2


def test_a_file_that_was_just_written_is_compared_by_its_content(cache, workspace, parsed, monkeypatch):
    # As on a file system that tells times in whole seconds.
    now = time.time_ns()
    monkeypatch.setattr(documents, "_stamp", lambda path: [1, now, now, 1, 1])
    read_and_keep(workspace)
    (workspace / "a.yaml").write_text("a: 3\n")
    assert read_and_keep(workspace).data == {"a": 3}
    assert read_and_keep(workspace).data == {"a": 3}
    assert parsed == ["a.yaml", "a.yaml"]


def test_a_file_that_only_its_times_tell_apart_is_not_parsed_again(cache, workspace, parsed):
    read_and_keep(workspace)
    age(workspace / "a.yaml", 5)
    read_and_keep(workspace)
    assert parsed == ["a.yaml"]


def _cut(file):
    file.write_bytes(file.read_bytes()[:-10])


def _noise(file):
    file.write_bytes(os.urandom(5000))


def _flipped(file):
    content = bytearray(file.read_bytes())
    content[-5] ^= 1
    file.write_bytes(bytes(content))


def _other_version(file):
    head, _, content = file.read_bytes().partition(b"\n")
    file.write_bytes(b"0" + head[1:] + b"\n" + content)


def _forged(file):
    key = file.read_bytes().split(b" ")[0].decode()
    keep(file, key, b'{"a.yaml": "nonsense"}\n[[[', most=9)


def _deep(file):
    key = file.read_bytes().split(b" ")[0].decode()
    keep(file, key, b"[" * 100_000 + b"\n", most=9)


def _folder(file):
    file.unlink()
    file.mkdir()


DAMAGE = [_cut, _noise, _flipped, _other_version, _forged, _deep, _folder, Path.unlink]


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_cache_is_ignored_and_written_again(cache, workspace, parsed, damage, monkeypatch):
    settle(monkeypatch)
    first = read_and_keep(workspace)
    (file,) = (cache / "documents").iterdir()
    damage(file)
    with pytest.warns(CacheWarning, match="damaged") if damage in (_cut, _noise, _flipped) else nullcontext():
        assert read_and_keep(workspace) == first
    assert parsed == ["a.yaml", "a.yaml"]
    assert read_and_keep(workspace) == first
    assert len(parsed) == 2


def test_a_cache_that_cannot_be_written_is_done_without(tmp_path, workspace, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "file"))
    assert read_and_keep(workspace) == read_yaml(workspace / "a.yaml")


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="nothing is read-only for root")
def test_a_read_only_cache_is_done_without(cache, workspace):
    cache.mkdir()
    cache.chmod(0o500)
    assert read_and_keep(workspace) == read_yaml(workspace / "a.yaml")


def test_what_is_gone_is_not_kept(cache, workspace):
    (workspace / "b.yaml").write_text("b: 1\n")
    store = _Kept(workspace)
    store.read(workspace / "a.yaml")
    store.read(workspace / "b.yaml")
    (workspace / "b.yaml").unlink()
    store.save()
    (file,) = (cache / "documents").iterdir()
    assert b"a.yaml" in file.read_bytes()
    assert b"b.yaml" not in file.read_bytes()


def test_the_oldest_files_make_room(tmp_path):
    for number in range(5):
        target = tmp_path / str(number)
        keep(target, "key", b"content", most=3)
        age(target, 10 - number)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["2", "3", "4"]
    assert kept(tmp_path / "4", "key") == b"content"
    assert kept(tmp_path / "4", "other key") is None
    assert kept(tmp_path / "0", "key") is None


def test_a_link_is_read_as_the_file_it_leads_to(cache, workspace, parsed, monkeypatch):
    settle(monkeypatch)
    (workspace / "link.yaml").symlink_to("a.yaml")
    assert read_and_keep(workspace, "link.yaml") == read_yaml(workspace / "a.yaml")
    (workspace / "other.yaml").write_text("a: other\n")
    (workspace / "link.yaml").unlink()
    (workspace / "link.yaml").symlink_to("other.yaml")
    assert read_and_keep(workspace, "link.yaml").data == {"a": "other"}


LOOK = """
import sys
from dse.units import parse_unit
for text in sys.argv[1:]:
    unit = parse_unit(text)
    print(text, unit.factor, unit.offset, *unit.dimension)
print("pint" in sys.modules)
"""
UNITS = ["km/h", "degC", "kWh", "EUR", "%", "TOPS/W", "inch", "m/s2", "rad/s", "deg"]


def units(cache, *texts):
    environment = {**os.environ, "DSE_CACHE": str(cache)}
    command = [sys.executable, "-c", LOOK, *texts]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    *lines, used = done.stdout.splitlines()
    return lines, used == "True"


@pytest.mark.thorough
def test_units_are_the_same_fractions_without_pint(tmp_path):
    first, asked = units(tmp_path, *UNITS)
    again, asked_again = units(tmp_path, *UNITS)
    assert first == again
    assert (asked, asked_again) == (True, False)
    assert "km/h 5/18 0 ('length', Fraction(1, 1)) ('time', Fraction(-1, 1))" in first
    further, asked = units(tmp_path, "mile", *UNITS)
    assert asked
    assert further[1:] == first
    assert not units(tmp_path, "mile", "km/h")[1]


@pytest.mark.thorough
@pytest.mark.parametrize("damage", [_cut, _noise, _forged, _deep])
@pytest.mark.sampled(4)
def test_damaged_units_are_asked_of_pint_again(tmp_path, damage):
    first, _ = units(tmp_path, "km/h", "degC")
    (file,) = (tmp_path / "units").iterdir()
    damage(file)
    assert units(tmp_path, "km/h", "degC") == (first, True)
    assert units(tmp_path, "km/h", "degC") == (first, False)


def test_two_processes_at_once_read_the_same(tmp_path, workspace):
    (workspace / "components").mkdir()
    code = (
        "import sys; from pathlib import Path\n"
        "from dse.formats.parse_cache import remember, read_kept\n"
        "root = Path(sys.argv[1]); remember(root)\n"
        "print(read_kept(root / 'a.yaml', root).data)"
    )
    environment = {**os.environ, "DSE_CACHE": str(tmp_path / "cache")}
    command = [sys.executable, "-c", code, str(workspace)]
    started = [
        subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE) for _ in range(4)
    ]
    said = {process.communicate() for process in started}
    assert said == {(str(read_yaml(workspace / "a.yaml").data).encode() + b"\n", b"")}
    (file,) = (tmp_path / "cache" / "documents").iterdir()
    assert b"a.yaml" in file.read_bytes()
