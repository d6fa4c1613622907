"""Listings for other programs, read back with other libraries."""

from __future__ import annotations

import csv
import io
import json
import math

import pyarrow.parquet as pq
import pytest

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.space.methods.engine import Engine
from dse.space.output import export
from dse.space.output.export import WRITERS, save
from dse.space.output.sheet import Sheet
from dse.space.space import open_space
from dse.units import parse_quantity


def part(name, **properties):
    return Part(
        Component(
            name, Interface("any", ()), properties={key: parse_quantity(text) for key, text in properties.items()}
        )
    )


ENGINE = Alternative((part("d", mass="100.1 kg"), part("e", mass="90000 g")))
HYBRID = Compound("hybrid", {"engine": ENGINE, "box": part("f", cost="0.1 EUR")})
OTHER = Compound("other", {"engine": Alternative((part("e", mass="1 kg"), part('say "x, y"', cost="2 EUR")))})
SPACE = DesignSpace(
    "car",
    Compound(
        "car",
        {
            "s": Optional(Alternative((part("a", cost="1.1 EUR"), part("b", cost="2.2 EUR")))),
            "p": Alternative((part("none"), HYBRID, OTHER)),
        },
    ),
    (
        Constraint("cheap", parse_expression("sum(cost) <= 4.2 EUR")),
        Constraint("light", parse_expression("mass < 1 t")),
    ),
)


def written(form, space=SPACE, blocks=None):
    stream = io.BytesIO()
    number = WRITERS[form](Sheet(space), Engine.of(space).blocks() if blocks is None else blocks, stream)
    return number, stream.getvalue()


def expected():
    """Id, choices and sums of every configuration, from the configurations themselves."""
    found = []
    for configuration in open_space(SPACE).configurations():
        sums = {}
        for name in ("cost", "mass"):
            given = [c.properties[name].si for c in configuration.parts.values() if name in c.properties]
            sums[name] = float(sum(given)) if given else None
        found.append((configuration.id, dict(configuration.choices), sums))
    return found


def from_cells(row):
    choices = {path: row[path] for path in ("s", "p", "p.engine") if row[path]}
    sums = {name: row[f"sum({name}) [{unit}]"] for name, unit in (("cost", "EUR"), ("mass", "kg"))}
    return row["id"], choices, {name: float(value) if value not in ("", None) else None for name, value in sums.items()}


def test_csv_has_a_column_for_every_place_and_every_sum_with_its_unit():
    number, data = written("csv")
    rows = list(csv.DictReader(io.StringIO(data.decode())))
    assert list(rows[0]) == ["id", "s", "p", "p.engine", "sum(cost) [EUR]", "sum(mass) [kg]"]
    assert [from_cells(row) for row in rows] == expected()
    assert number == len(rows)


def test_parquet_holds_the_same_with_choices_encoded_by_dictionary():
    number, data = written("parquet")
    table = pq.read_table(io.BytesIO(data))
    assert [from_cells(row) for row in table.to_pylist()] == expected()
    assert str(table.schema.field("p.engine").type).startswith("dictionary<values=string")
    assert table.num_rows == number


def test_parquet_has_regular_row_groups_however_the_blocks_come(monkeypatch):
    monkeypatch.setattr(export, "ROW_GROUP", 4)
    rows = Engine.of(SPACE).rows(100)
    _, whole = written("parquet", blocks=[rows])
    _, single = written("parquet", blocks=[rows[i : i + 1] for i in range(len(rows))])
    assert whole == single
    groups = pq.ParquetFile(io.BytesIO(whole)).metadata
    sizes = [groups.row_group(i).num_rows for i in range(groups.num_row_groups)]
    assert sizes == [4] * (len(rows) // 4) + [len(rows) % 4] * (len(rows) % 4 > 0)


@pytest.mark.parametrize("form", ["json", "jsonl"])
def test_json_says_choices_components_and_sums_with_units(form):
    _, data = written(form)
    objects = json.loads(data) if form == "json" else [json.loads(line) for line in data.decode().splitlines()]
    for found, (name, choices, sums), configuration in zip(
        objects, expected(), open_space(SPACE).configurations(), strict=True
    ):
        assert (found["id"], found["choices"]) == (name, choices)
        assert found["components"] == {path: component.name for path, component in configuration.parts.items()}
        units = {"cost": "EUR", "mass": "kg"}
        there = {key: {"value": value, "unit": units[key]} for key, value in sums.items() if value is not None}
        assert found["totals"] == there


@pytest.mark.parametrize("form", sorted(WRITERS))
def test_nothing_to_write_is_a_valid_file(form):
    number, data = written(form, blocks=[])
    assert number == 0
    match form:
        case "csv":
            assert data == b"id,s,p,p.engine,sum(cost) [EUR],sum(mass) [kg]\n"
        case "json":
            assert json.loads(data) == []
        case "jsonl":
            assert data == b""
        case "parquet":
            assert pq.read_table(io.BytesIO(data)).num_rows == 0


@pytest.mark.parametrize("form", sorted(WRITERS))
def test_the_same_rows_are_the_same_bytes(form):
    assert written(form) == written(form)


def test_sums_are_rounded_once_however_fine_the_numbers_are():
    fine = part("x", cost="0.1 EUR"), part("y", cost="123456789012345.678901234567890123 EUR"), part("z")
    space = DesignSpace(
        "fine",
        Compound("fine", {"a": Alternative(fine), "b": Alternative(fine)}),
        (Constraint("any", parse_expression("sum(cost) > 0 EUR or true")),),
    )
    sheet, engine = Sheet(space), Engine.of(space)
    (total,) = sheet.totals
    assert not total.is_small
    rows = engine.rows(99)
    exact = [
        sum(c.properties["cost"].si for c in found.parts.values() if "cost" in c.properties)
        for found in open_space(space).configurations()
    ]
    assert total.values(rows)[:-1].tolist() == [float(value) for value in exact[:-1]]
    assert math.isnan(total.values(rows)[-1])


def test_a_file_that_could_not_be_finished_does_not_appear(tmp_path):
    def broken():
        yield Engine.of(SPACE).rows(1)
        raise RuntimeError

    with pytest.raises(RuntimeError):
        save(Sheet(SPACE), broken(), tmp_path / "out.csv")
    assert list(tmp_path.iterdir()) == []
    assert save(Sheet(SPACE), Engine.of(SPACE).blocks(), tmp_path / "out.csv") == len(expected())
    assert (tmp_path / "out.csv").read_bytes() == written("csv")[1]


def test_an_unknown_suffix_is_refused_by_name(tmp_path):
    with pytest.raises(DseError, match=r"format of 'out\.xlsx'") as caught:
        save(Sheet(SPACE), [], tmp_path / "out.xlsx")
    assert ".parquet" in str(caught.value)
