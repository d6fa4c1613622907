"""``dse space`` as a user asks it, on the example and on a small design of two architectures."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from dse.cli import entry

DESIGN = """\
design: pump
constraint_sets:
  winter: {on: false, title: for cold countries}
root:
  compound:
    drive:
      alternatives: [small, large]
    heater: {optional: coil}
constraints:
  budget: {require: sum(cost) <= 60 EUR, because: the price is fixed}
  warm: {require: heater is present, set: winter}
  strong: {require: drive is large implies heater is absent}
"""
COMPONENTS = """\
components:
  small: {properties: {cost: 20 EUR, mass: 2 kg}}
  large: {properties: {cost: 50 EUR, mass: 1500 g}}
  coil: {properties: {cost: 15 EUR, mass: 300 g}}
"""
MODEL = """\
features
    car {Price 10}
        mandatory
            engine
                alternative
                    petrol {Price 100}
                    electric {Price 250}
        optional
            roof {Price 40}
constraints
    electric => !roof
"""


class Done:
    """What a command printed and how it ended."""

    def __init__(self, returncode, stdout, stderr):
        self.returncode, self.stdout, self.stderr = returncode, stdout, stderr


@pytest.fixture
def ask(tmp_path, monkeypatch, capsys):
    """Runs ``dse`` in this process, in a small workspace."""
    for name, text in (("designs/pump.yaml", DESIGN), ("components/parts.yaml", COMPONENTS), ("car.uvl", MODEL)):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")

    def run(*arguments):
        monkeypatch.setattr("sys.argv", ["dse", *arguments])
        capsys.readouterr()
        try:
            entry.run()
            code = 0
        except SystemExit as end:
            code = end.code or 0
        return Done(code, *capsys.readouterr())

    return run


def data(done):
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_configurations_are_counted(ask):
    assert ask("space", "count", "pump").stdout == "pump: 3 of 4 configurations are valid\n"
    assert data(ask("space", "count", "pump", "--exact", "--choose", "drive=large", "--format", "json")) == {
        "design": "pump",
        "chosen": {"drive": "large"},
        "where": None,
        "total": 4,
        "valid": 1,
        "exact": True,
    }
    assert "where sum(mass) < 2 kg: 1 of 4" in ask("space", "count", "pump", "--where", "sum(mass) < 2 kg").stdout
    assert "1 of 4" in ask("space", "count", "pump", "--on", "winter").stdout


def test_the_table_of_constraints_has_a_row_for_each_that_is_on(ask):
    rows = data(ask("space", "constraints", "pump", "--format", "json"))["constraints"]
    assert [(row["constraint"], row["after"]["valid"], row["redundant"]) for row in rows] == [
        ("budget", 3, True),
        ("strong", 3, True),
    ]
    assert [row["removes_alone"]["valid"] for row in rows] == [1, 1]
    shown = ask("space", "constraints", "pump", "--constraint", "strong", "--on", "winter")
    assert "strong" in shown.stdout
    assert "budget" not in shown.stdout
    unknown = ask("space", "constraints", "pump", "--constraint", "strnog")
    assert unknown.returncode == 1
    assert "did you mean 'strong'?" in unknown.stderr


def test_shares_of_the_choices_add_up(ask):
    entries = data(ask("space", "choices", "pump", "--format", "json"))["choices"]
    shares = {(entry["place"], entry["choice"]): entry["share"] for entry in entries}
    assert shares["drive", "small"] == pytest.approx(2 / 3)
    assert shares["heater", None] == pytest.approx(2 / 3)
    shown = ask("space", "choices", "pump", "--choose", "drive=large").stdout
    assert "forced" in shown
    assert "dead" in shown


def test_a_conflict_is_told_in_the_words_of_the_file(ask):
    shown = ask("space", "conflict", "pump", "--choose", "drive=large", "--on", "winter").stdout
    assert "pump with drive=large: these 2 constraints cannot all be met" in shown
    assert "strong: drive is large implies heater is absent" in shown or "budget" in shown
    assert "designs/pump.yaml:" in shown
    assert "nothing conflicts" in ask("space", "conflict", "pump").stdout
    assert data(ask("space", "conflict", "pump", "--format", "json"))["conflict"] == []


def test_an_excluded_configuration_is_explained_with_units_and_the_nearest_valid_one(ask):
    shown = ask("space", "explain", "pump", "--choose", "drive=large", "--choose", "heater=coil").stdout
    assert "breaks 2 of 2 constraints" in shown
    assert "sum(cost) = 65 EUR" in shown
    assert "coil -> absent" in shown or "large -> small" in shown
    valid = data(
        ask("space", "explain", "pump", "--choose", "drive=small", "--choose", "heater=absent", "--format", "json")
    )
    assert valid["valid"] is True
    assert valid["nearest"] is None


def test_choices_that_are_not_complete_are_completed_or_refused(ask):
    assert "can be completed" in ask("space", "explain", "pump", "--choose", "drive=small").stdout
    shown = ask("space", "explain", "pump", "--choose", "drive=large", "--on", "winter").stdout
    assert "no valid configuration has these choices, because of" in shown
    wrong = ask("space", "explain", "pump", "--choose", "drive=medium", "--choose", "heating=coil")
    assert wrong.returncode == 1
    assert "2 problems" in wrong.stderr
    assert ask("space", "explain", "pump").returncode == 2


@pytest.mark.thorough
def test_the_best_are_listed_with_their_unit(ask):
    shown = ask("space", "best", "pump", "--minimize", "sum(mass)").stdout
    assert "1.5 kg" in shown
    found = data(ask("space", "best", "pump", "--maximize", "sum(cost) / sum(mass)", "-n", "1", "--format", "json"))
    assert found["aims"] == [{"value": "sum(cost) / sum(mass)", "aim": "greatest", "unit": "EUR/kg"}]
    assert found["configurations"][0]["values"] == [pytest.approx(50 / 1.5)]
    assert ask("space", "best", "pump").returncode == 2


def test_a_pareto_set_needs_two_objectives(ask):
    aims = ["--minimize", "sum(cost)", "--minimize", "sum(mass)"]
    found = data(ask("space", "pareto", "pump", *aims, "--format", "json"))
    assert [entry["values"] for entry in found["configurations"]] == [[20.0, 2.0], [50.0, 1.5]]
    assert ask("space", "pareto", "pump", *aims[:2]).returncode == 2


def test_a_refined_design_keeps_the_ids_and_what_is_compared_is_counted(ask):
    refined = ask("space", "refine", "pump", "--drop", "drive=large", "-o", "designs/cheap.yaml")
    assert refined.returncode == 0, refined.stderr
    assert "2 of 4 combinations are left" in refined.stdout
    shown = ask("space", "compare", "pump", "cheap").stdout
    assert "- drive=large" in shown
    assert "pump: 3 valid, 1 of them only here" in shown
    assert "in both: 2" in shown
    (first,) = data(ask("enumerate", "cheap", "--where", "heater is absent", "--format", "json"))
    kept = ask("space", "refine", "pump", "--ids", first["id"])
    assert "design: pump_refined" in kept.stdout
    assert "large" not in kept.stdout
    assert ask("space", "refine", "pump").returncode == 2
    assert "nothing is left" in ask("space", "refine", "pump", "--keep", "drive=small", "--drop", "drive=small").stderr


def test_a_feature_model_is_asked_as_it_is_and_imported_and_exported(ask):
    assert ask("space", "count", "car.uvl").stdout == "car: 3 of 4 configurations are valid\n"
    assert ask("import", "uvl", "car.uvl").returncode == 0
    assert "3 of 4" in ask("space", "count", "car").stdout
    again = ask("import", "uvl", "car.uvl")
    assert again.returncode == 1
    assert "nothing is overwritten" in again.stderr
    assert ask("export", "uvl", "car", "-o", "back.uvl").returncode == 0
    assert "3 of 4" in ask("space", "count", "back.uvl").stdout
    assert ask("export", "csv", "car", "-o", "car.csv").returncode == 0
    assert len(Path("car.csv").read_text(encoding="utf-8").splitlines()) == 4


def test_import_and_export_stand_beside_space_in_the_help(ask):
    words = [line.split()[0] for line in ask("--help").stdout.splitlines() if line.startswith("  ") and line.split()]
    assert words[words.index("enumerate") :][:4] == ["enumerate", "space", "import", "export"]
