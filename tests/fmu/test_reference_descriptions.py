"""The reference FMUs' descriptions are read as FMPy reads them, and their sources compile by themselves."""

from __future__ import annotations

import math
import zipfile

import fmpy
import pytest
from reference_fmus import MODELS
from reference_fmus.build import SOURCES, token_of
from reference_fmus.describe import BOTH, description
from reference_fmus.tables import c_tables

from dse.domain.fmu import FmiInterface
from dse.fmu.toolchain.platforms import this_platform
from dse.fmu.unpack import open_fmu

INTERFACES = {1: ("CoSimulation",), 2: BOTH, 3: BOTH}


def known_to_us(variable, version):
    items = dict.fromkeys(variable.items) if version == 1 else variable.items
    has_start = bool(variable.start)
    return variable.name, variable.reference, variable.fmi_type, items, variable.description, has_start


def known_to_fmpy(variable, version):
    """What FMPy knows of a variable, in our words; the values of FMI 1.0's items are not told."""
    kind = {"Enumeration": "Int64" if version == 3 else "Integer"}.get(variable.type, variable.type)
    items = {item.name: int(item.value) for item in variable.declaredType.items or ()} if variable.declaredType else {}
    if version == 1:
        items = dict.fromkeys(items)
    return variable.name, variable.valueReference, kind, items, variable.description or "", variable.start is not None


@pytest.mark.parametrize("version", INTERFACES)
@pytest.mark.parametrize("name", MODELS)
def test_variables_and_structure_are_those_fmpy_finds(described, name, version, tmp_path):
    model = MODELS[name]
    text = description(model, version, INTERFACES[version], token_of(model, version))
    ours = described(text)
    theirs = fmpy.read_model_description(str(described.folder), validate=False)
    found = [
        (
            v.name,
            v.reference,
            v.fmi_type,
            dict.fromkeys(v.items) if version == 1 else v.items,
            v.description,
            bool(v.start),
        )
        for v in ours.variables.values()
    ]
    assert found == [known_to_fmpy(variable, version) for variable in theirs.modelVariables]
    assert (ours.token, ours.identifier) == (theirs.guid, theirs.coSimulation.modelIdentifier)
    if version > 1:
        said = [(v.name, v.causality, v.unit or None) for v in ours.variables.values()]
        assert said == [(v.name, v.causality, v.unit) for v in theirs.modelVariables]
        exchange = described(text, FmiInterface.MODEL_EXCHANGE).exchange
        derivatives = [unknown.variable.valueReference for unknown in theirs.derivatives]
        states = [unknown.variable.derivative.valueReference for unknown in theirs.derivatives]
        assert (exchange.derivatives, exchange.states) == (tuple(derivatives), tuple(states))
        for output in theirs.outputs:
            known = output.dependencies
            expected = None if known is None else tuple(v.name for v in known if v.causality == "input")
            assert ours.depends.get(output.variable.name) == expected


@pytest.mark.parametrize("version", [2, 3])
def test_a_reference_model_compiled_from_its_sources_follows_the_closed_form(tmp_path, cache, version):
    model = MODELS["Dahlquist"]
    token = token_of(model, version)
    recipe = f"""<fmiBuildDescription fmiVersion="3.0"><BuildConfiguration modelIdentifier="Dahlquist">
      <SourceFileSet language="C11"><SourceFile name="fmi{version}.c"/>
        <PreprocessorDefinition name="MODEL" value="&quot;dahlquist.c&quot;"/>
        <PreprocessorDefinition name="IDENTIFIER" value="Dahlquist"/>
      </SourceFileSet></BuildConfiguration></fmiBuildDescription>"""
    contents = {
        f"sources/{path.name}": path.read_text(encoding="utf-8") for path in SOURCES.iterdir() if path.is_file()
    }
    contents["sources/variables.h"] = c_tables(model, version, token)
    contents["sources/buildDescription.xml"] = recipe
    contents["modelDescription.xml"] = description(model, version, BOTH, token)

    def written(name, more):
        with zipfile.ZipFile(tmp_path / name, "w") as archive:
            for path, content in (contents | more).items():
                archive.writestr(path, content)
        return tmp_path / name

    made = open_fmu(written("sources.fmu", {}), cache=cache)
    library = str(this_platform().library(version, "Dahlquist"))
    whole = written("whole.fmu", {library: made.library.read_bytes()})
    rows = fmpy.simulate_fmu(str(whole), stop_time=1.0, output_interval=0.1, fmi_type="CoSimulation")
    k = float(made.variables["k"].start[0])
    x0 = float(made.variables["x"].start[0])
    # Runge-Kutta of order 4 with steps of 0.01: an error of some 1e-11.
    assert rows["x"][-1] == pytest.approx(x0 * math.exp(-k), rel=1e-9)
