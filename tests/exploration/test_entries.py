"""Entries of the cache on their way to another host: told apart by contents, and nothing but themselves."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from dse.cache import CacheWarning
from dse.errors import DseError
from dse.exploration.remote import entries
from dse.exploration.remote.entries import digest_of_entry, found, receive_entry, sent
from dse.formats import pack_zip


@pytest.fixture(autouse=True)
def there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The cache of the host that receives."""
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "there"))
    monkeypatch.setattr(entries, "_known", {})
    return tmp_path / "there"


@pytest.fixture
def fmu(tmp_path: Path) -> Path:
    folder = tmp_path / "here" / "unpacked" / "0123"
    (folder / "resources").mkdir(parents=True)
    (folder / "binaries").mkdir()
    (folder / "binaries" / "radar.so").write_bytes(bytes(range(256)) * 100)
    return folder


@pytest.fixture
def library(tmp_path: Path) -> Path:
    (tmp_path / "here" / "fused").mkdir(parents=True)
    (tmp_path / "here" / "fused" / "acc.so").write_bytes(b"ELF")
    return tmp_path / "here" / "fused" / "acc.so"


def test_a_folder_arrives_as_it_is_with_its_empty_folders(fmu: Path, there: Path) -> None:
    digest = digest_of_entry(fmu)
    assert found("unpacked/0123", digest) is None
    receive_entry(digest, sent(fmu))
    place = found("unpacked/0123", digest)
    assert place == there / "received" / digest
    assert (place / "resources").is_dir()
    assert (place / "binaries" / "radar.so").read_bytes() == (fmu / "binaries" / "radar.so").read_bytes()


def test_a_file_arrives_under_its_name(library: Path, there: Path) -> None:
    digest = digest_of_entry(library)
    receive_entry(digest, sent(library))
    assert found("fused/acc.so", digest) == there / "received" / digest / "acc.so"


def test_what_the_host_has_itself_is_taken_if_it_is_the_same(library: Path, there: Path) -> None:
    digest = digest_of_entry(library)
    (there / "fused").mkdir(parents=True)
    (there / "fused" / "acc.so").write_bytes(b"ELF of another compiler")
    assert found("fused/acc.so", digest) is None
    (there / "fused" / "acc.so").write_bytes(b"ELF")
    assert found("fused/acc.so", digest) == there / "fused" / "acc.so"


def test_what_was_received_and_is_damaged_is_received_again(fmu: Path, there: Path) -> None:
    digest = digest_of_entry(fmu)
    receive_entry(digest, sent(fmu))
    (there / "received" / digest / "binaries" / "radar.so").write_bytes(b"")
    assert found("unpacked/0123", digest) is None
    with pytest.warns(CacheWarning, match="is damaged"):
        receive_entry(digest, sent(fmu))
    assert found("unpacked/0123", digest) is not None


def test_something_else_is_refused_and_leaves_nothing(fmu: Path, library: Path, there: Path) -> None:
    with pytest.raises(DseError, match="is something else"):
        receive_entry(digest_of_entry(fmu), sent(library))
    assert list((there / "received").iterdir()) == []


@pytest.mark.parametrize("digest", ["../../etc", "0" * 31, "0" * 31 + "/", "/" + "0" * 31, "A" * 32])
def test_a_name_from_the_network_is_no_path(digest: str, library: Path, there: Path) -> None:
    with pytest.raises(DseError, match="is not a digest"):
        receive_entry(digest, sent(library))
    assert not there.exists()


def test_paths_that_lead_out_of_an_entry_are_refused(there: Path) -> None:
    content = zlib.compress(pack_zip({"../escaped": b"x"}))
    with pytest.raises(DseError, match="leads out of the entry"):
        receive_entry("0" * 32, content)
    assert not (there / "escaped").exists()
