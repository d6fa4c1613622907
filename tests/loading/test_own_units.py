"""Units and currencies that a workspace or a design defines: what they mean, where they hold, and what is refused."""

from __future__ import annotations

import pickle
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from pathlib import Path

import pytest

import dse
from dse.errors import DseError
from dse.loading import Workspace, write_design
from dse.space import open_space, read_aims
from dse.units import (
    UnitError,
    definition_of,
    is_currency,
    own_currency,
    own_unit,
    own_units,
    parse_quantity,
    parse_unit,
    short_symbol,
)

DESIGN = """\
design: car
units: {lot: 12}
root:
  compound:
    radar: {times: 1..3, alternatives: [small, large]}
constraints:
  budget: {require: sum(cost) <= 1.5 kCR}
  beam: {require: each(radar.reach >= 3 stride)}
  weight: {require: sum(mass) * 1 lot <= 24 kg}
"""


def workspace(folder: Path, units: str, design: str = DESIGN, cost: str = "CR") -> Workspace:
    for name in ("components", "designs"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    (folder / "components/interfaces.yaml").write_text(f"units: {units}\n", encoding="utf-8")
    properties = "{{cost: {0} {1}, mass: {2} kg, reach: {3} stride}}"
    (folder / "components/parts.yaml").write_text(
        "components:\n"
        f"  small: {{properties: {properties.format(400, cost, 0.5, 3)}}}\n"
        f"  large: {{properties: {properties.format(700, cost, 0.9, 4)}}}\n",
        encoding="utf-8",
    )
    (folder / "designs/car.yaml").write_text(design, encoding="utf-8")
    return Workspace(folder)


UNITS = "{CR: {currency: true}, kCR: 1000 CR, stride: 0.75 m, pace: 2 stride, EUR: {currency: true}, Mbit/s: 1e6 bit/s}"


def refused(folder: Path, units: str, design: str = DESIGN) -> str:
    with pytest.raises(DseError) as error:
        workspace(folder, units, design).design("car")
    return "\n".join(f"{p.where.line}:{p.where.column} {p.what} ({p.hint})" for p in error.value.problems)


def test_a_price_in_an_own_currency_is_compared_added_and_ranked(tmp_path):
    space = workspace(tmp_path, UNITS).design("car")
    opened = open_space(space)
    assert opened.count(exact=True).value == sum(
        1 for n in (1, 2, 3) for k in range(n + 1) if within(n, k) for _ in ways(n, k)
    )
    (best,) = opened.best(read_aims([], ["sum(cost) / 1 kCR"], space.units)[0], 1)
    assert best.values[0] == Fraction("1.5")
    cost = next(total for total in opened.sheet().totals if total.name == "cost")
    assert (str(cost.unit), cost.unit.factor) == ("CR", 1)


def within(number: int, large: int) -> bool:
    return 400 * number + 300 * large <= 1500 and 12 * (0.5 * number + 0.4 * large) <= 24


def ways(number: int, large: int):
    from itertools import combinations

    return combinations(range(number), large)


def test_two_workspaces_in_one_process_do_not_see_each_others_units(tmp_path):
    one = workspace(tmp_path / "one", UNITS).design("car")
    other = workspace(tmp_path / "two", UNITS.replace("0.75 m", "1 m").replace("1000 CR", "10 CR")).design("car")
    assert open_space(one).count(exact=True).value > 0
    assert open_space(other).count(exact=True).value == 0
    assert one.units["stride"] != other.units["stride"]
    with pytest.raises(UnitError, match="unknown unit 'CR'"):
        parse_unit("CR")
    with own_units(one.units), ThreadPoolExecutor(1) as pool, pytest.raises(UnitError):
        pool.submit(parse_quantity, "3 kCR").result()


def test_the_units_of_a_design_are_its_own(tmp_path):
    files = workspace(tmp_path, UNITS)
    (tmp_path / "designs/van.yaml").write_text(
        DESIGN.replace("design: car", "design: van").replace("units: {lot: 12}\n", ""), encoding="utf-8"
    )
    assert "lot" in files.design("car").units
    with pytest.raises(DseError, match="unknown unit 'lot'"):
        files.design("van")


@pytest.mark.parametrize("text", ["CR", "kCR", "pace", "kCR/pace2", "1/stride", "CR.s", "lot"])
def test_a_unit_is_read_anywhere_by_its_symbol(tmp_path, text):
    with own_units(workspace(tmp_path, UNITS).design("car").units):
        unit = parse_unit(text)
    assert parse_unit(unit.symbol) == unit == pickle.loads(pickle.dumps(unit))  # noqa: S301
    assert str(unit) == text == short_symbol(unit.symbol)


def test_factors_are_exact_and_dimensions_compared(tmp_path):
    with own_units(workspace(tmp_path, UNITS).design("car").units):
        assert parse_quantity("2 pace").si == 3
        assert parse_quantity("3 kCR/pace").si == 2000
        assert parse_unit("kCR").dimension == parse_unit("CR").dimension != parse_unit("EUR").dimension
        assert is_currency(parse_unit("kCR").dimension)
        assert not is_currency(parse_unit("kCR/s").dimension)
    assert own_currency("CR") == "¤CR"
    assert definition_of(own_unit("third", "1/3 m")) == "1/3 m"


def test_a_written_design_brings_its_units_along(tmp_path):
    space = workspace(tmp_path, UNITS).design("car")
    text = write_design(space)
    assert "units: {lot: 12" not in text  # one a line
    for line in ("  CR: {currency: true}", "  kCR: 1000 CR", "  lot: 12", "  pace: 1.5 m", "  stride: 0.75 m"):
        assert f"{line}\n" in text.replace('"', "")
    again = workspace(tmp_path, UNITS, text).design("car")
    assert again.units == space.units
    assert write_design(again) == text


@pytest.mark.parametrize(
    ("units", "what"),
    [
        ("{a: 2 b, b: 3 c, c: 4 a}", "units are defined by each other: a -> b -> c -> a"),
        ("{km: 900 m}", "'km' is 1000 m already, not 900 m"),
        ("{USD: 0.9 EUR}", "'USD' is the currency USD already, not 0.9 EUR"),
        ("{min: {currency: true}}", "'min' is 60 s already, not the currency min"),
        ("{big: 12 ells}", "unknown unit 'ells'"),
        ("{warm: 1 degC}", "'degC' begins at another zero than K"),
        ("{none: 0 m}", "'0 m' is not a positive number with a unit"),
        ("{less: -2 m}", "'-2 m' is not a positive number with a unit"),
        ("{frame/s: 3 bit/s}", "'frame/s' is not a name of a unit"),
        ("{and: 3 m}", "'and' is not a name of a unit"),
        ("{tick: {currency: false}}", "a unit that is not a currency is a quantity"),
        ("{far: 1e308 m, farther: 1e308 far}", "beyond the range"),
    ],
)
def test_what_is_no_definition_is_refused_at_its_place(tmp_path, units, what):
    told = refused(tmp_path, units)
    assert what in told
    assert told.startswith("1:")
    assert told.count("\n") == 0


def test_one_name_means_one_unit(tmp_path):
    told = refused(tmp_path, UNITS, DESIGN.replace("lot: 12", "lot: 12, stride: 0.8 m"))
    assert told == "2:18 'stride' is 0.75 m already, not 0.8 m (choose another name)"
    same = DESIGN.replace("lot: 12", "lot: 12, stride: 75 cm")
    assert workspace(tmp_path, UNITS, same).design("car").units["stride"] == "stride{0.75 m}"
    (tmp_path / "components/more").mkdir()
    (tmp_path / "components/more/interfaces.yaml").write_text("units: {stride: 2 m}\n", encoding="utf-8")
    with pytest.raises(DseError, match=r"more/interfaces.yaml:1:9: 'stride' is 2 m already|'stride' is 0.75 m already"):
        Workspace(tmp_path).design("car")


@pytest.mark.parametrize(
    ("rule", "what"),
    [
        ("sum(cost) + 3 EUR <= 9 CR", "currency"),
        ("sum(cost) <= 1000", "plain number"),
        ("sum(cost) <= 3 lots", "unknown unit 'lots'"),
        ("sum(mass) <= 3 CR", "CR"),
    ],
)
def test_money_is_not_added_to_other_money_or_numbers(tmp_path, rule, what):
    design = DESIGN.replace("sum(cost) <= 1.5 kCR", rule)
    workspace(tmp_path, UNITS, design)
    with pytest.raises(DseError, match=what) as error:
        dse.open(tmp_path).designs["car"].count()
    assert error.value.problems[0].where.line == 7
    assert "¤" not in str(error.value)


def test_questions_take_the_units_of_the_design(tmp_path):
    workspace(tmp_path, UNITS)
    design = dse.open(tmp_path).designs["car"]
    assert design.count(where="sum(cost) <= 0.5 kCR", exact=True) == 1
    refined = design.refine({"radar.n1": ["small"]})
    assert refined.count(where="sum(cost) <= 0.5 kCR", exact=True) == 1
    assert design.best("sum(cost) + 1 kCR", n=1).units[0].symbol.startswith(("kCR{", "¤CR"))
