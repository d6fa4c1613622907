"""Trace files, read back with the readers of others: osi-python, ASAM's utilities, and the library of MCAP."""

from __future__ import annotations

import builtins
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from osi_utilities import MultiTraceReader, SingleTraceReader
from scenes import LIGHT, STEPS, made_up

import dse
from dse.domain.component import Kind, Type
from dse.domain.study import Selection
from dse.errors import DseError
from dse.report import Trace, rear_axle_of, require_packages, write_layout, write_mcap, write_osi
from dse.report.drawing.road_picture import Marking
from dse.report.scene.data import Sensor
from dse.testbench import bench_study

ROOT = Path(__file__).parents[2]
ONE, ZERO = np.ones(STEPS), np.zeros(STEPS)
TRACK = {
    "id": 3 * ONE,
    "class": ONE,
    "x": 41 * ONE,
    "y": -1 * ONE,
    "vx": 18 * ONE,
    "vy": ZERO,
    "width": 1.8 * ONE,
    "age": 0.4 * ONE,
    "existence": 0.9 * ONE,
}


def trace(**changed: Any) -> Trace:
    scene = made_up(**{"lights": {LIGHT.id: np.where(np.arange(STEPS) < 50, 3.0, 5.0)}, **changed})
    radar = {
        **scene.sensors[0].returns[0],
        "azimuth": 0.1 * ONE,
        "range_rate": -2 * ONE,
        "strength": 100 * ONE,
        **dict.fromkeys(("class", "width"), ZERO),
        **dict.fromkeys(("range_deviation", "azimuth_deviation", "rate_deviation"), 0.1 * ONE),
    }
    camera = {**radar, "rate_deviation": ZERO, "class": 5 * ONE, "width": 0.5 * ONE}
    scan = {"number": np.arange(STEPS) + 1.0, "age": 0.05 * ONE}
    sensors = (
        Sensor("radar", "A radar", 2.3, 150.0, 0.5, (radar,), scan=scan),
        Sensor("camera", "A camera", 1.0, 80.0, 0.5, (camera,), 0.6, 1.2, scan),
    )
    signals = {
        "speed_control.torque": np.where(np.arange(STEPS) == 2, np.inf, 5.0),
        **{f"speed_control.wheels[{number}]": number * ONE for number in (1, 2, 10)},
        **{f"tracker.tracks[1].{name}": values for name, values in TRACK.items()},
    }
    types = dict.fromkeys(signals, Type(Kind.REAL))
    return Trace(replace(scene, sensors=sensors), signals, types, rear_axle=1.4)


def read_osi(path: Path) -> list[Any]:
    reader = SingleTraceReader()
    assert reader.open(path)
    with reader:
        return [result.message for result in reader]


def test_ground_truth_is_read_back_by_asams_utilities_with_the_same_values(tmp_path: Path) -> None:
    made = trace()
    assert write_osi(made, tmp_path / "run_gt.osi") == STEPS
    read = read_osi(tmp_path / "run_gt.osi")
    assert len(read) == STEPS
    last = read[-1]
    assert (last.timestamp.seconds, last.timestamp.nanos, last.version.version_minor) == (10, 0, 8)
    host, pedestrian = last.moving_object
    # The scene places its centre of gravity, 2.3 m behind the bumper of a car of 4.5 m.
    assert (host.base.position.x, host.base.position.z) == (pytest.approx(200.05), 0.75)
    assert host.vehicle_attributes.bbcenter_to_rear.x == pytest.approx(-1.45)
    assert (pedestrian.id.value, pedestrian.base.position.x, pedestrian.type) == (2, 300.0, pedestrian.TYPE_PEDESTRIAN)
    lorry = read[0].moving_object[1]
    assert lorry.vehicle_classification.type == lorry.VehicleClassification.TYPE_HEAVY_TRUCK
    assert (len(read[0].lane), len(read[0].lane_boundary), len(last.lane)) == (1, 2, 0)
    left, right = (np.array([[p.position.x, p.position.y] for p in b.boundary_line]) for b in read[0].lane_boundary)
    assert np.array_equal(left, made.scene.ground.strips[0].left)
    assert np.array_equal(right, made.scene.ground.strips[0].right)
    lamps = {item.classification.color: item.classification.mode for item in read[0].traffic_light}
    kinds = type(read[0].traffic_light[0].classification)
    assert (lamps[kinds.COLOR_RED], lamps[kinds.COLOR_GREEN]) == (kinds.MODE_CONSTANT, kinds.MODE_OFF)
    assert [item.classification.mode for item in last.traffic_light] == [2, 2, 3]
    # Light falls to 5 % after 150 m: between 50 and 200 m.
    assert last.environmental_conditions.fog == last.environmental_conditions.FOG_THICK


