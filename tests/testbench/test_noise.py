"""Random parameters: each part has a stream of noise of its own, which follows from the run's draw."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from port_workspaces import write

import dse
from dse.api.studies.exploration import ExploreOptions, explore_into
from dse.domain.noise import DRAW, NoiseStream
from dse.domain.study import Shard
from dse.errors import DseError
from dse.loading import Workspace
from dse.storage import EXPORTS, StudyFolder, merge_studies, over_draws, shards_in
from dse.testbench import one_configuration
from dse.testbench.check import check_workspace
from dse.testbench.study import with_settings
from dse.testbench.wired_bench import wire_bench

FILES = {
    "components/interfaces.yaml": "interfaces: {gauge: {outputs: {y: m}}}\n",
    "components/noisy/component.yaml": """\
component: noisy
implements: gauge
source: {kind: c, files: [noisy.c], step: 100 ms}
parameters:
  level: {start: 1 m}
  deviation: {start: 1 m}
  seed: {start: 1, min: 0, type: int, random: true}
""",
    "components/noisy/noisy.h": """\
#pragma once
#include <stdint.h>
typedef struct {
    struct { double y; } out;
    struct { double level, deviation; int32_t seed; } par;
    uint64_t state;
} noisy;
void noisy_init(noisy *self);
void noisy_step(noisy *self);
""",
    "components/noisy/noisy.c": """\
#include "noisy.h"
/* A sum of twelve uniform numbers, from a linear congruential generator (Knuth's MMIX). */
void noisy_step(noisy *self)
{
    double sum = -6;
    for (int k = 0; k < 12; ++k) {
        self->state = self->state * 6364136223846793005u + 1442695040888963407u;
        sum += (double)(self->state >> 11) / 9007199254740992.0;
    }
    self->out.y = self->par.level + self->par.deviation * sum;
}
void noisy_init(noisy *self) { self->state = (uint64_t)self->par.seed; noisy_step(self); }
""",
    "components/quiet/component.yaml": """\
component: quiet
implements: gauge
source: {kind: c, files: [quiet.c], step: 100 ms}
""",
    "components/quiet/quiet.h": """\
#pragma once
typedef struct { struct { double y; } out; } quiet;
void quiet_init(quiet *self);
void quiet_step(quiet *self);
""",
    "components/quiet/quiet.c": """\
#include "quiet.h"
void quiet_step(quiet *self) { (void)self; }
void quiet_init(quiet *self) { self->out.y = 1; }
""",
    "designs/pair.yaml": """\
design: pair
root: {compound: {left: {alternatives: [noisy, quiet]}, right: {alternatives: [noisy, quiet]}}}
""",
    "testbenches/b.yaml": """\
testbench: b
design: pair
simulation: {stop: 10 s, step: 100 ms, record: [left.y, right.y]}
metrics: {lowest: minimum(left.y), apart: mean(left.y) - mean(right.y)}
requirements: {R1: {metric: lowest, at_least: -1.5 m, met_in: 60 %}}
""",
    "testbenches/s.pet.yaml": """\
