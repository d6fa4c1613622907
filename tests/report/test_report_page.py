from __future__ import annotations

import base64
import dataclasses
import hashlib
import json
import re
from pathlib import Path

import numpy as np
import pytest

from dse.errors import DseError
from dse.report.content.data import ReportContent
from dse.report.figure import shown_figures
from dse.report.page import html as page
from dse.report.page.html import page_of, write_report
from dse.report.page.payload import payload_of
from dse.report.page.simulation import PageSimulation

HOSTILE = '</script><img src=x onerror="window.pwned=1"><!-- \'&amp;\u2028\u2029'


def hostile(content: ReportContent) -> ReportContent:
    """The content with markup wherever a user may write."""
    return dataclasses.replace(
        content,
        title=HOSTILE,
        study_folder=HOSTILE,
        facts=((HOSTILE, HOSTILE),),
        variables=tuple(dataclasses.replace(v, title=HOSTILE, unit_symbol=HOSTILE) for v in content.variables),
        metrics=tuple(dataclasses.replace(m, title=HOSTILE, unit_symbol=HOSTILE) for m in content.metrics),
        requirements=tuple(dataclasses.replace(r, title=HOSTILE) for r in content.requirements),
        figures=tuple(
            dataclasses.replace(f, title=HOSTILE, current_label=HOSTILE, target_label=HOSTILE, unit_symbol=HOSTILE)
            for f in content.figures
        ),
        runs=dataclasses.replace(content.runs, problems=tuple(HOSTILE if p else "" for p in content.runs.problems)),
    )


def test_the_same_content_gives_the_same_bytes(scattered: ReportContent, tmp_path: Path) -> None:
    for name in ("a.html", "b.html"):
        write_report(scattered, tmp_path / name)
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.html", "b.html"]


def test_markup_in_names_cannot_leave_its_element(sliced: ReportContent) -> None:
    content = hostile(sliced)
    text = page_of(content, shown_figures(content))
    assert "<img" not in text.split("<script>")[0]
    assert text.count("</script>") == page_of(sliced).count("</script>")
    document = re.search(r'id="document">(.*?)</script>', text, re.DOTALL)
    assert document is not None
    assert json.loads(document[1])["title"] == HOSTILE


def test_the_policy_names_the_page_s_own_code_and_nothing_else(sliced: ReportContent) -> None:
    text = page_of(sliced)
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)
    assert policy is not None
    assert "default-src 'none'" in policy[1]
    assert "unsafe" not in policy[1]
    for kind, tag in (("script-src", "script"), ("style-src", "style")):
        code = re.search(rf"<{tag}>(.*?)</{tag}>", text, re.DOTALL)
        assert code is not None
        digest = base64.b64encode(hashlib.sha256(code[1].encode()).digest()).decode()
        assert f"{kind} 'sha256-{digest}'" in policy[1]


def test_a_page_that_simulates_may_start_workers_and_compile_modules_and_nothing_else(sliced: ReportContent) -> None:
    policies = []
    for simulation in (None, PageSimulation({"study": HOSTILE}, b"module")):
        text = page_of(sliced, simulation=simulation)
        found = re.search(r'Content-Security-Policy" content="([^"]*)"', text)
        assert found is not None
        policies.append(found[1])
    plain, simulating = ({part.strip() for part in policy.split(";")} for policy in policies)
    scripts = next(part for part in plain if part.startswith("script-src"))
    assert simulating - plain == {f"{scripts} 'wasm-unsafe-eval'", "worker-src blob:"}
    assert plain - simulating == {scripts}


def test_the_page_names_no_address_to_load_from(sliced: ReportContent) -> None:
    head = page_of(sliced).split("<script>")[0]
    assert not re.search(r'(src|href)="(?!data:)', head)


def test_every_waveform_states_how_exact_it_is(sliced: ReportContent) -> None:
    facts = json.loads(payload_of(sliced).document)["facts"]
    stated = [value for key, value in facts if key.startswith("waveform")]
    assert len(stated) == 2
    assert all(re.search(r"120 of 242 runs, 16-bit steps, largest error [\d.e-]+ (m|km/h)$", value) for value in stated)


def test_a_study_with_undefined_metrics_still_gives_valid_json(sliced: ReportContent) -> None:
    metrics = tuple(dataclasses.replace(m, values=np.full_like(m.values, np.nan)) for m in sliced.metrics)
    json.loads(payload_of(dataclasses.replace(sliced, metrics=metrics)).document)


def test_a_missing_bundle_says_how_to_build_it(
    sliced: ReportContent, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page, "files", lambda _: tmp_path)
    with pytest.raises(DseError, match="npm run build"):
        page_of(sliced)


def test_a_place_that_cannot_be_written_is_named(sliced: ReportContent, tmp_path: Path) -> None:
    with pytest.raises(DseError, match=r"cannot write .*missing"):
        write_report(sliced, tmp_path / "missing" / "report.html")


def test_a_thousand_runs_with_waveforms_stay_below_the_size_of_a_photograph(sliced: ReportContent) -> None:
    assert len(page_of(sliced, shown_figures(sliced))) < 600_000


def test_a_slice_of_one_variable_offers_no_plane(sliced: ReportContent) -> None:
    name = sliced.variables[0].name
    document = payload_of(dataclasses.replace(sliced, slices=((name,), *sliced.slices))).document
    assert json.loads(document)["slices"] == json.loads(payload_of(sliced).document)["slices"]
