"""``source: {kind: c}``: a component written in C."""

from __future__ import annotations

from pathlib import Path

from dse.domain.component import Component, CSource
from dse.errors import Location, Problem, fail
from dse.loading import ComponentKind, Plain, SourcePlace, SourceSection, is_identifier


class CSection(SourceSection):
    """The keys of ``source``."""

    files: list[str] = []
    header: str | None = None
    struct: str | None = None
    init: str | None = None
    step_function: str | None = None
    step: Plain | None = None


class CKind(ComponentKind[CSection, CSource]):
    """C11 is compiled together with the FMI functions."""

    section = CSection

    def read(self, section: CSection, place: SourcePlace) -> CSource:
        """Files of the workspace; names that are not given follow from the component's."""
        if not section.files:
            raise place.missing("files", f"files: [{place.component}.c]")
        files = [place.file(name, (".c", ".h"), "files", i) for i, name in enumerate(section.files)]
        header = section.header or Path(section.files[0]).with_suffix(".h").as_posix()
        struct = section.struct or place.component
        step = None
        if section.step is not None:
            step = place.number(section.step, "s", "step")
            if step <= 0:
                raise fail(f"the step must be positive, not {section.step}", place.at("step"))
        return CSource(
            tuple(files),
            place.file(header, (".h",), "header"),
            _identifier(struct, place.at("struct")),
            _identifier(section.init or f"{struct}_init", place.at("init")),
            _identifier(section.step_function or f"{struct}_step", place.at("step_function")),
            step,
        )

    def check(self, component: Component, source: CSource) -> tuple[Problem, ...]:
        """Compile it. Raises DseError with all that is wrong; without a compiler that is told, and nothing else."""
        from dse.fmu import NoCompilerError, build_c

        try:
            build_c(component, source, version=2)
        except NoCompilerError as error:
            return tuple(Problem(f"C was not compiled: {each.what}", hint=each.hint) for each in error.problems)
        return ()

    def build(self, component: Component, source: CSource, *, version: int, cache: Path | None) -> Path:
        """The FMU, with its sources inside. Raises DseError: the C does not compile, or lacks a port."""
        from dse.fmu import build_c

        return build_c(component, source, version=version, cache=cache)


def _identifier(name: str, where: Location) -> str:
    if not is_identifier(name):
        raise fail(f"'{name}' is not a C identifier", where)
    return name


KIND = CKind()