study: s
testbench: b
design_variables: {left.level: {range: [0.5 m, 1 m], levels: 4}}
replicates: 6
keep_waveforms: all
""",
}
FILES["testbenches/q.pet.yaml"] = (
    FILES["testbenches/s.pet.yaml"]
    .replace("study: s", "study: q")
    .replace(
        "replicates: 6", "replicates: {at_least: 3, at_most: 30}\nconditions: {left.deviation: {values: [0.5 m, 1 m]}}"
    )
)


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("noise"), FILES)


def identity(root: Path, left: str, right: str) -> str:
    return next(
        each.id for each in dse.open(root).designs["pair"].sample(60) if each.choices == {"left": left, "right": right}
    )


def test_each_part_is_the_place_of_a_stream_of_its_own(root: Path) -> None:
    bench = Workspace(root).bench("b")
    both = one_configuration(bench.design, identity(root, "noisy", "noisy"))
    wired = wire_bench(bench, both)
    assert [stream.name for stream in wired.streams] == ["left.seed", "right.seed"]
    assert wired.values["left.seed"] != wired.values["right.seed"]
    other = wire_bench(with_settings(bench, {DRAW: "3"}, both), both)
    assert other.values["left.seed"] == NoiseStream("left.seed").seed(3) != wired.values["left.seed"]
    assert other.settings[DRAW].value == 3


def test_a_seed_that_is_given_is_no_stream(root: Path) -> None:
    bench = replace(Workspace(root).bench("b"), parameters={"left.seed": 7})
    wired = wire_bench(bench, one_configuration(bench.design, identity(root, "noisy", "noisy")))
    assert wired.values["left.seed"] == 7
    assert [stream.name for stream in wired.streams] == ["right.seed"]


def test_without_noise_there_is_no_draw(root: Path) -> None:
    bench = Workspace(root).bench("b")
    assert DRAW not in wire_bench(bench, one_configuration(bench.design, identity(root, "quiet", "quiet"))).settings


def test_a_seed_stays_in_the_range_of_its_parameter() -> None:
    seeds = {NoiseStream("a.seed", 3, 5).seed(draw) for draw in range(50)}
    assert seeds == {3, 4, 5}


@pytest.mark.parametrize("draw", ["-1", "0.5", "x", str(10**14)])
def test_a_draw_is_a_whole_number(root: Path, draw: str) -> None:
    bench = Workspace(root).bench("b")
    with pytest.raises(DseError, match=r"the draw must be 0 … \d+, not"):
        with_settings(bench, {DRAW: draw}, one_configuration(bench.design, identity(root, "noisy", "noisy")))


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("0", "there must be 1 … 10,000 replicates"),
        ("{at_least: 9, at_most: 3}", "and at_least no more than at_most"),
        ("{at_most: 9, confidence: 120 %}", "confidence must be at least 50 % and less than 100 %"),
    ],
)
def test_replicates_that_make_no_sense_are_located(tmp_path: Path, written: str, message: str) -> None:
    study = FILES["testbenches/s.pet.yaml"].replace("replicates: 6", f"replicates: {written}")
    write(tmp_path, {**FILES, "testbenches/s.pet.yaml": study})
    with pytest.raises(DseError, match=message) as caught:
        Workspace(tmp_path).study("s")
    assert "s.pet.yaml:4" in str(caught.value)


def test_replicates_without_noise_are_refused(tmp_path: Path) -> None:
    quiet = {name: text.replace("[noisy, quiet]", "[quiet]") for name, text in FILES.items()}
    quiet["testbenches/s.pet.yaml"] = (
        quiet["testbenches/s.pet.yaml"]
        .replace("design_variables: {left.level: {range: [0.5 m, 1 m], levels: 4}}", "testbench: [b, c]")
        .replace("testbench: b\n", "")
    )
    quiet["testbenches/c.yaml"] = quiet["testbenches/b.yaml"].replace("testbench: b", "testbench: c")
    write(tmp_path, quiet)
    problems = [str(problem) for problem in check_workspace(Workspace(tmp_path))]
    assert any("no part has noise: all replicates would be the same" in problem for problem in problems)


def test_random_is_for_integers(tmp_path: Path) -> None:
    noisy = FILES["components/noisy/component.yaml"].replace("start: 1 m}", "start: 1 m, random: true}", 1)
    write(tmp_path, {**FILES, "components/noisy/component.yaml": noisy})
    with pytest.raises(DseError, match="'random' makes no sense for m"):
        Workspace(tmp_path).component("noisy")


def test_the_share_of_draws_is_a_share(tmp_path: Path) -> None:
    write(tmp_path, {**FILES, "testbenches/b.yaml": FILES["testbenches/b.yaml"].replace("60 %", "160 %")})
    with pytest.raises(DseError, match="met_in must be more than 0 and at most 100 %"):
        Workspace(tmp_path).bench("b")


# From here on, FMUs are built and run.


@pytest.fixture(scope="module")
def explored(root: Path) -> Path:
    dse.open(root).studies["s"].explore(root / "one", workers=1)
    return root / "one"


def content(folder: Path) -> tuple[bytes, list[bytes]]:
    with StudyFolder.open(folder) as stored:
        return EXPORTS["csv"](stored), [file.read_bytes() for file in sorted(stored.waveform_folder.iterdir())]


@pytest.mark.thorough
def test_two_parts_of_one_component_err_independently_and_designs_meet_the_same_noise(
    root: Path, explored: Path
) -> None:
    with StudyFolder.open(explored) as stored:
        table = stored.table()
        both = identity(root, "noisy", "noisy")
        rows = [row for row, name in enumerate(table.configurations) if name == both]
        errors = {draw: stored.waveforms(int(table.numbers[row])) for row in rows for draw in [table.points[DRAW][row]]}
        noise = np.array(
            [[w.values[name] - w.values[name].mean() for name in ("left.y", "right.y")] for w in errors.values() if w]
        )
        correlation = np.corrcoef(noise[:, 0].ravel(), noise[:, 1].ravel())[0, 1]
        # 6 draws of 101 values: the standard error of a correlation of 0 is 0.041.
        assert len(noise) == 6
        assert abs(correlation) < 0.1
        other = identity(root, "noisy", "quiet")
        theirs = next(
            n
            for n, name, draw in zip(table.numbers, table.configurations, table.points[DRAW], strict=True)
            if name == other and draw == min(errors)
        )
        paired = stored.waveforms(int(theirs))
        assert paired is not None
        # The level may differ; the noise does not.
        assert np.allclose(np.diff(paired.values["left.y"]), np.diff(errors[min(errors)].values["left.y"]), atol=1e-12)  # type: ignore[union-attr]


@pytest.mark.thorough
def test_replicates_give_the_same_bytes_on_two_workers_and_in_shards(
    root: Path, explored: Path, tmp_path: Path
) -> None:
    study = Workspace(root).study("s")
    explore_into(study, tmp_path / "two", ExploreOptions(workers=2, fresh=True))
    for number in (1, 2, 3):
        options = ExploreOptions(workers=1, shard=Shard(number, 3), fresh=True)
        explore_into(study, tmp_path / "shards", options)
    merge_studies(tmp_path / "shards", shards_in(tmp_path / "shards"))
    assert content(tmp_path / "two") == content(explored) == content(tmp_path / "shards")


@pytest.mark.thorough
def test_a_run_of_a_study_with_replicates_is_simulated_again_to_the_bit(root: Path, explored: Path) -> None:
    results = dse.Results(explored)
    for number in (5, 20):
        assert results.replay(number, source=root / "testbenches/s.pet.yaml").is_same


@pytest.mark.thorough
def test_what_has_no_noise_is_made_once_and_more_draws_are_made_where_it_is_open(root: Path, tmp_path: Path) -> None:
    dse.open(root).studies["q"].explore(tmp_path / "q", workers=1)
    with StudyFolder.open(tmp_path / "q") as stored:
        table = stored.table()
    assert table.configurations.count(identity(root, "quiet", "quiet")) == 1
    points = over_draws(table)
    assert points.rates is not None
    judged = points.rates.judged[:, 0][points.rates.random]
    assert judged.min() >= 3
    assert judged.max() <= 30
    assert len(set(judged.tolist())) > 1


@pytest.mark.thorough
def test_two_designs_are_compared_in_the_same_draws(explored: Path, root: Path) -> None:
    noisy, quiet = identity(root, "noisy", "quiet"), identity(root, "quiet", "quiet")
    with pytest.raises(DseError, match="is the start of several designs"):
        dse.Results(explored).against(noisy, quiet)
    with StudyFolder.open(explored) as stored:
        table = stored.table()
    lowest, highest = (
        next(
            n
            for n, name, level in zip(table.numbers, table.configurations, table.points["left.level"], strict=True)
            if name == noisy and level == at
        )
        for at in (0.5, 1.0)
    )
    (found,) = dse.Results(explored).against(str(lowest), str(highest)).pairs
    # The same noise, half a metre higher: the second design is never worse.
    assert found.margin == pytest.approx(-0.5)
    assert found.first == 0
    assert found.both + found.second + found.neither == 6
