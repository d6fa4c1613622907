"""Moments of a scene as pictures, and parts of it as films: what is asked, what comes, and what is refused by name."""

from __future__ import annotations

import os
import shutil
import stat
import sys

import numpy as np
import pytest
from PIL import Image
from scenes import made_up

from dse.errors import DseError
from dse.report import Shot, film, require_target, scene_page
from dse.report.page import pdf
from dse.report.scene import camera

thorough = pytest.mark.thorough


@pytest.fixture
def chromium() -> None:
    if not any(map(shutil.which, pdf.BROWSERS)):
        if os.environ.get("CI"):
            pytest.fail("films are tested with a Chromium")
        pytest.skip("no Chromium is installed")


@pytest.mark.parametrize(
    ("shot", "said"),
    [
        ({"size": (100, 700)}, "100x700 is not a size of a picture"),
        ({"size": (1280, 99999)}, "is not a size of a picture"),
        ({"view": "../../etc"}, "there is no camera '../../etc'"),
    ],
)
def test_what_cannot_be_shot_is_refused(shot, said) -> None:
    with pytest.raises(DseError, match=said):
        Shot(**shot)


@pytest.mark.parametrize(
    ("name", "rate", "said"),
    [
        ("a.jpg", None, "a picture of a scene is a PNG, not 'a.jpg'"),
        ("a.avi", 25.0, "a film is not written as 'a.avi'"),
        ("a.mp4", 25.0, "a .mp4 needs the program ffmpeg, which is not on the path"),
    ],
)
def test_what_cannot_be_written_is_refused_before_anything_is_simulated(tmp_path, monkeypatch, name, rate, said):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(DseError, match=said):
        require_target(tmp_path / name, Shot(rate=rate))


def test_without_a_chromium_it_says_what_is_missing(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CHROMIUM", raising=False)
    with pytest.raises(DseError, match="a picture of a scene needs a Chromium: none of chromium"):
        film("<html></html>", Shot(), tmp_path / "a.png")


def program(path, text):
    path.write_text(f"#!{sys.executable}\n{text}", encoding="utf-8")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


@pytest.mark.parametrize("text", ["", "import os; os.write(4, b'nonsense\\0')", "import os; os.write(4, b'[1]\\0')"])
def test_a_browser_that_ends_or_talks_nonsense_is_told_by_name(tmp_path, monkeypatch, text) -> None:
    monkeypatch.setenv("CHROMIUM", str(program(tmp_path / "odd", text)))
    with pytest.raises(DseError, match="odd: the browser does not answer"):
        film("<html></html>", Shot(), tmp_path / "a.png")


def test_a_browser_that_says_nothing_is_not_waited_for_for_ever(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(camera, "_PATIENCE", 0.2)
    monkeypatch.setenv("CHROMIUM", str(program(tmp_path / "mute", "import time; time.sleep(600)")))
    with pytest.raises(DseError, match="nothing within"):
        film("<html></html>", Shot(), tmp_path / "a.png")


@thorough
def test_a_picture_has_its_size_and_shows_its_moment(tmp_path, chromium) -> None:
    page = scene_page(made_up())
    told = {}
    for view, at in (("chase", 2.0), ("chase", 7.0), ("top", 2.0)):
        assert film(page, Shot(at=at, view=view, size=(640, 360)), tmp_path / "a.png") == 1
        told[view, at] = np.asarray(Image.open(tmp_path / "a.png").convert("RGB"))
    assert {picture.shape for picture in told.values()} == {(360, 640, 3)}
    assert not np.array_equal(told["chase", 2.0], told["chase", 7.0])
    assert not np.array_equal(told["chase", 2.0], told["top", 2.0])
    film(page, Shot(at=2.0, size=(640, 360)), tmp_path / "b.png")
    assert np.array_equal(told["chase", 2.0], np.asarray(Image.open(tmp_path / "b.png").convert("RGB")))


@thorough
def test_films_have_a_frame_for_each_moment(tmp_path, chromium) -> None:
    page, shot = scene_page(made_up()), Shot(at=4.0, until=4.5, rate=8, size=(320, 200))
    heard: list[str] = []
    for name in ("a.webp", "a.gif"):
        assert film(page, shot, tmp_path / name, heard.append) == 5
        with Image.open(tmp_path / name) as moving:
            assert moving.n_frames == 5
            assert moving.size == (320, 200)
    assert heard[4] == "frame 5 of 5"
    assert film(page, shot, tmp_path / "frames") == 5
    assert sorted(path.name for path in (tmp_path / "frames").iterdir())[::4] == ["frame_00001.png", "frame_00005.png"]


@thorough
def test_a_video_is_what_ffmpeg_makes_of_the_frames_and_its_complaint_is_told(tmp_path, monkeypatch, chromium) -> None:
    fake = tmp_path / "bin"
    fake.mkdir()
    read = "import sys; n = sys.stdin.buffer.read().count(b'IEND'); print(n, sys.argv[7], file=open(sys.argv[-1], 'w'))"
    program(fake / "ffmpeg", read)
    monkeypatch.setenv("PATH", f"{fake}{os.pathsep}{os.environ['PATH']}")
    shot = Shot(at=9.5, rate=4, size=(320, 200))  # to the end of the run
    assert film(scene_page(made_up()), shot, tmp_path / "a.mp4") == 3
    assert (tmp_path / "a.mp4").read_text() == "3 4\n"
    program(fake / "ffmpeg", "import sys; sys.exit('no such encoder')")
    with pytest.raises(DseError, match=r"ffmpeg could not write b\.webm: no such encoder"):
        film(scene_page(made_up()), shot, tmp_path / "b.webm")
    assert not (tmp_path / "b.webm").exists()


@thorough
@pytest.mark.parametrize(
    ("shot", "said"),
    [
        (Shot(at=10.5), "the run is over at 10 s, before 10.5 s"),
        (Shot(at=5, until=4, rate=25), "the film ends at 4 s, before it begins at 5 s"),
    ],
)
def test_a_moment_that_is_not_in_the_run_is_refused(tmp_path, chromium, shot, said) -> None:
    with pytest.raises(DseError, match=said):
        film(scene_page(made_up()), shot, tmp_path / ("a.png" if shot.rate is None else "a.webp"))
    assert not any(tmp_path.glob("*.webp"))
