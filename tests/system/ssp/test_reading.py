"""Packages are read as the standard says; what is wrong is told at its line, all at once."""

from __future__ import annotations

import zipfile

import pytest
from ssp_packages import (
    bindings,
    component,
    connection,
    connections,
    connectors,
    description,
    elements,
    model,
    opened,
    pack,
    parameter_set,
    variable,
)

from dse.errors import DseError
from dse.interchange.reading.open import open_ssp
from dse.interchange.structure import System

GAIN = {"gain": model("gain", variable("u", "input"), variable("y", "output"), variable("k", "parameter"))}
PLAIN = elements(component("gain", "input u", "output y"))


def problems(tmp_path, text, files=()) -> list[str]:
    with pytest.raises(DseError) as caught:
        opened(tmp_path, {"SystemStructure.ssd": text, **dict(files)}, GAIN)
    return [str(problem) for problem in caught.value.problems]


def test_a_description_is_read_with_its_experiment(tmp_path):
    text = description(PLAIN, '<ssd:DefaultExperiment startTime="0" stopTime="2.5"/>')
    ssp = opened(tmp_path, {"SystemStructure.ssd": text}, GAIN)
    assert (ssp.name, ssp.version, ssp.variant) == ("example", "1.0", "SystemStructure")
    assert (ssp.experiment.start, ssp.experiment.stop, ssp.experiment.step) == (0.0, 2.5, None)
    assert [(c.name, c.kind) for c in ssp.places["gain"].connectors] == [("u", "input"), ("y", "output")]
    assert ssp.places["gain"].fmu.name == "gain.fmu"


def test_the_step_of_omsimulators_annotations_is_read(tmp_path):
    master = '<oms:FixedStepMaster xmlns:oms="urn:oms" description="oms-ma" stepSize="0.001"/>'
    annotation = f'<ssd:Annotations><ssc:Annotation type="org.openmodelica">{master}</ssc:Annotation></ssd:Annotations>'
    ssp = opened(tmp_path, {"SystemStructure.ssd": description(PLAIN + annotation)}, GAIN)
    assert ssp.experiment.step == 0.001
    assert ssp.notes == ()


@pytest.mark.parametrize("around", ["Algorithm", "SimulationInformation"])
def test_the_step_of_osps_annotations_is_read(tmp_path, around):
    step = f'<osp:{around} xmlns:osp="urn:osp"><osp:FixedStepAlgorithm baseStepSize="1e-4"/></osp:{around}>'
    kind = "com.opensimulationplatform"
    annotation = f'<ssd:Annotations><ssc:Annotation type="{kind}">{step}</ssc:Annotation></ssd:Annotations>'
    experiment = f'<ssd:DefaultExperiment startTime="0">{annotation}</ssd:DefaultExperiment>'
    ssp = opened(tmp_path, {"SystemStructure.ssd": description(PLAIN, experiment)}, GAIN)
    assert ssp.experiment.step == 1e-4
    assert ssp.notes == ()


def test_annotations_nobody_reads_are_told(tmp_path):
    annotation = '<ssd:Annotations><ssc:Annotation type="com.example.colours"/></ssd:Annotations>'
    ssp = opened(tmp_path, {"SystemStructure.ssd": description(PLAIN + annotation)}, GAIN)
    assert [note.what for note in ssp.notes] == ["the annotation 'com.example.colours' is not used"]


