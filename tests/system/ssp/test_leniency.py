"""What a package should not hold and nothing needs is read over and told; what matters is refused as ever."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest
from ssp_packages import (
    NAMESPACES,
    binding,
    bindings,
    component,
    connection,
    connections,
    connectors,
    description,
    elements,
    entry,
    mapping,
    model,
    opened,
    parameter_set,
    resolved,
    variable,
)

from dse.errors import DseError
from dse.interchange.resolving.resolve import ResolvedSystem

FMUS = {"gain": model("gain", variable("u", "input"), variable("y", "output"), variable("k", "parameter"))}
PLAIN = elements(component("gain", "input u", "output y"))


def read(folder: Path, inner: str, files: Mapping[str, str | bytes] | None = None, after: str = "") -> ResolvedSystem:
    return resolved(folder, {"SystemStructure.ssd": description(inner, after), **(files or {})}, FMUS)


def ignored(*args, **options) -> list[str]:
    return [problem.what for problem in read(*args, **options).ignored]


def refused(*args, **options) -> str:
    with pytest.raises(DseError) as caught:
        read(*args, **options)
    return str(caught.value)


def gain(values: str, mapped: str = "") -> str:
    return elements(component("gain", "input u", "output y", more=bindings(binding(values, mapped))))


def test_nothing_is_ignored_in_a_package_as_the_standard_wants_it(tmp_path):
    assert ignored(tmp_path, gain(parameter_set("k Real 2"))) == []


def test_attributes_of_others_are_passed_over_but_a_misspelt_one_is_not(tmp_path):
    other = PLAIN.replace("<ssd:Component ", '<ssd:Component colour="red" ')
    assert ignored(tmp_path, other) == ["<Component> has no attribute 'colour'"]
    misspelt = PLAIN.replace("<ssd:Component ", '<ssd:Component implementaton="ModelExchange" ')
    assert "hint: did you mean 'implementation'?" in refused(tmp_path, misspelt)


def test_elements_of_other_namespaces_are_passed_over_even_where_they_are_called_like_ours(tmp_path):
    other = '<x:Elements xmlns:x="urn:x"><x:Component name="b" source="b.fmu"/></x:Elements><x:y xmlns:x="urn:x"/>'
    found = read(tmp_path, PLAIN + other)
    assert [element.name for element in found.structure.elements] == ["gain"]
    assert [problem.what for problem in found.ignored] == [
        "<Elements> is of the namespace 'urn:x'",
        "<y> is of the namespace 'urn:x'",
    ]
    assert "<y> is not allowed in <System>" in refused(tmp_path, PLAIN + "<ssd:y/>")


def test_a_parameter_set_of_an_almost_right_namespace_is_read(tmp_path):
    near = parameter_set("k Real 2").replace("SystemStructureParameterValues", "ParameterValues")
    (what,) = ignored(tmp_path, gain(near))
    assert what.startswith("<ParameterSet> is in the namespace 'http://ssp-standard.org/SSP1/ParameterValues', not")
    foreign = parameter_set("k Real 2").replace("ssp-standard.org/SSP1/SystemStructureParameterV", "example.org/v")
    assert "<ParameterValues> must hold one <ParameterSet>" in refused(tmp_path, gain(foreign))


def test_prefixes_that_are_bound_to_nothing_may_stand_in_annotations(tmp_path):
    osp = '<ssc:Annotation type="x"><osp:Step size="1"/></ssc:Annotation>'
    found = read(tmp_path, PLAIN, after=f"<ssd:Annotations>{osp}</ssd:Annotations>")
    assert [problem.what for problem in found.ignored] == ["the prefix 'osp' is bound to no namespace"]
    assert "SystemStructure.ssd:6:" in str(found.ignored[0])


@pytest.mark.parametrize("more", ["<osp:Step/>", '<osp:Elements><ssd:Component name="b"/></osp:Elements>'])
def test_elements_with_unbound_prefixes_are_not_ours(tmp_path, more):
    told = ignored(tmp_path, PLAIN + more)
    assert told[0] == "the prefix 'osp' is bound to no namespace"
    assert told[1].endswith("is of the namespace 'unbound:osp'")


def test_the_standards_own_prefixes_are_known_without_being_bound(tmp_path):
    values = parameter_set("k Real 2").replace(NAMESPACES, "")
    files = {"k.ssv": values}
    text = elements(component("gain", "input u", more=bindings('<ssd:ParameterBinding source="k.ssv"/>')))
    found = read(tmp_path, text, files)
    assert found.structure.elements[0].start == {"k": 2.0}
    assert [problem.what for problem in found.ignored] == ["the prefix 'ssv' is bound to no namespace"]


def test_an_entry_of_a_mapping_without_a_source_sets_nothing(tmp_path):
    rules = mapping(entry("", "y"), entry("a", "k"))
    found = read(tmp_path, gain(parameter_set("a Real 3"), rules))
    assert found.structure.elements[0].start == {"k": 3.0}
    assert [problem.what for problem in found.ignored] == ["no source is given for 'y'"]
    gone = rules.replace('source="a"', "")
    assert "<MappingEntry> has no 'source'" in refused(tmp_path, gain(parameter_set("a Real 3"), gone))


def test_a_value_that_is_given_twice_counts_once(tmp_path):
    found = read(tmp_path, gain(parameter_set("k Real 2", "k Real 2")))
    assert found.structure.elements[0].start == {"k": 2.0}
    assert [problem.what for problem in found.ignored] == ["the parameter 'k' is there twice"]


@pytest.mark.parametrize("again", ["k Real 3", "k Integer 2", "k Real 2 m"])
def test_two_values_for_one_thing_are_refused_only_where_they_would_be_used(tmp_path, again):
    told = refused(tmp_path, gain(parameter_set("k Real 2", again)))
    assert "gain.k is given two values; the other one is at " in told
    unused = again.replace("k", "other", 1)
    assert ignored(tmp_path, gain(parameter_set("k Real 2", "other Real 2", unused))) == [
        "the parameter 'other' is there twice, with another value"
    ]
    # What is given later counts more (SSP, 5.2.3), so that of the first set nothing is used.
    later = bindings(binding(parameter_set("k Real 2", again)), binding(parameter_set("k Real 5")))
    found = read(tmp_path, elements(component("gain", "input u", more=later)))
    assert found.structure.elements[0].start == {"k": 5.0}


@pytest.mark.parametrize(
    ("connector", "told"),
    [
        ("<ssd:Connector name='v' kind='input'/>", "the FMU of gain has no variable 'v'"),
        ("<ssd:Connector name='v' kind='output'/>", "the FMU of gain has no variable 'v'"),
        ("<ssd:Connector name='k' kind='input'/>", "gain.k is a connector of the kind input"),
        ("<ssd:Connector name='k' kind='parameter'><ssc:Binary/></ssd:Connector>", "the connector is Binary"),
    ],
)
def test_connectors_that_do_not_fit_are_refused_only_if_they_are_used(tmp_path, connector, told):
    name = connector[21]
    element = component("gain", "input u", "output y").replace("<ssd:Connectors>", f"<ssd:Connectors>{connector}")
    (what,) = ignored(tmp_path, elements(element))
    assert told in what
    is_output = "output" in connector
    outside = connectors("output x" if is_output else "input x")
    used = connections(connection(f"gain.{name}", ".x") if is_output else connection(".x", f"gain.{name}"))
    assert told in refused(tmp_path, outside + elements(element) + used)


def test_a_type_in_modelica_is_left_to_the_fmu(tmp_path):
    element = component("gain", "parameter k", more=bindings(binding(parameter_set("k Real 2"))))
    said = '><ssc:Binary mime-type="{}"/></ssd:Connector>'
    typed = element.replace("/></ssd:Connectors>", said.format("text/x-modelica; path=T") + "</ssd:Connectors>")
    found = read(tmp_path, elements(typed))
    assert found.structure.elements[0].start == {"k": 2.0}
    assert [problem.what for problem in found.ignored] == ["the type 'text/x-modelica; path=T' is left to the FMU"]
    other = typed.replace("text/x-modelica", "text/plain")
    assert "the connector is Binary, the FMU's variable real" in refused(tmp_path, elements(other))


def test_a_value_for_a_connector_of_another_type_is_a_use_of_it(tmp_path):
    element = component("gain", "parameter k", more=bindings(binding(parameter_set("k Real 2"))))
    typed = element.replace('kind="parameter"/>', 'kind="parameter"><ssc:Boolean/></ssd:Connector>')
    assert "the connector is bool" in refused(tmp_path, elements(typed))


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_entries_of_the_archive_that_nothing_needs_are_told_at_the_package(tmp_path):
    ssp = opened(tmp_path, {"SystemStructure.ssd": description(PLAIN), "./": "", "resources/con": "x"}, FMUS)
    assert [str(problem).partition("example.ssp: ")[2] for problem in ssp.ignored] == [
        "the entry './' is not a file",
        "the path 'resources/con' holds a name that is reserved on Windows",
    ]
