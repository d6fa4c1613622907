"""What each mistake in a rating comes to: one error, at its place."""

from __future__ import annotations

import pytest
from rated_cars import RATING

from dse.errors import DseError
from dse.loading.bench.rating import read_rating
from dse.rating.cases import case_studies
from dse.rating.workbook import require_inputs
from dse.testbench import one_configuration


def problems_of(text, workspace, protocol, rating_file):
    try:
        rating = read_rating(rating_file(text), workspace.bench, workspace.root.parent.parent)
        require_inputs(protocol, rating.inputs)
        design = workspace.design("car")
        case_studies(rating, protocol, protocol.cells(), design, [one_configuration(design, None)])
    except DseError as error:
        return [f"{problem.where.line}:{problem.where.column} {problem.what}" for problem in error.problems]
    return []


END = "impact_speed}\n  CPNA"
"""The end of the first test."""

NO_CONDITION = "the layer 'Adverse weather conditions' of euroncap-rating-2026 has no condition"

MISTAKES = [
    ("  CCRs:", "  CCRx:", "4:3 euroncap-rating-2026 has no test 'CCRx'"),
    ("bench: wall", "bench: wal", "5:12 unknown test bench 'wal'"),
    ("target.speed: Target", "target.sped: Target", "6:43 'target' has no port or parameter 'sped'"),
    ("VUT speed, target.speed", "VUT sped, target.speed", "6:32 the cells of CCRs have no attribute 'VUT sped'"),
    ("target.speed: T", "target.fog: T", "6:55 wrong unit in '0 km/h': expected length, found length/time"),
    ("target.host_speed: V", "target.light: V", "6:27 'target.light' is enum[day, night], found '10 km/h'"),
    (END, "impact}\n  CPNA", "7:28 'impact' is not a metric of wall"),
    (END, "place}\n  CPNA", "7:14 'v_rel_impact' is length/time, the metric 'place' is a plain number"),
    (f"v_rel_impact: {END}", f"v_rel: {END}", "7:14 euroncap-rating-2026 has no KPI 'v_rel'"),
    (f"v_rel_impact: {END}", f"v_impact: {END}", "7:14 'v_rel_impact' is missing in the values of CCRs"),
    ("  CPNA", "    where: vut_sped > 3 km/h\n  CPNA", "8:12 the cells have no attribute 'vut_sped'"),
    ("  CPNA", "    where: vut_speed > 3 m\n  CPNA", "8:24 vut_speed is length/time, not length"),
    ("  CPNA", "    where: function > 3 m\n  CPNA", "8:23 'aeb' is not a quantity"),
    ("  CPNA", "    where: function == FCW\n  CPNA", "8:12 no cell of CCRs meets this condition"),
    ("  CPNA", "    where: 1 + 1\n  CPNA", "8:12 this is not a condition on an attribute"),
    ("  CPNA", "    where: vut_speed >\n  CPNA", "8:23 expected a value, found the end"),
    ("  CPNA", "    parameters: {target.speed: 3 m}\n  CPNA", "8:18 'target.speed' is under 'cells', too"),
    ("  CPNA", "    parameters: {target.fog: 3 s}\n  CPNA", "8:30 wrong unit in '3 s': expected length, found time"),
    ("  CPNA", "    parameter: {target.fog: 3 m}\n  CPNA", "8:5 unknown key 'parameter'"),
    ("  Adverse", "  Bad", "13:3 euroncap-rating-2026 has no robustness layer 'Bad weather conditions'"),
    ("target.fog: 50 m", "target.smoke: 50 m", "13:32 no bench of the rating has 'target.smoke'"),
    ("target.fog: 50 m", "target.fog: 50 s", "13:44 wrong unit in '50 s': expected length, found time"),
    ("{target.fog: 50 m}", "{+9 m: {target.fog: 50 m}}", f"13:32 {NO_CONDITION} '+9 m'"),
    ("fog: 50 m", "fog: {change: 5 s}", "13:53 'target.fog' cannot change by 5 s"),
    ("fog: 50 m", "fog: {change: x}", "13:53 'x' is not a quantity"),
    ("layers:", "inputs: {Response: Warning}\nlayers:", "12:20 euroncap-rating-2026 has no input 'Response'"),
    ("layers:", "inputs: {Vehicle response: Loud}\nlayers:", "12:28 'Vehicle response' cannot be 'Loud'"),
    ("layers:", "inputs: {Driveability: Yes}\nlayers:", "12:24 'Driveability' cannot be 'Yes'"),
    (f"v_rel_impact: {END}", "}\n  CPNA", "7:13 'tests.CCRs.values': expected 1 entries, found {}"),
    ("  CPNA day:", "  CPNA day: 3\n  x:", "8:13 'tests.CPNA day': expected a mapping or a list, found 3"),
]  # fmt: skip


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("right", "wrong", "expected"), MISTAKES, ids=[wrong.strip()[:24] for _, wrong, _ in MISTAKES])
def test_a_mistake_is_one_error_at_its_place(workspace, protocol, rating_file, right, wrong, expected):
    assert RATING.count(right) >= 1
    found = problems_of(RATING.replace(right, wrong, 1), workspace, protocol, rating_file)
    assert found == [expected]


def test_a_right_file_has_no_problem(workspace, protocol, rating_file):
    assert problems_of(RATING, workspace, protocol, rating_file) == []


def test_a_cell_on_two_benches_is_refused(workspace, protocol, rating_file):
    part = "bench: wall, cells: {target.host_speed: VUT speed}, values: {v_rel_impact: impact_speed}"
    text = "rating: small\nprotocol: euroncap-rating-2026\ntests:\n  CCRs:\n"
    text += f"    - {{{part}, where: vut_speed < 30 km/h}}\n"
    fits = text + f"    - {{{part}, where: vut_speed >= 30 km/h}}\n"
    assert problems_of(fits, workspace, protocol, rating_file) == []
    overlaps = text + f"    - {{{part}, where: vut_speed between 20 km/h and 30 km/h}}\n"
    (*_, last) = problems_of(overlaps, workspace, protocol, rating_file)
    assert "VUT speed 20 km/h" in last
    assert "is simulated on 'wall' and on 'wall'" in last


def test_a_design_without_a_bench_in_the_rating_is_refused(workspace, protocol, rating_file):
    from dataclasses import replace

    rating = read_rating(rating_file(RATING), workspace.bench, workspace.root.parent.parent)
    other = replace(workspace.design("car"), name="lorry")
    with pytest.raises(DseError, match=r"(?s)no test of 'small' is on a test bench of 'lorry'.*it rates car"):
        case_studies(rating, protocol, protocol.cells(), other, [one_configuration(workspace.design("car"), None)])
