"""What is not translated is refused: one error, at the line of the model, that names the construct; and no FMU."""

from __future__ import annotations

from pathlib import Path

import pytest
from modelica_components import component

from dse.errors import DseError
from dse.fmu.component_build import build

FOLDER = Path(__file__).parent / "refused"
MARK = "// refused:"


@pytest.mark.sampled(4)
@pytest.mark.parametrize("file", sorted(FOLDER.glob("*.mo")), ids=lambda file: file.stem)
def test_the_construct_is_refused_by_name_where_it_stands(file: Path, tmp_path: Path) -> None:
    marked = [
        (number, line.split(MARK)[1].strip())
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1)
        if MARK in line
    ]
    assert marked, f"{file.name} does not say what is refused"
    with pytest.raises(DseError) as refused:
        build(component(file), cache=tmp_path)
    places = [(problem.where.file, problem.where.line) for problem in refused.value.problems if problem.where]
    assert len(places) == len(refused.value.problems) == len(marked)
    assert [line for _, line in places] == [line for line, _ in marked]
    assert all(Path(place).name == file.name for place, _ in places)
    for problem, (_, word) in zip(refused.value.problems, marked, strict=True):
        assert word in problem.what
    assert not list(tmp_path.rglob("*.fmu"))
