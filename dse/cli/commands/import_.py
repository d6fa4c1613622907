"""``dse import``: design spaces and components from other programs' files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import group
from dse.cli.terminal import plain, plain_table, print_line, print_table

if TYPE_CHECKING:
    from collections.abc import Iterator, Sized

    from dse.domain.component import Component
    from dse.domain.design import DesignSpace
    from dse.interchange import ImportedTraffic

import_app = group("import", "Read a design space, a component or a system from another program's file.")


_Folder = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="DIR",
        help="The workspace to write to; created if it is new. Default: the one around this folder, or this folder.",
    ),
]


@import_app.command("uvl")
def import_uvl(
    model: Annotated[Path, typer.Argument(metavar="FILE", help="A feature model in UVL.")],
    folder: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="The workspace to write to; created if it is new.")
    ] = Path(),
) -> None:
    """Import a UVL feature model as a design space.

    The tree is written to DIR/designs, the attributes of features to DIR/components, in files named after the model.
    """
    from dse.loading import read_uvl

    space = read_uvl(model)
    files = _files(space, folder)
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")
        print_line(str(path))
    print_line(f"next: dse space count {space.name}")


@import_app.command("fmu")
def import_fmu(
    files: Annotated[list[Path], typer.Argument(metavar="FMU...", help="Existing FMUs.")],
    folder: _Folder = None,
    name: Annotated[
        str | None, typer.Option("--name", metavar="NAME", help="The component's name; default: that of the file.")
    ] = None,
) -> None:
    """Import FMUs as components.

    Each is copied to DIR/components/NAME with a component.yaml beside it. A component implements the interface of the
    workspace whose ports it has, if that has all its inputs. Otherwise a new interface is written to interfaces.yaml
    beside it.

    Variables that are neither ports nor parameters are listed as left out.
    """
    from dse.interchange import import_component

    target = _target(folder)
    if name is not None and len(files) > 1:
        raise typer.BadParameter("only one FMU can be given a name", param_hint="--name")
    for file in files:
        written = import_component(file, target, name)
        _show_written(written.path, written.component, has_own_interface=written.has_own_interface)
        if written.starts:
            starts = plain(", ".join(written.starts))
            print_line(f"  inputs, with the values the FMU gives them itself: {starts}")
        for what in written.told:
            print_line(f"  {plain(what)}")
        for what in written.left_out:
            print_line(f"  left out: {plain(what)}")
    print_line("next: dse check")


@import_app.command("simulink")
def import_simulink(
    code: Annotated[Path, typer.Argument(metavar="DIR", help="The folder that the coder wrote, as acc_ert_rtw.")],
    folder: _Folder = None,
    name: Annotated[
        str | None, typer.Option("--name", metavar="NAME", help="The component's name; default: that of the model.")
    ] = None,
    model: Annotated[str, typer.Option("--model", metavar="NAME", help="Which model, if there are several.")] = "",
    step: Annotated[
        list[str],
        typer.Option(
            "--step",
            metavar="[NAME=]TIME",
            help="Its step, if the code does not give it; with NAME, that of one function of several.",
        ),
    ] = [],
    sources: Annotated[
        list[Path] | None,
        typer.Option("--source", metavar="PATH", help="More C sources that it needs: a file or a folder."),
    ] = None,
) -> None:
    """Import C or C++ from Simulink Coder as a component.

    Shows the ports, entry functions, parameters and step of the code, and the source of the step. Starts the code in a
    separate process, and writes DIR/components/NAME/component.yaml. The code is not copied.
    """
    from dse.cli.packages import seconds
    from dse.interchange import import_code
    from dse.simulink import block_of, systems

    steps = {function: seconds("--step", time) or 0.0 for function, _, time in (each.rpartition("=") for each in step)}
    whole = steps.pop("", None)
    if len(steps) + (whole is not None) < len(step):
        raise typer.BadParameter("a step is given twice", param_hint="--step")
    written = import_code(
        code, _target(folder), name, model=model, step=whole, steps=steps, sources=(*(sources or ()),)
    )
    made, timing = written.model.interface, written.model.timing
    known = systems(written.model.folder.texts[written.model.folder.header])
    language = "C++" if written.model.folder.is_cpp else "C"
    print_line(
        f"{plain(written.model.folder.model)}: {language}, {made.style}, every {timing.step:.12g} s by {timing.source}"
    )
    table = plain_table("", "in the code", "type", "block")
    for what, ports in (("input", made.inputs), ("output", made.outputs), ("parameter", made.parameters)):
        for port in ports[:_MOST_SHOWN]:
            table.add_row(what, plain(port.name), plain(port.scalar.name), plain(block_of(port.block, known)))
        if len(ports) > _MOST_SHOWN:
            table.add_row(what, f"and {len(ports) - _MOST_SHOWN} more")
    print_table(table)
    _show_written(written.path, written.component, has_own_interface=written.has_own_interface)
    for what in written.told:
        print_line(f"  {plain(what)}")
    for what in written.left_out:
        print_line(f"  left out: {plain(what)}")
    reals = [port for port in written.component.interface.ports if port.type.unit.symbol]
    taken = ", ".join(f"{port.name} in {port.type.unit}" for port in reals[:_MOST_SHOWN])
    print_line(
        f"  the code has no units: {taken or 'its numbers are taken as they are'}; otherwise set them with in_code"
    )
    print_line("next: dse check")


_MOST_SHOWN = 20


@import_app.command("ssp")
def import_ssp(
    package: Annotated[Path, typer.Argument(metavar="FILE", help="An SSP package (.ssp), or an unpacked one's .ssd.")],
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="The workspace to write to; created if it is new.")],
    stop: Annotated[str | None, typer.Option("--stop", metavar="TIME", help="Stop time of its benches.")] = None,
    step: Annotated[str | None, typer.Option("--step", metavar="TIME", help="Their communication step.")] = None,
) -> None:
    """Import an SSP package as a workspace.

    Its FMUs become components, its system a design space, and each of its variants a test bench with its parameter
    values. Where variants have different FMUs at a place, these are alternatives of the design.
    """
    from dse.cli.packages import seconds
    from dse.interchange import import_ssp as make

    made = make(package, folder, stop=seconds("--stop", stop), step=seconds("--step", step))
    for path in made.files:
        print_line(str(path))
    for what in made.left_out:
        print_line(f"left out: {plain(what)}")
    for bench in made.benches:
        more = f" --configuration {bench.configuration}" if bench.configuration else ""
        print_line(f"next: dse simulate {folder / 'testbenches' / bench.name}.yaml{more}")


@import_app.command("scenario")
def import_scenario(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="An OpenSCENARIO file (.xosc), or one that varies its parameters.")
    ],
    folder: _Folder = None,
    name: Annotated[
        str | None, typer.Option("--name", metavar="NAME", help="Of the components; default: that of the file.")
    ] = None,
    host: Annotated[
        str | None,
        typer.Option("--host", metavar="ENTITY", help="The entity under test; default: Ego, if there is one."),
    ] = None,
) -> None:
    """Import an OpenSCENARIO scenario as components.

    Its road users become DIR/components/traffic/NAME, the road of its host DIR/components/roads/NAME_road. The file,
    its road network and the catalogues that it uses are copied to DIR/scenarios/NAME.

    A file that varies parameters of a scenario also gives a table of cases for a study. Values that are decided when an
    FMU is built, as a road network or a catalogue entry, give a component each.
    """
    from dse.interchange import import_scenario as make

    target = _target(folder)
    made = make(file, target, name, host)
    for path in made.files:
        print_line(str(path))
    for problem in made.ignored:
        print_line(f"  ignored: {plain(str(problem))}")
    for each in made.traffic:
        print_line(f"{plain(each.component.name)}: {_counted(each.component.parameters, 'parameter')}")
        for line in _scenario_lines(each, target):
            print_line(f"  {plain(line)}")
    print_line("next: dse check")


def _scenario_lines(traffic: ImportedTraffic, folder: Path) -> Iterator[str]:
    """What a design, a test bench and a study need."""
    from dse.formats import write_text

    name = traffic.component.name
    if traffic.road:
        yield f"design (as designs/highway_scenario.yaml): compound: {{road: {traffic.road}}}"
    else:
        yield f"no road component: {traffic.no_road}"
    yield f"bench (as testbenches/_scenario.yaml): test_components: {{traffic: {{component: {name}}}}}"
    yield "  connections: [traffic.host_start -> road.host_start, traffic.host_start -> chassis.host_start]"
    if traffic.varied and traffic.is_product:
        yield f"study of {traffic.count} cases: conditions:"
        for parameter, values in traffic.varied.items():
            yield f"  traffic.{parameter}: {{values: [{', '.join(f'{value:.15g}' for value in values)}]}}"
    elif traffic.cases is not None:
        table = Path(os.path.relpath(traffic.cases.absolute(), (folder / "testbenches").absolute())).as_posix()
        yield f"study of {traffic.count} cases: sampler: {{csv: {{file: {write_text(table)}}}}}, design_variables:"
        for parameter, values in traffic.varied.items():
            yield f"  traffic.{parameter}: {{range: [{min(values):.15g}, {max(values):.15g}]}}"
    if traffic.uncertain:
        yield f"study: sampler: {{latin_hypercube: {{samples: {traffic.runs}}}}}, uncertain:"
        for parameter, found in traffic.uncertain.items():
            numbers = ", ".join(f"{key}: {value:.15g}" for key, value in found.numbers.items())
            yield f"  traffic.{parameter}: {{{found.kind}: {{{numbers}}}}}"


def _target(folder: Path | None) -> Path:
    """The workspace to write to; relative to this folder, so that paths that are shown can be clicked and copied."""
    from dse.loading import find_root

    return folder or Path(os.path.relpath(find_root(Path()) or Path()))


def _show_written(path: Path, component: Component, *, has_own_interface: bool) -> None:
    counts = f"{_counted(component.interface.ports, 'port')}, {_counted(component.parameters, 'parameter')}"
    print_line(f"{path}: {counts}")
    whose = "of its own" if has_own_interface else "of the workspace"
    print_line(f"  implements {component.interface.name}, an interface {whose}")


def _counted(things: Sized, what: str) -> str:
    return f"{len(things)} {what}" if len(things) == 1 else f"{len(things)} {what}s"


def _files(space: DesignSpace, folder: Path) -> dict[Path, str]:
    """What to write, by path. Raises DseError if one of the files is there already."""
    from dse.domain.design import Part, walk
    from dse.errors import Location, Problem, raise_if_any
    from dse.loading import write_components, write_design

    components = {node.name: node.component for _, node in walk(space.root) if isinstance(node, Part)}
    files = {
        folder / "components" / f"{space.name}.yaml": write_components(components.values()),
        folder / "designs" / f"{space.name}.yaml": write_design(space),
    }
    raise_if_any(
        Problem("the file already exists", Location(str(path)), "move it away; nothing is overwritten")
        for path in files
        if path.exists()
    )
    return files