def test_returns_and_tracks_are_sensor_data(tmp_path: Path) -> None:
    made = trace()
    for part in ("radar", "camera", "tracker"):
        assert write_osi(made, tmp_path / f"{part}_sd.osi", "sensor_data", part) == STEPS
    radar, camera, tracker = (read_osi(tmp_path / f"{p}_sd.osi")[20] for p in ("radar", "camera", "tracker"))
    assert radar.mounting_position.position.x == pytest.approx(3.7)  # ahead of the rear axle
    assert (radar.last_measurement_time.seconds, radar.last_measurement_time.nanos) == (1, 950_000_000)
    (found,) = radar.feature_data.radar_sensor
    assert (found.header.cycle_counter, found.header.number_of_valid_detections) == (21, 1)
    assert (found.detection[0].position.distance, found.detection[0].radial_velocity) == (40.0, 2.0)
    assert found.detection[0].snr == pytest.approx(20.0)
    (person,) = camera.moving_object
    assert np.hypot(person.base.position.x, person.base.position.y) == pytest.approx(40.0)
    assert person.candidate[0].type == person.candidate[0].DESCRIPTOR.fields_by_name["type"].enum_type.values[3].number
    assert not camera.feature_data.radar_sensor
    assert (camera.mounting_position.position.y, camera.mounting_position.orientation.yaw) == (0.6, 1.2)
    (car,) = tracker.moving_object
    assert (car.header.tracking_id.value, car.base.position.x) == (3, pytest.approx(42.4))
    assert car.base.velocity.x == pytest.approx(-2.0)  # relative to the host


def test_a_sensor_view_contains_the_ground_truth_and_a_part_must_be_named(tmp_path: Path) -> None:
    made = trace()
    write_osi(made, tmp_path / "run_gt.osi")
    write_osi(made, tmp_path / "run_sv.osi", "sensor_view", "camera")
    views, truths = read_osi(tmp_path / "run_sv.osi"), read_osi(tmp_path / "run_gt.osi")
    assert [view.global_ground_truth for view in views] == truths
    with pytest.raises(DseError, match="messages of one part") as caught:
        write_osi(made, tmp_path / "x.osi", "sensor_view")
    assert "radar, camera" in str(caught.value)
    with pytest.raises(DseError, match="'lidar' has no sensor_data messages"):
        write_osi(made, tmp_path / "x.osi", "sensor_data", "lidar")
    with pytest.raises(DseError, match="no sensor"):
        write_osi(replace(made, scene=replace(made.scene, sensors=())), tmp_path / "x.osi", "sensor_view")
    assert not (tmp_path / "x.osi").exists()


