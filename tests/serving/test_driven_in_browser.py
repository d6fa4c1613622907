"""A test drive as a person makes it: page, server and car are the real ones."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from chromium import started_chromium

from dse.api import Drives, Results, open as open_workspace
from dse.serving.application import application
from dse.serving.drives import LiveDrives
from dse.serving.study_index import StudyIndex

ROOT = Path(__file__).parents[2]
PATIENCE = 120_000  # ms: everything is built first


@pytest.mark.browser
@pytest.mark.thorough
def test_a_car_is_chosen_driven_and_braked_behind_another_and_its_report_opened(
    served, tmp_path: Path, built_before: Callable[[Path], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DSE_CACHE", str(built_before(tmp_path / "cache")))
    workspace, folder = open_workspace(ROOT), tmp_path / "drives"
    folder.mkdir()
    on = LiveDrives(workspace, Drives(folder, workspace.files), 1)
    with on, served(application(StudyIndex(folder), drives=on)) as client, started_chromium() as browser:
        page = browser.new_page(viewport={"width": 800, "height": 500})
        page.set_default_timeout(PATIENCE)
        problems: list[str] = []
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.goto(f"http://127.0.0.1:{client.port}/drive#bench=drive_following")
        page.get_by_role("button", name="Battery-electric drive on the rear axle, idealised").click()
        page.get_by_role("button", name="Choose the rest for me").click()
        page.fill("#driver", "Ada")
        page.click("button.go:not([disabled])")
        page.wait_for_function("() => document.documentElement.dataset.frames > 2")
        at_first = float(page.text_content(".digits b"))
        page.keyboard.down("Space")
        page.wait_for_function(f"() => Number(document.querySelector('.digits b').textContent) < {at_first - 20}")
        page.keyboard.up("Space")
        page.keyboard.press("End")
        page.wait_for_selector(".verdicts .badge")
        page.get_by_role("link", name="Open the report").click()
        page.wait_for_url("**/study/drive_following/**")
        page.wait_for_function("() => document.body.textContent.includes('Ada')")
        assert problems == []
    kept = Drives(folder, workspace.files)
    (drive,) = kept.recorded().values()
    assert drive.driver == "Ada"
    assert drive.inputs["brake"].max() == 1
    (checked,) = kept.check()
    assert checked.was_noted
    assert checked.is_same, checked
    nobody, ada = (Results(folder / "drive_following").run(number).waveforms.to_pandas() for number in (0, 1))
    assert ada["scene.gap"].iloc[0] == nobody["scene.gap"].iloc[0] < 100
    assert ada["scene.gap"].iloc[-1] > nobody["scene.gap"][ada.index[-1]]
