"""The page of the test drive in a browser: choosing a car, driving it, what comes of it; the server is a fake."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

import pytest
from background import LIMIT
from chromium import started_chromium
from fake_drives import EVIL, FakeDrives, served

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def browser() -> Iterator[object]:
    with started_chromium() as started:
        yield started


@pytest.fixture
def opened(browser):
    contexts, servers = [], []

    def open_page(fragment: str = "", drives: FakeDrives | None = None, **context):
        serving = served(drives or FakeDrives())
        servers.append(serving)
        shown = serving.__enter__()
        contexts.append(browser.new_context(**({"viewport": {"width": 900, "height": 640}} | context)))
        page = contexts[-1].new_page()
        problems: list[str] = []
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("console", lambda told: problems.append(told.text) if "Content Security" in told.text else None)
        page.goto(f"{shown.address}#{fragment}")
        page.wait_for_selector(".alternative")
        return SimpleNamespace(page=page, drives=shown, problems=problems)

    yield open_page
    for context in contexts:
        context.close()
    for serving in servers:
        serving.__exit__(None, None, None)


CAR = "bench=drive_following&chosen=drive:small,sensor:radar"


def begin(it) -> None:
    it.page.click("button.go:not([disabled])")
    it.page.wait_for_function("() => document.documentElement.dataset.frames > 2")


def heard(it, name: str, kind: str = "control") -> list[float]:
    return [told["values"][name] for told in it.drives.heard if told["type"] == kind and name in told["values"]]


def wait_for(it, that) -> None:
    for _ in range(int(LIMIT / 0.05)):
        if that():
            return
        it.page.wait_for_timeout(50)
    pytest.fail(f"not within {LIMIT:g} s; heard {it.drives.heard[-5:]}")


def test_only_what_can_be_built_can_be_chosen_and_the_page_says_why(opened):
    it = opened()
    page = it.page
    assert "excludes Lidar" in page.get_by_role("button", name="One motor").text_content()
    assert page.locator(".go").is_disabled()
    page.get_by_role("button", name="One motor").click()
    page.wait_for_selector(".alternative.out")
    lidar = page.get_by_role("button", name="Lidar", exact=False)
    assert lidar.get_attribute("aria-disabled") == "true"
    assert "Not possible: A lidar needs the power of two motors." in lidar.text_content()
    assert page.text_content(".why") == ("A drive needs one car. Choose Sensor, or have the rest chosen for you.")
    lidar.click(force=True)
    page.get_by_role("button", name="Change Drive to get this").click()
    page.wait_for_function("() => document.querySelector('.go:not([disabled])')")
    assert page.locator("[aria-pressed=true] .name").all_text_contents() == ["Two motors", "Lidar", "Four discs"]
    radar = page.get_by_role("button", name="Long-range radar")
    assert radar.locator(".more").text_content() == "\u2212650 EUR \u00b7 +0.5 kg"
    assert page.locator(".why").is_hidden()
    page.get_by_role("button", name="One motor").click(force=True)
    page.get_by_role("button", name="Change Sensor to get this").click()
    page.wait_for_selector(".go[disabled]")
    page.get_by_role("button", name="Long-range radar").click()
    page.wait_for_selector(".go:not([disabled])")
    assert page.locator(".count").text_content() == "1 possible car of 49,400"
    assert page.locator(".totals dd").all_text_contents() == ["21,400 EUR", "1,480 kg"]
    assert "sensor%3Aradar" in page.locator("a.share").get_attribute("href")
    page.get_by_role("button", name="Long-range radar").click()  # not any more
    page.wait_for_selector(".go[disabled]")
    assert it.problems == []


def test_a_shared_link_has_the_same_car_on_the_same_road(opened):
    it = opened(CAR.replace("drive_following", "town"))
    it.page.wait_for_selector(".go:not([disabled])")
    assert it.page.input_value("#bench") == "town"
    assert it.page.locator("[aria-pressed=true] .name").all_text_contents() == [
        "One motor",
        "Long-range radar, 77 GHz",
        "Four discs",
    ]


def test_the_rest_is_chosen_for_those_who_only_want_to_drive(opened):
    it = opened()
    it.page.get_by_role("button", name="Choose the rest for me").click()
    it.page.wait_for_selector(".go:not([disabled])")


def test_a_car_is_chosen_driven_braked_and_its_result_opened(opened):
    it = opened(CAR)
    page = it.page
    page.fill("#driver", EVIL)
    begin(it)
    assert it.drives.orders[-1]["driver"] == EVIL
    assert it.drives.orders[-1]["bench"] == "drive_following"
    page.keyboard.press("c")
    page.get_by_text("active", exact=True).wait_for()
    page.keyboard.press("+")
    page.keyboard.press("g")
    page.keyboard.down("ArrowUp")
    wait_for(it, lambda: heard(it, "accelerator")[-1:] == [1])
    page.keyboard.up("ArrowUp")
    page.keyboard.down("a")
    wait_for(it, lambda: heard(it, "steering")[-1] > 0.3)
    page.keyboard.up("a")
    wait_for(it, lambda: heard(it, "steering")[-1] == 0 and heard(it, "hands_on")[-1] == 0)
    page.keyboard.down("Space")
    page.get_by_text("you accelerate", exact=True).wait_for()
    wait_for(it, lambda: heard(it, "brake")[-1] == 1)
    page.wait_for_function("() => Number(document.querySelector('.digits b').textContent) < 20")
    page.keyboard.up("Space")
    # Gently, and the hands stay on the wheel while it turns back.
    assert len({value for value in heard(it, "accelerator") if 0 < value < 1}) > 5
    assert heard(it, "set_speed")[-1] == pytest.approx(115 / 3.6)
    assert heard(it, "gap_setting")[-1] == 3
    assert "echo" in page.text_content(".pace")
    page.keyboard.press("End")
    page.wait_for_selector(".ending")
    assert page.locator(".verdicts .badge").all_text_contents() == ["pass", "fail", "not exercised"]
    page.wait_for_selector(".boards td")
    assert page.locator("img").count() == 0
    assert page.locator(".boards tr.mine .badge").all_text_contents() == ["R1 pass ", "R2 fail "]
    against = page.locator(".boards tr.mine").get_by_role("link", name="against the controller")
    assert against.get_attribute("href") == "/study/drive_following/#run=1&pins=0"
    assert it.problems == []
    page.get_by_role("link", name="Open the report").click()
    page.wait_for_url("**/drive/results/17")


@pytest.mark.parametrize("size", [(1440, 900), (1280, 720), (1000, 700), (900, 700), (400, 800)])
def test_modes_pedals_and_numbers_have_each_a_place_of_their_own(opened, size):
    it = opened(CAR, viewport={"width": size[0], "height": size[1]})
    begin(it)
    each = it.page.locator(".gauges > *, .modes dt, .modes dd").evaluate_all(
        "nodes => nodes.filter(node => node.getClientRects().length && !node.matches('.modes')).map(node => {"
        " const {x, y, width, height} = node.getBoundingClientRect(); return [x, y, x + width, y + height]; })"
    )
    assert len(each) > 6
    for number, (left, top, right, bottom) in enumerate(each):
        assert left >= 0
        assert right <= size[0]
        for other in each[:number]:
            beside = right <= other[0] + 0.5 or other[2] <= left + 0.5
            assert beside or bottom <= other[1] + 0.5 or other[3] <= top + 0.5


def test_what_is_said_in_a_second_is_bounded_and_nothing_is_said_while_nothing_changes(opened):
    it = opened(CAR)
    begin(it)
    for _ in range(60):  # what was said at the beginning may still come
        before = len(it.drives.heard)
        it.page.wait_for_timeout(500)
        if len(it.drives.heard) == before:
            break
    else:
        pytest.fail("it never is silent")
    began = it.page.evaluate("performance.now()")
    it.page.keyboard.down("ArrowRight")
    it.page.wait_for_timeout(300)
    it.page.keyboard.up("ArrowRight")
    wait_for(it, lambda: heard(it, "steering")[-1] == 0)
    seconds = (it.page.evaluate("performance.now()") - began) / 1000
    assert len(it.drives.heard) - before < 60 * max(1.0, seconds)
    assert {"type", "n", "values"} == set(it.drives.heard[-1])
    assert [told["n"] for told in it.drives.heard] == [*range(1, len(it.drives.heard) + 1)]


def test_gains_are_tuned_while_driving_and_arrows_on_a_slider_do_not_steer(opened):
    it = opened(CAR)
    begin(it)
    it.page.click(".tuning summary")
    slider = it.page.get_by_role("slider", name="Speed gain")
    slider.fill("2.5")
    wait_for(it, lambda: heard(it, "controller.kp", "tune") == [2.5])
    slider.focus()
    it.page.keyboard.press("ArrowLeft")
    wait_for(it, lambda: len(heard(it, "controller.kp", "tune")) == 2)
    assert set(heard(it, "steering")) == {0}


def test_a_drive_that_dies_says_so_in_words_and_the_page_can_go_on(opened):
    it = opened(CAR, FakeDrives(dies_at=0.5))
    it.page.click("button.go:not([disabled])")
    it.page.wait_for_selector(".ending")
    assert it.page.text_content(".ending [role=status]") == "Chassis: its process ended by SIGSEGV at 2 s."
    assert it.page.get_by_role("link", name="Open the report").count() == 0
    it.drives.dies_at = 1e9
    it.page.get_by_role("button", name="Drive again").click()
    it.page.wait_for_selector(".gauges")
    it.page.get_by_role("button", name="Finish").click()
    it.page.wait_for_selector(".ending")
    it.page.get_by_role("button", name="Same car, other road").click()
    it.page.wait_for_selector(".go:not([disabled])")
    assert it.problems == []


def test_a_server_that_refuses_a_drive_is_heard(opened):
    it = opened(CAR, FakeDrives(refuses="8 drives are already running"))
    it.page.click("button.go:not([disabled])")
    it.page.get_by_text("The request failed: 8 drives are already running").wait_for()
    it.page.wait_for_selector("button.go:not([disabled])")


def test_fingers_drive_where_there_is_no_keyboard(opened):
    it = opened(CAR, has_touch=True, is_mobile=True, viewport={"width": 400, "height": 800})
    begin(it)
    pedal = it.page.get_by_role("button", name="Go")
    for kind, what in (("pointerdown", 1), ("pointerup", 0)):
        box = pedal.bounding_box()
        at = {"clientX": box["x"] + 5, "clientY": box["y"] + 5}
        pedal.evaluate("node => { node.setPointerCapture = () => {}; }")
        pedal.dispatch_event(kind, {"pointerId": 1, "bubbles": True, **at})
        wait_for(it, lambda what=what: heard(it, "accelerator")[-1:] == [what])
    assert it.page.locator(".touch .wheel").is_visible()


@pytest.mark.parametrize("width", [1440, 900, 400])
def test_nothing_reaches_beyond_the_window_and_no_two_panels_meet(opened, width):
    it = opened(CAR, viewport={"width": width, "height": 800}, has_touch=width == 400, is_mobile=width == 400)
    page = it.page
    page.wait_for_selector(".boards td")
    fits = "() => document.documentElement.scrollWidth <= innerWidth"
    assert page.evaluate(fits)
    begin(it)
    assert page.evaluate(fits)
    boxes = [page.locator(each).bounding_box() for each in (".tools", ".panels", ".gauges", ".touch", ".drive header")]
    boxes = [box for box in boxes if box and box["height"]]
    assert len(boxes) == (5 if width == 400 else 4)
    for number, one in enumerate(boxes):
        assert one["x"] >= 0
        assert one["x"] + one["width"] <= width
        for other in boxes[:number]:
            apart_x = one["x"] + one["width"] <= other["x"] or other["x"] + other["width"] <= one["x"]
            assert apart_x or one["y"] + one["height"] <= other["y"] or other["y"] + other["height"] <= one["y"]
    page.locator(".finish").click()
    page.wait_for_selector(".boards td")
    assert page.evaluate(fits)


def test_the_button_that_starts_is_in_reach_on_a_phone_and_says_what_is_missing(opened):
    it = opened(viewport={"width": 400, "height": 560}, has_touch=True, is_mobile=True)
    page = it.page
    start = page.locator(".go")
    assert page.evaluate("document.documentElement.scrollHeight > 1.2 * innerHeight")
    for share in (0, 0.5, 1):
        page.evaluate("share => scrollTo(0, share * document.documentElement.scrollHeight)", share)
        box = start.bounding_box()
        assert 0 <= box["y"] <= box["y"] + box["height"] <= 560
        assert page.evaluate(
            "([x, y]) => Boolean(document.elementFromPoint(x, y).closest('.go'))", [200, box["y"] + 20]
        )
    assert page.locator(".start .why").is_visible()


WHEEL = """() => {
  window.axes = [0, 0, 0];
  const wheel = { id: "A wheel", index: 0, mapping: "", buttons: [], connected: true };
  navigator.getGamepads = () => [null, { ...wheel, axes: [...axes] }];
}"""


def test_a_steering_wheel_is_calibrated_in_the_help_and_drives(opened):
    it = opened(CAR)
    page = it.page
    page.evaluate(f"({WHEEL})()")
    begin(it)
    page.keyboard.press("h")
    steps = page.get_by_role("region", name="Steering wheel")
    steps.get_by_role("button", name="Start").click()
    for axes in ([-1, 0, 0], [0.9, 0, 0], [0, -1, 0], [0, 1, -1], [0, 1, 1]):
        page.evaluate("to => { axes = to; }", axes)
        steps.get_by_role("button", name="Next").click()
    assert steps.get_by_role("status").text_content() == "A wheel is calibrated."
    page.get_by_role("button", name="Resume").click()
    page.evaluate("axes = [-1, 0, 1]")
    wait_for(it, lambda: heard(it, "accelerator")[-1:] == [0.5] and heard(it, "steering")[-1] == 0.5)
    page.evaluate("axes = [-0.05, 1, -1]")
    wait_for(it, lambda: heard(it, "accelerator")[-1] == 0 and heard(it, "brake")[-1] == 1)
    page.reload()
    page.evaluate(f"({WHEEL})()")
    page.wait_for_selector(".alternative")
    it.drives.heard.clear()
    begin(it)
    wait_for(it, lambda: heard(it, "accelerator"))
    page.wait_for_function("() => document.documentElement.dataset.frames > 9")
    # Nothing has moved yet: no pedal is pressed.
    assert {*heard(it, "accelerator"), *heard(it, "brake")} == {0}
    assert it.problems == []
