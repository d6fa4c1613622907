"""What the server shows of studies."""

from __future__ import annotations

import json
import math
import re
import shutil
import threading
from pathlib import Path

import pytest
from served_studies import add_run, store_study

from dse.serving import StudyIndex, application, open_studies
from dse.storage import StudyFolder, WriterLock


def test_the_list_tells_of_every_study_how_it_is(client) -> None:
    text = client.get("/").text
    first = text.split('value="out/first"')[1].split("</tr>")[0]
    words = re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", first))
    assert "3 of 4" in words
    assert "1 pass" in words
    assert "1 fail" in words
    assert "1 failed to run" in words
    assert "interrupted" in words
    assert "gains on following" in words
    assert "study.sqlite is damaged" in text


def test_names_are_text(client) -> None:
    for path in ("/", "/compare?a=out/first&b=out/second", "/study/<script>alert(1)</script>/"):
        assert "<script>alert" not in client.get(path).text


def test_an_empty_folder_says_how_to_make_a_study(tmp_path: Path, served) -> None:
    with served(application(StudyIndex(tmp_path))) as client:
        assert "dse explore" in client.get("/").text


def test_the_report_is_that_of_the_file_and_knows_whom_to_ask(client) -> None:
    answer = client.get("/study/out/first/")
    assert answer.status == 200
    live = re.search(r'id="live">(.*?)</script>', answer.text)
    assert live is not None
    assert json.loads(live[1])["runs"] == 3
    assert json.loads(live[1])["query"] == "study=out%2Ffirst"


@pytest.mark.parametrize(
    "path",
    [
        "/study/../secret.txt/",
        "/study/..%2fsecret.txt/",
        "/study/out/",
        "/study//etc/",
        "/secret.txt",
        "/out/",
        "/study/out/first/study.sqlite/",
        "/study/%00/",
    ],
)
def test_no_path_leads_to_a_file(client, path: str) -> None:
    answer = client.get(path)
    assert answer.status == 404
    assert "secret\n" not in answer.text
    assert "SQLite format" not in answer.text


def test_a_page_is_made_once_until_there_are_other_runs(
    client, workshop: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []
    read = open_studies.read_report
    monkeypatch.setattr(open_studies, "read_report", lambda *given: made.append(given) or read(*given))
    pages = [client.get("/study/out/first/").text for _ in range(3)]
    assert len(made) == 1
    assert len({*pages}) == 1
    with StudyFolder.open(workshop / "out" / "first") as store:
        definition = store.header.definition
    with StudyFolder.resume(workshop / "out" / "first", definition) as folder:
        add_run(folder, 3, 0.25)
    assert client.get("/study/out/first/").text != pages[0]
    assert len(made) == 2


def test_progress_counts_and_never_makes_a_page(client, workshop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(open_studies, "read_report", lambda *_: pytest.fail("a page was made"))
    told = json.loads(client.get("/progress?study=out/first").text)
    assert told == {"state": "interrupted", "runs": 4, "finished": 3}


def test_while_somebody_writes_the_study_is_running(client, workshop: Path) -> None:
    with WriterLock(workshop / "out" / "second"):
        told = json.loads(client.get("/progress?study=out/second").text)
    assert told["state"] == "running"
    assert "process" in told["writer"]


def test_a_study_that_is_removed_or_damaged_meanwhile_is_told_by_name(client, workshop: Path) -> None:
    assert client.get("/study/out/first/").status == 200
    (workshop / "out" / "second" / "study.sqlite").write_bytes(b"torn")
    shutil.rmtree(workshop / "out" / "first")
    gone, torn = client.get("/study/out/first/"), client.get("/study/out/second/")
    assert (gone.status, torn.status) == (404, 404)
    assert "there is no such study here" in gone.text
    assert "is damaged" in torn.text
    assert (
        json.loads(client.get("/progress?study=out/first").text)["problems"][0]["what"] == "there is no such study here"
    )
    assert client.get("/").status == 200


def test_two_studies_show_what_flipped(client) -> None:
    text = client.get("/compare?a=out/first&b=out/second").text
    words = re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", text.split("<main")[1]))
    assert "Nothing in their definitions differs" in words
    assert "1 of their verdicts differ" in words
    assert "R1 fail pass 1" in words


@pytest.mark.parametrize("query", ["", "a=out/first", "a=out/first&b=out/first", "a=out/first&b=nothing"])
def test_what_cannot_be_compared_is_told(client, query: str) -> None:
    answer = client.get(f"/compare?{query}")
    assert answer.status == 404
    assert "problem" in answer.text


@pytest.mark.parametrize(
    "body",
    [
        None,
        [],
        {},
        {"configuration": "c1"},
        {"configuration": 1, "point": {}},
        {"configuration": "c1", "point": [1]},
        {"configuration": "c1", "point": {"controller.kp": "x"}},
        {"configuration": "c1", "point": {"controller.kp": math.inf}},
    ],
)
def test_what_is_no_point_is_not_simulated(client, body: object) -> None:
    answer = client.post("/simulate?study=out/first", body)
    assert answer.status == 409
    assert "the request is invalid" in answer.text


def test_a_point_that_does_not_fit_the_study_is_refused_by_name(client) -> None:
    def told(configuration: str, **point: float) -> str:
        return client.post("/simulate?study=out/first", {"configuration": configuration, "point": point}).text

    assert "no configuration 'c9'" in told("c9")
    assert "there is no value for 'controller.kp'" in told("c1")
    assert "'chassis.mass' is not a design variable" in told("c1", **{"controller.kp": 0.5, "chassis.mass": 1.0})


def test_while_one_point_is_simulated_another_one_waits_and_the_end_of_the_server_does_not(
    workshop: Path, served, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, released = threading.Event(), threading.Event()

    def slow(*_: object, **__: object) -> None:
        begun.set()
        released.wait(60)

    monkeypatch.setattr("dse.serving.point_requests.what_if_run", slow)
    point = {"configuration": "c1", "point": {"controller.kp": 0.5}}
    with served(application(StudyIndex(workshop))) as client:
        first = threading.Thread(target=client.post, args=("/simulate?study=out/first", point))
        first.start()
        assert begun.wait(30)
        assert client.get("/progress?study=out/first").status == 200
        second = client.post("/simulate?study=out/first", point)
    # The server has ended, and the point is still being simulated.
    assert not released.is_set()
    assert second.status == 429
    assert "another run is being simulated" in second.text
    released.set()
    first.join()


def test_nobody_is_stopped_where_nobody_explores(client) -> None:
    answer = client.post("/stop?study=out/first", {})
    assert answer.status == 409
    assert "no process explores this study" in answer.text


def test_studies_can_have_any_name(tmp_path: Path, served) -> None:
    name = 'a "b" <i>&%2f ü'
    store_study(tmp_path / name, [0.5])
    with served(application(StudyIndex(tmp_path))) as client:
        link = re.search(r'href="(/study/[^"]*)"', client.get("/").text)
        assert link is not None
        answer = client.get(link[1])
        assert answer.status == 200
        query = json.loads(re.search(r'id="live">(.*?)</script>', answer.text)[1])["query"]
        assert json.loads(client.get(f"/progress?{query}").text)["finished"] == 1
