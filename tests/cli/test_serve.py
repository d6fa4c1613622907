"""``dse serve`` and ``dse compare`` as a user starts them."""

from __future__ import annotations

import http.client
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from chromium import rest


@pytest.fixture
def serve(cache: Path, example: Path) -> Callable[..., object]:
    """Starts ``dse serve``; gives the process and the address it has printed."""

    @contextmanager
    def started(*arguments: str, folder: Path = example) -> Iterator[tuple[subprocess.Popen[str], str]]:
        command = [sys.executable, "-m", "dse", "serve", *arguments]
        environment = {**os.environ, "DSE_CACHE": str(cache)}
        pipe = subprocess.PIPE
        with subprocess.Popen(command, cwd=folder, env=environment, stdout=pipe, stderr=pipe, text=True) as process:
            assert process.stdout is not None
            try:
                yield process, process.stdout.readline().strip()
            finally:
                process.kill()

    return started


def fetched(address: str, path: str, data: object = None) -> tuple[int, str]:
    host = address.split("/")[2]
    connection = http.client.HTTPConnection(host, timeout=300)
    headers = {"Origin": f"http://{host}", "Content-Type": "application/json"} if data is not None else {}
    connection.request("GET" if data is None else "POST", path, None if data is None else json.dumps(data), headers)
    answer = connection.getresponse()
    found = answer.status, answer.read().decode("utf-8")
    connection.close()
    return found


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform == "win32", reason="interrupts are sent otherwise there")
def test_a_study_is_served_until_ctrl_c(serve, explored) -> None:
    with serve(str(explored), "--port", "0") as (process, address):
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/", address)
        assert "small" in fetched(address, "/")[1]
        assert fetched(address, "/study/small/")[0] == 200
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        assert process.returncode == 130
        assert "Traceback" not in errors
        assert errors.splitlines()[-1] == "stopped"


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform == "win32", reason="interrupts are sent otherwise there")
def test_a_running_study_is_watched_stopped_and_its_points_are_simulated(serve, example, cache, tmp_path) -> None:
    small = (example / "testbenches" / "small.pet.yaml").read_text(encoding="utf-8")
    place = tmp_path / "work"
    shutil.copytree(example, place)
    long = small.replace("study: small", "study: long").replace("levels: 5", "levels: 2000")
    (place / "testbenches" / "long.pet.yaml").write_text(long, encoding="utf-8")
    command = [sys.executable, "-m", "dse", "explore", "long", "-o", "out/long", "-j", "1"]
    environment = {**os.environ, "DSE_CACHE": str(cache)}
    with (
        subprocess.Popen(
            command, cwd=place, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        ) as explorer,
        serve(".", "--port", "0", folder=place) as (_, address),
    ):
        deadline, told = time.monotonic() + 200, {}
        while not told.get("finished") and time.monotonic() < deadline:
            status, text = fetched(address, "/progress?study=out/long")
            told = json.loads(text) if status == 200 else {}
            time.sleep(0.2)
        assert told["state"] == "running"
        assert told["runs"] == 8000
        assert f"process {explorer.pid}" in told["writer"]
        status, page = fetched(address, "/study/out/long/")
        assert status == 200
        configuration = json.loads(re.search(r'id="document">(.*?)</script>', page)[1])["configurations"][0]["id"]
        point = {"controller.kp_speed": 1.2345, "controller.kd_speed": 0.5}
        asked = {"configuration": configuration, "point": point}
        status, text = fetched(address, "/simulate?study=out/long", asked)
        tried = json.loads(text)
        assert (status, tried["done"], tried["changed"]) == (200, True, [])
        assert {row[2]: row[5] for row in tried["metrics"] if row[2]} == {"R1": "pass", "R2": "pass"}
        assert len(tried["figures"][0]["time"]) == len(tried["figures"][0]["values"]) > 100
        assert fetched(address, "/stop?study=out/long", {})[0] == 200
        assert b"the same command resumes from there" in explorer.communicate(timeout=120)[1]
        assert explorer.returncode == 130
        deadline = time.monotonic() + 120
        while (state := json.loads(fetched(address, "/progress?study=out/long")[1])["state"]) == "running":
            assert time.monotonic() < deadline
            time.sleep(0.2)
        assert state == "interrupted"


@pytest.mark.thorough
@pytest.mark.browser
def test_a_place_in_the_plot_is_simulated(serve, explored) -> None:
    from playwright.sync_api import sync_playwright

    found = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if found is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)("there is no Chromium")
    with serve(str(explored), "--port", "0") as (_, address), sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto(f"{address}study/small/")
        page.wait_for_selector("html[data-ready]")
        page.click("#try-open")
        box = page.locator(".plot").bounding_box()
        page.mouse.click(box["x"] + 0.43 * box["width"], box["y"] + 0.37 * box["height"])
        rest(page, 300)
        kp, kd = (float(page.input_value(f"#try input[name='controller.{name}']")) for name in ("kp_speed", "kd_speed"))
        assert kp not in (0.5, 1.5, 2.5, 3.5, 4.5)
        assert 0 < kd < 1
        page.click("#try-start")
        page.wait_for_selector("#try-metrics td.verdict.pass", timeout=60_000)
        assert page.locator("#try .uplot").count() == 2
        page.fill("#try input[name='controller.kp_speed']", "-1")
        page.click("#try-start")
        page.wait_for_selector("#try .problem", timeout=60_000)
        assert "kp_speed" in page.inner_text("#try .problem")
        browser.close()


def test_a_port_that_is_taken_is_told_with_the_way_out(dse, explored) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        done = dse("serve", str(explored), "--port", port)
    assert done.returncode == 1
    assert f"port {port} is taken" in done.stderr
    assert "--port" in done.stderr


@pytest.mark.parametrize("address", ["somewhere", "999.1.1.1", "localhost"])
def test_an_address_is_given_in_numbers(dse, explored, address) -> None:
    done = dse("serve", str(explored), "--listen", address)
    assert done.returncode == 1
    assert "is not an address to listen on" in done.stderr


@pytest.mark.thorough
def test_whoever_listens_elsewhere_gets_a_token(serve, explored) -> None:
    with serve(str(explored), "--port", "0", "--listen", "127.0.0.1") as (_, address):
        start, _, token = address.partition("?token=")
        assert len(token) >= 40
        assert fetched(start, "/")[0] == 401
        assert fetched(start, f"/?token={token}")[0] == 200


def test_a_folder_that_is_not_there_is_named(dse, tmp_path) -> None:
    done = dse("serve", str(tmp_path / "missing"))
    assert done.returncode == 1
    assert "there is no such folder" in done.stderr


@pytest.mark.thorough
def test_without_the_extra_its_name_is_told(explored) -> None:
    code = "import sys; sys.modules['starlette'] = None; from dse.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, "serve", str(explored)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "needs the packages starlette and uvicorn" in done.stderr
    assert "dse-workbench[serve]" in done.stderr


def test_two_studies_are_compared_in_words_and_as_json(dse, explored) -> None:
    done = dse("compare", str(explored), str(explored))
    assert done.returncode == 0, done.stderr
    assert "20 of 20 runs are in both; 0 verdicts on them flipped" in done.stdout
    told = json.loads(dse("compare", str(explored), str(explored), "--format", "json").stdout)
    assert [each["shared"] for each in told] == [20, 20]
    assert told[1]["changed"] == told[1]["flips"] == []


def test_one_study_is_not_compared(dse, explored) -> None:
    done = dse("compare", str(explored))
    assert done.returncode == 1
    assert "two studies or more" in done.stderr
