"""Replays that the server makes: once for all who ask, from no number that is none, and nothing is written."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from dse.api import Results
from dse.errors import fail
from dse.serving import StudyIndex, application

NOBODY = "out/first&run=0"


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The runs that were simulated for a page."""
    found: list[int] = []

    def page(_: Results, run: int, *, workspace, tell) -> str:
        tell("building FMUs")
        found.append(run)
        return f"<p>the page of {run}</p>"

    monkeypatch.setattr(Results, "scene_page", page)
    return found


def files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if not path.name.startswith("study.sqlite-")}


def test_a_replay_is_made_when_a_page_of_ours_asks_and_is_there_from_then_on(client, made, workshop) -> None:
    before = files(workshop)
    waiting = client.get("/study/out/first/replay/1")
    assert waiting.status == 200
    assert 'data-study="out/first" data-replay="1"' in waiting.text
    assert made == []  # a GET makes nothing
    assert client.post("/replay?study=out/first&run=1", {}).status == 200
    for _ in range(2):
        assert client.get("/study/out/first/replay/1").text == "<p>the page of 1</p>"
    client.post("/replay?study=out/first&run=1", {})
    assert made == [1]
    assert files(workshop) == before


def test_strangers_have_nothing_simulated(client, made) -> None:
    assert client.post(f"/replay?study={NOBODY}", {}, Origin="http://elsewhere.example").status == 403
    assert client.post(f"/replay?study={NOBODY}", {}, Host="elsewhere.example").status == 421
    assert made == []


@pytest.mark.parametrize(
    "run",
    ["-1", "1.5", "1e3", "%2e%2e", "..%2f..%2fsecret.txt", "0x1", "%D9%A3", "%00", "9" * 5000, "<script>", "1%0a"],
)
def test_what_is_no_number_of_a_run_is_refused(client, made, run: str) -> None:
    page = client.get(f"/study/out/first/replay/{run}")
    assert page.status in (404, 307)  # 307: to the study of that name, which is not there
    assert "<script>alert" not in page.text
    assert "secret\n" not in page.text
    assert client.get(f"/replay?study=out/first&run={run}").status == 409
    assert client.post(f"/replay?study=out/first&run={run}", {}).status == 409
    assert made == []


@pytest.mark.parametrize("study", ["out/none", "../work/out/first", "out/torn", ""])
def test_a_study_that_is_not_on_the_shelf_has_no_replays(client, made, study: str) -> None:
    assert client.get(f"/study/{study}/replay/0").status == 404
    assert client.post(f"/replay?study={study}&run=0", {}).status == 409
    assert made == []


def test_a_run_that_is_not_there_is_told(client, made) -> None:
    assert "there is no run 77" in client.get("/study/out/first/replay/77").text


def test_what_goes_wrong_is_told_and_can_be_tried_again(client, monkeypatch) -> None:
    def refused(*_: object, **__: object) -> str:
        raise fail("run 0 is no scene")

    monkeypatch.setattr(Results, "scene_page", refused)
    for _ in range(2):
        answer = client.post("/replay?study=out/first&run=0", {})
        assert answer.status == 409
        assert "run 0 is no scene" in answer.text


def test_one_run_is_simulated_at_a_time_and_who_waits_is_told_how_far_it_is(workshop, served, monkeypatch) -> None:
    begun, released = threading.Event(), threading.Event()

    def slow(_: Results, run: int, *, workspace, tell) -> str:
        tell("building FMUs")
        begun.set()
        released.wait(60)
        return f"{run}"

    monkeypatch.setattr(Results, "scene_page", slow)
    with served(application(StudyIndex(workshop))) as client:
        first = threading.Thread(target=client.post, args=("/replay?study=out/first&run=0", {}))
        first.start()
        assert begun.wait(30)
        assert "building FMUs" in client.get("/replay?study=out/first&run=0").text
        assert client.post("/replay?study=out/first&run=1", {}).status == 429
        released.set()
        first.join()
        assert client.get("/study/out/first/replay/0").text == "0"


def test_the_page_of_a_rating_leads_to_the_runs_and_runs_no_code(client, workshop) -> None:
    assert client.get("/rating.html").status == 409
    (workshop / "rating.html").write_text('<a href="out/first/report.html#run=1">5.0</a>', encoding="utf-8")
    assert '<a href="/rating.html">' in client.get("/").text
    page = client.get("/rating.html").text
    assert page.index("default-src 'none'") < page.index('<a href="out/first/report.html#run=1">')
    led = client.get("/out/first/report.html")
    assert (led.status, led.headers["location"]) == (307, "/study/out/first/")
    assert client.get("/out/first/replays/run_1.html").headers["location"] == "/study/out/first/replay/1"