def test_geometry_says_nothing_and_is_let_pass(tmp_path):
    more = '<ssd:SystemGeometry x1="0" y1="0" x2="10" y2="10"/>'
    assert opened(tmp_path, {"SystemStructure.ssd": description(PLAIN + more)}, GAIN).notes == ()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("<a/>", ":1:1: <SystemStructureDescription> is expected here, not <a>"),
        (description(PLAIN).replace('version="1.0"', 'version="Draft20170606"'), ":2:1: the version 'Draft20170606' of SSP"),
        (
            description(PLAIN).replace("http://ssp-standard.org/SSP1/SystemStructureDescription", "http://www.pmsf.net/xsd/SystemStructureDescriptionDraft"),
            "drafts before SSP 1.0 are not supported",
        ),
        ("<ssd:SystemStructureDescription", "not XML"),
        ('<!DOCTYPE x [<!ENTITY a "b">]><x/>', "refused as unsafe"),
        (description(PLAIN.replace('kind="input"', 'kind="inputt"')), ":4:"),
        (description(PLAIN.replace(' name="u"', "")), "<Connector> has no 'name'"),
        (description(PLAIN.replace("<ssd:Component ", '<ssd:Component sauce="x" ')), "<Component> has no attribute 'sauce'"),
        (description(PLAIN + "<ssd:Conections/>"), "<Conections> is not allowed in <System>\n    hint: did you mean 'Connections'?"),
        (description(PLAIN + connections('<ssd:Connection startElement="gain" endElement="gain"/>')), "has no 'startConnector'"),
        (description(elements(component("gain"), component("gain"))), "two elements are called 'gain'"),
        (description(PLAIN, '<ssd:DefaultExperiment stopTime="soon"/>'), "'stopTime' is 'soon', not a number"),
        (description(PLAIN, '<ssd:Units><ssc:Unit name="m"/></ssd:Units>'), "the unit 'm' has no <BaseUnit>"),
        (description(PLAIN, '<ssd:Units><ssc:Unit name="m"><ssc:BaseUnit m="1" factor="0"/></ssc:Unit></ssd:Units>'), "factor cannot be 0"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_where_it_stands(tmp_path, text, expected):
    found = problems(tmp_path, text)
    assert any(expected in problem for problem in found), found
    assert all("example.ssp/SystemStructure.ssd:" in problem for problem in found)


@pytest.mark.parametrize("number", ["INF", "NaN", "-INF", "1e999", "0x1", "", "1,5"])
@pytest.mark.parametrize(
    "text",
    [
        description(PLAIN, '<ssd:DefaultExperiment stopTime="?"/>'),
        description(PLAIN, '<ssd:DefaultExperiment startTime="?"/>'),
        description(PLAIN, '<ssd:Units><ssc:Unit name="x"><ssc:BaseUnit factor="?"/></ssc:Unit></ssd:Units>'),
        description(PLAIN, '<ssd:Units><ssc:Unit name="x"><ssc:BaseUnit offset="?"/></ssc:Unit></ssd:Units>'),
        description(PLAIN + connections(connection("gain.y", "gain.u", '<ssc:LinearTransformation factor="?"/>'))),
        description(PLAIN + connections(connection("gain.y", "gain.u", '<ssc:LinearTransformation offset="?"/>'))),
    ],
)
def test_numbers_that_are_none_are_refused(tmp_path, text, number):
    (found,) = problems(tmp_path, text.replace('"?"', f'"{number}"'))
    assert "SystemStructure.ssd:" in found


@pytest.mark.parametrize("number", ["0", "-1"])
def test_a_stop_time_is_positive(tmp_path, number):
    (found,) = problems(tmp_path, description(PLAIN, f'<ssd:DefaultExperiment stopTime="{number}"/>'))
    assert f"'stopTime' must be positive, not {number}" in found


def test_all_problems_of_all_files_are_told_at_once(tmp_path):
    text = description(
        elements(
            component("gain", more=bindings('<ssd:ParameterBinding source="resources/values.ssv"/>')),
            component("other", source="resources/missing.fmu"),
            component("third", source="resources/gain.fmu").replace(
                "<ssd:Component", '<ssd:Component type="x/unknown"'
            ),
        )
    )
    found = problems(
        tmp_path, text, {"resources/values.ssv": parameter_set("k Real one").replace("<ssv:Real", "<ssv:Reel")}
    )
    assert len(found) == 4
    joined = "\n".join(found)
    assert "resources/values.ssv:1:" in joined
    assert "<Reel> is not allowed in <Parameter>" in joined
    assert "there is no file 'resources/missing.fmu' in the package" in joined
    assert "is of the type 'x/unknown', which is not supported" in joined


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("../gain.fmu", "leads out of the package"),
        ("resources/../../gain.fmu", "leads out of the package"),
        ("/etc/passwd", "is not a relative path"),
        ("file:///etc/passwd", "is not in the package"),
        ("https://example.org/gain.fmu", "is not in the package"),
        ("resources/%2e%2e/%2e%2e/gain.fmu", "leads out of the package"),
        ("C:\\gain.fmu", "is not in the package"),
        ("resources\\gain.fmu", "is not a relative path"),
        ("resources/gone.fmu", "there are gain.fmu"),
        ("resources", "there is no file 'resources' in the package"),
    ],
)
def test_only_files_in_the_package_are_read(tmp_path, source, expected):
    (found,) = problems(tmp_path, description(elements(component("gain", source=source))))
    assert expected in found
    assert "SystemStructure.ssd:4:" in found


def test_a_percent_encoded_source_is_found(tmp_path):
    files = {"SystemStructure.ssd": description(elements(component("gain", source="resources/my%20gain.fmu")))}
    ssp = opened(tmp_path, {**files, "resources/my gain.fmu": b""}, {})
    assert ssp.places["gain"].fmu.name == "my gain.fmu"


@pytest.mark.parametrize("name", ["../evil.txt", "/evil.txt", "resources/../../evil.txt", "C:/evil.txt"])
def test_no_entry_of_a_package_is_written_outside_of_its_folder(tmp_path, name):
    path = pack(tmp_path / "bad.ssp", {"SystemStructure.ssd": description(PLAIN), name: b"evil"})
    with pytest.raises(DseError, match="refused as unsafe"):
        open_ssp(path, tmp_path / "unpacked")
    assert not list(tmp_path.rglob("evil.txt"))


