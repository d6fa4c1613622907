"""Published architecture problems as YAML: counted as in adsg-core and SBArchOpt, explained, drawn evenly.

GNC, the rocket and the patterns of Selva are in test_structure.py.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from scipy.stats import chisquare

import dse

# Simmons (2008), as in adsg-core: rendezvous in orbit of the Earth or of the Moon, crews and fuels; 108 missions.
APOLLO = """\
design: apollo
root:
  compound:
    launch: {alternatives: [rendezvous, orbit, direct]}
    moon:
      alternatives:
        - rendezvous: {compound: {crew: {alternatives: [lm_1, lm_2, lm_3]}, fuel: {alternatives: [lm_cold, lm_hot]}}}
        - alone: {compound: {arrival: {alternatives: [orbiting, straight]}, departure: {alternatives: [orbital, off]}}}
    crew: {alternatives: [cm_2, cm_3]}
    service_fuel: {alternatives: [sm_cryogenic, sm_storable]}
constraints:
  crew: {forbid: [crew is cm_2, moon.crew is lm_3], because: someone stays in the command module}
"""
SUCCESS = {
    "rendezvous": 0.95 * 0.99, "orbit": 0.98 * 0.99, "direct": 0.98 * 0.9,
    "lm_1": 0.95 * 0.99 * 0.9 * 0.9, "lm_2": 0.95 * 0.99 * 0.9, "lm_3": 0.95 * 0.99 * 0.9,
    "lm_cold": 0.9025, "lm_hot": 1, "orbiting": 0.99, "straight": 0.95, "orbital": 0.9, "off": 0.9,
    "cm_2": 1, "cm_3": 1, "sm_cryogenic": 0.95, "sm_storable": 1,
}  # fmt: skip
"""Probabilities of the mission's elements, with those that follow from them."""

# Bussemaker et al. (2021), as in SBArchOpt: 70 and 142,243 jet engines.
TURBOFAN = """\
design: turbofan
root:
  compound:
    spool: {times: 1..3, of: shaft}
    offtakes: {allocate: [power, bleed], to: spool}
    fan: {optional: {compound: {gearbox: {optional: gear}, nozzle: {alternatives: [separate, mixed]}}}}
"""
REALISTIC = """\
design: turbofan
root:
  compound:
    spool: {times: 1..3, of: shaft}
    second_burner: {optional: burner}
    intercooler: {optional: {compound: {radiator: {times: 1..250, of: tube}}}}
    taps: {allocate: [power, bleed, intercooler], to: spool}
    fan:
      optional:
        compound: {counter: {optional: gear}, gearbox: {optional: gear}, nozzle: {alternatives: [separate, mixed]}}
constraints:
  between_turbines: {require: second_burner is present implies spool.n2 is present}
  bypass: {require: intercooler is present implies fan is present, because: it is cooled by the air of the bypass}
"""


def design(folder: Path, text: str, name: str) -> dse.Design:
    (folder / "designs").mkdir()
    (folder / "components").mkdir()
    stated = [f"  {one}: {{properties: {{success: {value}}}}}\n" for one, value in SUCCESS.items()]
    others = [f"  {one}: {{}}\n" for one in ("shaft", "gear", "separate", "mixed", "burner", "tube")]
    (folder / "components/parts.yaml").write_text("components:\n" + "".join((*stated, *others)), encoding="utf-8")
    (folder / f"designs/{name}.yaml").write_text(text, encoding="utf-8")
    return dse.open(folder).designs[name]


@pytest.mark.parametrize(
    ("text", "expected"), [(APOLLO, 108), (TURBOFAN, 70), (REALISTIC, 142_243)], ids=["apollo", "simple", "realistic"]
)
def test_they_have_their_published_numbers(tmp_path, text, expected):
    assert design(tmp_path, text, text.split()[1]).count(exact=True) == expected


@pytest.mark.parametrize(("text", "number"), [(APOLLO, 108), (TURBOFAN, 70)], ids=["apollo", "turbofan"])
def test_their_configurations_are_drawn_evenly(tmp_path, text, number):
    drawn = Counter(each.id for each in design(tmp_path, text, text.split()[1]).sample(40 * number, seed=1))
    assert len(drawn) == number
    assert chisquare([*drawn.values()]).pvalue > 1e-4


def test_the_moon_landing_is_explained_and_ranked(tmp_path):
    apollo = design(tmp_path, APOLLO, "apollo")
    wrong = apollo.explain(
        {
            "launch": "direct",
            "moon": "rendezvous",
            "moon.crew": "lm_3",
            "moon.fuel": "lm_hot",
            "crew": "cm_2",
            "service_fuel": "sm_storable",
        }
    )
    assert [each.constraint.name for each in wrong.broken] == ["crew"]
    near = wrong.nearest.choices
    assert (near["crew"], near.get("moon.crew")) != ("cm_2", "lm_3")
    best = apollo.best(maximize="product(success)", n=1)[0]
    assert float(best.values[0]) == pytest.approx(0.98 * 0.99 * 0.99 * 0.9)
    assert (best.choices["launch"], best.choices["moon"]) == ("orbit", "alone")


def test_an_engine_is_explained(tmp_path):
    engine = design(tmp_path, REALISTIC, "turbofan")
    wrong = engine.explain({"second_burner": "burner", "spool.n2": "absent"})
    assert not wrong.is_valid
    assert engine.count(choose={"fan": "absent"}, exact=True) == 27