def test_an_mcap_file_has_all_channels_and_the_same_bytes_each_time(tmp_path: Path) -> None:
    made = trace()
    counts = write_mcap(made, tmp_path / "a.mcap", iter([(0.0, b"jpeg"), (5.0, b"jpeg")]))
    assert write_mcap(made, tmp_path / "b.mcap", iter([(0.0, b"jpeg"), (5.0, b"jpeg")])) == counts
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()
    assert counts == {
        "/scene/road": 1,
        "/camera": 2,
        **dict.fromkeys(
            (
                "/tf",
                "/scene/road_users",
                "/scene/radar",
                "/scene/camera",
                "/osi/ground_truth",
                "/signals/speed_control",
            ),
            STEPS,
        ),
        **dict.fromkeys((f"/osi/sensor_data/{name}" for name in ("radar", "camera", "tracker")), STEPS),
    }
    with (tmp_path / "a.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        signals = [json.loads(m.data) for _, _, m in reader.iter_messages(topics="/signals/speed_control")]
        times = [m.log_time for _, _, m in reader.iter_messages(topics="/tf")]
        frames = [decoded for _, _, _, decoded in reader.iter_decoded_messages(topics="/tf")]
        users = [decoded for _, _, _, decoded in reader.iter_decoded_messages(topics="/scene/road_users")]
        (road,) = (decoded for _, _, _, decoded in reader.iter_decoded_messages(topics="/scene/road"))
        truths = [decoded for _, _, _, decoded in reader.iter_decoded_messages(topics="/osi/ground_truth")]
    assert signals[2] == {"torque": None, "wheels": [1.0, 2.0, 10.0]}  # JSON has no infinity
    assert signals[3]["torque"] == 5.0
    assert times == [round(t * 1e9) for t in made.scene.time]
    assert [f.transforms[0].translation.x for f in frames] == list(made.scene.host.columns["x"])
    assert [transform.child_frame_id for transform in frames[0].transforms] == ["host", "radar", "camera"]
    assert users[0].entities[1].cubes[0].size.x == 12.0
    assert len(road.entities[0].triangles[0].points) == 6 * 9
    # Without markings in its file, a road has the borders of its lane: nine pieces each, with both ends of each.
    assert [len(entity.lines[0].points) for entity in road.entities[1:]] == [2 * 9, 2 * 9]
    assert [t.timestamp.seconds for t in truths[::10]] == list(range(11))
    # ASAM's own reader finds its channels in the same file.
    osi = MultiTraceReader()
    assert osi.open(tmp_path / "a.mcap")
    osi.set_topics(["/osi/ground_truth"])
    with osi:
        assert [r.message.SerializeToString(deterministic=True) for r in osi] == [
            truth.SerializeToString(deterministic=True) for truth in truths
        ]


def test_broken_markings_are_dashes_and_solid_ones_lines(tmp_path: Path) -> None:
    line = np.array([[0.0, 0, 0], [50, 0, 1]])
    marks = (
        Marking(line, "broken", 0.15, "yellow"),
        Marking(line, "solid", 0.2, "violet"),
        Marking(line, "none", 0, ""),
    )
    made = trace()
    ground = replace(made.scene.ground, markings=marks)
    write_mcap(replace(made, scene=replace(made.scene, ground=ground)), tmp_path / "a.mcap")
    with (tmp_path / "a.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        (road,) = (decoded for *_, decoded in reader.iter_decoded_messages(topics="/scene/road"))
    broken, solid = (entity.lines[0] for entity in road.entities[1:])
    assert [point.x for point in broken.points] == [0, 6, 18, 24, 36, 42]
    assert broken.points[3].z == pytest.approx(24 / 50 + 0.03)
    assert [point.x for point in solid.points] == [0, 50]
    assert (solid.thickness, solid.color.r, broken.color.b) == (0.2, pytest.approx(0.95), pytest.approx(0.15))


def test_a_layout_shows_what_is_in_the_file(tmp_path: Path) -> None:
    figures = {"Wheel": ("speed_control.wheels[2]", "speed_control.torque"), "Track": ("tracker.tracks[1].x",)}
    made = replace(trace(), plots=figures)
    counts = write_mcap(made, tmp_path / "a.mcap")
    write_layout(made, counts, tmp_path / "a.json")
    read = json.loads((tmp_path / "a.json").read_text())
    panels = read["configById"]
    assert set(panels["3D!scene"]["topics"]) == {t for t in counts if t.startswith("/scene/")}
    # Arrays of structures are not among the signals, and there are no pictures.
    assert list(panels) == ["3D!scene", "Plot!1"]
    assert [path["value"] for path in panels["Plot!1"]["paths"]] == [
        "/signals/speed_control.wheels[1]",
        "/signals/speed_control.torque",
    ]
    assert (read["layout"]["first"], read["layout"]["second"]) == ("3D!scene", "Plot!1")
    write_layout(replace(made, plots={}), {*counts, "/camera"}, tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text())["layout"]["second"] == "Image!camera"


def test_the_transform_turns_as_the_host_does(tmp_path: Path) -> None:
    angles = {"heading": 0.7 * ONE, "pitch": -0.1 * ONE, "roll": 0.05 * ONE}
    made = trace()
    host = replace(made.scene.host, columns={**made.scene.host.columns, **angles})
    write_mcap(replace(made, scene=replace(made.scene, host=host)), tmp_path / "a.mcap")
    from scipy.spatial.transform import Rotation

    with (tmp_path / "a.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        turn = next(decoded for *_, decoded in reader.iter_decoded_messages(topics="/tf")).transforms[0].rotation
    found = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w]).as_matrix()
    assert found == pytest.approx(Rotation.from_euler("ZYX", [0.7, -0.1, 0.05]).as_matrix(), abs=1e-12)


def test_the_rear_axle_follows_from_the_load_on_the_front_axle() -> None:
    assert rear_axle_of({"chassis.front_load_share": 0.55, "chassis.wheelbase": 2.7}) == pytest.approx(1.485)
    assert rear_axle_of({"world.speed": 3.0}) == 0


def test_without_the_packages_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None if name == "mcap" else builtins)
    with pytest.raises(DseError, match="not installed: mcap"):
        require_packages()


@pytest.mark.thorough
def test_a_run_of_a_study_becomes_a_trace_of_all_its_signals(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bench = dse.open(ROOT).benches["road_braking"]
    study = dse.Study.of(bench_study(bench.noun, Selection((bench.design.list(1)[0].id,))))
    results = study.explore(tmp_path / "study")
    source = ROOT / "testbenches" / "road_braking.yaml"
    counts = results.write_trace(0, tmp_path / "run.mcap", source=source, rate=10)
    again = results.write_trace(0, tmp_path / "again.mcap", source=source, rate=10)
    assert counts == again
    assert (tmp_path / "run.mcap").read_bytes() == (tmp_path / "again.mcap").read_bytes()
    steps = counts["/tf"]
    assert steps == round(bench.noun.simulation.stop * 10) + 1
    with (tmp_path / "run.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        truths = [decoded for *_, decoded in reader.iter_decoded_messages(topics="/osi/ground_truth")]
        speeds = [json.loads(m.data)["motion"]["speed"] for _, _, m in reader.iter_messages(topics="/signals/chassis")]
    hosts = [next(o for o in t.moving_object if o.id.value == 0) for t in truths]
    assert [np.hypot(h.base.velocity.x, h.base.velocity.y) for h in hosts] == pytest.approx(speeds, abs=1e-6)
    with pytest.raises(DseError, match=r"'run.csv' is not a trace file"):
        results.write_trace(0, tmp_path / "run.csv", source=source)
    # A part that is not there is refused before the simulation.
    monkeypatch.setattr("dse.api.studies.single_run.alone", None)
    for part in ("lidar", "chassis"):
        with pytest.raises(DseError, match=f"'{part}' has no sensor_view messages"):
            results.write_trace(0, tmp_path / "x.osi", message="sensor_view", part=part, source=source)