def test_a_bomb_is_not_unpacked(tmp_path):
    with zipfile.ZipFile(tmp_path / "bomb.ssp", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("SystemStructure.ssd", description(PLAIN))
        archive.writestr("resources/zeros", b"\0" * (64 * 2**20))
    with pytest.raises(DseError, match="unpacks to more than 200 times its size"):
        open_ssp(tmp_path / "bomb.ssp", tmp_path / "unpacked")


@pytest.mark.parametrize(
    ("content", "expected"),
    [(b"PK\x03\x04 cut", "is not a complete zip file"), (b"", "is not a complete zip file")],
)
def test_what_is_no_zip_file_is_refused(tmp_path, content, expected):
    (tmp_path / "broken.ssp").write_bytes(content)
    with pytest.raises(DseError, match=expected):
        open_ssp(tmp_path / "broken.ssp", tmp_path / "unpacked")


def test_a_package_needs_a_description(tmp_path):
    with pytest.raises(DseError, match=r"there is no SystemStructure.ssd in it"):
        open_ssp(pack(tmp_path / "empty.ssp", {"readme.txt": "nothing"}), tmp_path / "unpacked")


def test_a_variant_is_named_by_its_file_or_by_the_name_inside(tmp_path):
    files = {
        "SystemStructure.ssd": description(PLAIN, name="light"),
        "Heavy.ssd": description(PLAIN, name="with trailer"),
        "resources/gain.fmu": b"",
    }
    path = pack(tmp_path / "two.ssp", files)
    assert open_ssp(path, tmp_path).name == "light"
    assert open_ssp(path, tmp_path).variants == {"SystemStructure": "light", "Heavy": "with trailer"}
    for word in ("Heavy", "Heavy.ssd", "with trailer"):
        assert open_ssp(path, tmp_path, word).variant == "Heavy"
    with pytest.raises(DseError, match=r"it has no variant 'Havy'(.|\n)*did you mean 'Heavy'"):
        open_ssp(path, tmp_path, "Havy")


def test_an_unpacked_package_is_read_from_its_description(tmp_path):
    (tmp_path / "resources").mkdir()
    (tmp_path / "resources" / "gain.fmu").write_bytes(b"")
    (tmp_path / "Other.ssd").write_text(description(PLAIN, name="other"), encoding="utf-8")
    assert open_ssp(tmp_path / "Other.ssd", tmp_path / "unpacked").name == "other"


def test_systems_come_from_other_files_and_packages_and_by_their_id(tmp_path):
    inner = pack(
        tmp_path / "inner.ssp",
        {
            "SystemStructure.ssd": description(connectors("input a") + PLAIN, name="inner"),
            "B.ssd": description(elements(component("other", source="resources/gain.fmu")), name="b"),
            "resources/gain.fmu": b"",
        },
    ).read_bytes()
    package = 'type="application/x-ssp-package" '
    definition = 'type="application/x-ssp-definition" '
    text = description(
        elements(
            component("p", source="resources/inner.ssp").replace("source=", f"{package}source="),
            component("b", source="resources/inner.ssp#B.ssd").replace("source=", f"{package}source="),
            component("d", source="resources/part.ssd").replace("source=", f"{definition}source="),
            component("again", source="#shared").replace("source=", f"{definition}source="),
            f'<ssd:System name="s" id="shared">{PLAIN}</ssd:System>',
        )
    )
    files = {
        "SystemStructure.ssd": text,
        "resources/inner.ssp": inner,
        "resources/part.ssd": description(elements(component("gain", source="gain.fmu"))),
    }
    ssp = opened(tmp_path, files, GAIN)
    assert list(ssp.places) == ["p.gain", "b.other", "d.gain", "again.gain", "s.gain"]
    assert isinstance(ssp.system.element("p"), System)


def test_a_system_that_holds_itself_is_refused(tmp_path):
    own = component("me", source="#top").replace("source=", 'type="application/x-ssp-definition" source=')
    text = description(elements(own)).replace('<ssd:System name="top"', '<ssd:System name="top" id="top"')
    assert "nested more than 20 levels deep" in problems(tmp_path, text)[0]


def test_connections_are_read_with_their_transformation(tmp_path):
    linear = '<ssc:LinearTransformation factor="2.5" offset="-1"/>'
    joined = connections(connection("gain.y", "gain.u", linear, suppressUnitConversion="true"))
    (found,) = opened(tmp_path, {"SystemStructure.ssd": description(PLAIN + joined)}, GAIN).system.connections
    assert (str(found.start), str(found.end), found.suppresses_unit_conversion) == ("gain.y", "gain.u", True)
    assert (found.transformation.factor, found.transformation.offset) == (2.5, -1.0)
    assert found.where.line == 4


def test_values_inside_an_fmu_are_found(tmp_path):
    archive = pack(tmp_path / "gain.fmu", {"extra/values.ssv": parameter_set("k Real 7")}).read_bytes()
    inside = bindings('<ssd:ParameterBinding source="extra/values.ssv" sourceBase="component"/>')
    files = {
        "SystemStructure.ssd": description(elements(component("gain", more=inside))),
        "resources/gain.fmu": archive,
    }
    (found,) = opened(tmp_path, files, {}).places["gain"].assignments
    assert (found.target, found.value.values) == ("k", ("7",))
