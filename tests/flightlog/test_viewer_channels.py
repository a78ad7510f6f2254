"""Tests of the viewer channels against the flight."""

import io
from collections.abc import Iterator
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.PosesInFrame_pb2 import PosesInFrame
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.message import Message
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader

import models
from flight.plan.planned_track import planned_tube
from flight.se2 import SE2
from flightlog.attachment_names import MODEL_ATTACHMENT, PLANS_ATTACHMENT
from flightlog.events import Level, flight_events
from flightlog.file.writer import log_bytes
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ESTIMATE, PRIMITIVE, TRUTH
from flightlog.viewers.message_template import NANOSECONDS, SECONDS, fill_template
from flightlog.viewers.viewer_channels import EVENTS, PATH, SCENE, TRANSFORMS, ViewerTopic, viewer_channels
from flightlog.viewers.z_up_frames import ESTIMATED_VEHICLE, VEHICLE, WORLD, attitudes, positions
from tests.support.altered_logs import bound_for, planned, planning
from tests.support.synthetic_log import synthetic_library, synthetic_log

LIBRARY = synthetic_library()
WALK = (1, 2, 3, 7)
COASTS = (2.0,) * 4


def of_a_mission(log: FlightLog) -> FlightLog:
    """Returns the log as a mission log with plan, failure and model."""
    plans = [
        planning(0.0, WALK, COASTS, gammas=(0.0, -1.0)),
        planning(3.0, reason="nothing reaches the goal"),
    ]
    log = bound_for(planned(log, plans), (20.0, 10.0), 2.0)
    model = (models.FOLDER / "gtmax.xml").read_bytes()
    return replace(log, attachments={**log.attachments, MODEL_ATTACHMENT: model})


@pytest.fixture(scope="module")
def flight() -> FlightLog:
    return of_a_mission(
        synthetic_log(LIBRARY, WALK, COASTS, seed=1, start=SE2(5.0, -3.0, 0.7), kind="mission")
    )


def messages(log: FlightLog, topic: ViewerTopic) -> Iterator[tuple[float, Message]]:
    """Yields times and messages of a topic by the MCAP library."""
    reader = make_reader(io.BytesIO(log_bytes(log)), validate_crcs=True)
    for _, _, message in reader.iter_messages(topics=[topic.name]):
        yield message.log_time * 1e-9, topic.message.FromString(message.data)


def test_a_transform_puts_the_vehicle_where_it_was(flight: FlightLog) -> None:
    truth, estimate = flight[TRUTH], flight[ESTIMATE]
    found = list(messages(flight, TRANSFORMS))
    for time, message in (found[0], found[7], found[-1]):
        assert isinstance(message, FrameTransforms)
        for transform, states in zip(message.transforms, (truth, estimate), strict=True):
            assert transform.parent_frame_id == WORLD
            row = int(np.argmin(np.abs(states.time - time)))
            assert transform.translation.x == states["east"][row]
            assert transform.translation.y == states["north"][row]
            assert transform.translation.z == -states["down"][row]
            assert transform.timestamp.ToNanoseconds() == round(time * 1e9)
        assert [part.child_frame_id for part in message.transforms] == [VEHICLE, ESTIMATED_VEHICLE]
    times = np.array([time for time, _ in found])
    assert times[0] == 0.0
    assert times[-1] == pytest.approx(truth.time[-1], abs=1e-9)
    assert np.diff(times).max() <= 0.04 + 1e-9


@given(
    roll=st.floats(-1.0, 1.0),
    pitch=st.floats(-1.0, 1.0),
    heading=st.floats(-7.0, 7.0),
    axis=st.integers(0, 2),
)
def test_the_attitude_of_viewers_turns_the_body_as_ours_does(
    roll: float, pitch: float, heading: float, axis: int
) -> None:
    """Compares body axes by Euler rotations with the quaternion."""
    state = np.zeros((1, len(TRUTH.fields)))
    for name, value in (("roll", roll), ("pitch", pitch), ("heading", heading)):
        state[0, TRUTH.field_names.index(name)] = value
    x, y, z, w = attitudes(Series(TRUTH, np.zeros(1), state))[0]
    (sr, sp, sh), (cr, cp, ch) = np.sin([roll, pitch, heading]), np.cos([roll, pitch, heading])
    about_down = np.array([[ch, -sh, 0], [sh, ch, 0], [0, 0, 1]])
    about_right = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_forward = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    north, east, down = (about_down @ about_right @ about_forward)[:, axis]
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    # The viewer's vehicle has left and up where ours has right and down.
    sign = (1.0, -1.0, -1.0)[axis]
    np.testing.assert_allclose(sign * turn[:, axis], [east, north, -down], atol=1e-12)


def test_the_path_is_the_true_track_from_start_to_end(flight: FlightLog) -> None:
    ((time, path),) = messages(flight, PATH)
    assert isinstance(path, PosesInFrame)
    assert (time, path.frame_id) == (0.0, WORLD)
    flown = positions(flight[TRUTH])
    for pose, expected in ((path.poses[0], flown[0]), (path.poses[-1], flown[-1])):
        np.testing.assert_array_equal([pose.position.x, pose.position.y, pose.position.z], expected)


def test_the_scene_holds_vehicle_goal_track_and_each_plan_when_it_is_made(flight: FlightLog) -> None:
    ((_, scene),) = messages(flight, SCENE)
    assert isinstance(scene, SceneUpdate)
    entities = {entity.id: entity for entity in scene.entities}
    assert set(entities) == {"vehicle", "flown", "goal", "plan"}
    vehicle = entities["vehicle"]
    solids = ([*vehicle.spheres], [*vehicle.cubes], [*vehicle.cylinders])
    model = ElementTree.parse(models.FOLDER / "gtmax.xml")
    assert sum(len(kind) for kind in solids) == len(list(model.findall(".//body/geom")))
    assert (vehicle.frame_id, vehicle.frame_locked) == (VEHICLE, True)
    disc = entities["goal"].cylinders[0]
    assert (disc.pose.position.x, disc.pose.position.y, disc.size.x) == (10.0, 20.0, 4.0)
    assert entities["plan"].triangles[0].points


def test_without_a_model_the_vehicle_is_an_arrow_and_without_a_mission_there_is_no_goal() -> None:
    ((_, scene),) = messages(synthetic_log(LIBRARY, WALK, COASTS, seed=1), SCENE)
    assert isinstance(scene, SceneUpdate)
    assert [entity.id for entity in scene.entities] == ["vehicle", "flown"]
    assert scene.entities[0].arrows


def test_events_tell_primitives_plannings_and_the_end(flight: FlightLog) -> None:
    lost = replace(flight, header=replace(flight.header, outcome="flight lost at 9.00 s: met the ground"))
    events = [(time, message.name, message.message) for time, message in messages(lost, EVENTS)]  # type: ignore[attr-defined]
    assert events[0] == (0.0, "primitive", "hold 1 hover")
    assert "plan 1: 21.00 s through trims 1 2 3 7 (worst-case, feasible)" in [text for _, _, text in events]
    assert (3.0, "plan", "plan 2: none; nothing reaches the goal") in events
    assert events[-1][1:] == ("flight", "flight lost at 9.00 s: met the ground")
    levels = [message.level for _, message in messages(lost, EVENTS)]  # type: ignore[attr-defined]
    assert levels[-1] == Log.ERROR
    assert sum(source == "primitive" for _, source, _ in events) == 2 * len(WALK) - 1


def test_a_broken_attachment_is_an_event_and_the_rest_is_drawn(flight: FlightLog) -> None:
    broken = replace(flight, attachments={**flight.attachments, PLANS_ATTACHMENT: b"[{]"})
    errors = [event.text for event in flight_events(broken) if event.level is Level.ERROR]
    assert errors == [text for text in errors if text.startswith("plans.json: is not JSON")]
    assert errors
    assert {channel.topic.name for channel in viewer_channels(broken)} == {
        *(TRANSFORMS.name, PATH.name, EVENTS.name)
    }


def test_a_log_with_an_estimate_alone_is_drawn_from_it(flight: FlightLog) -> None:
    series = {name: part for name, part in flight.series.items() if name not in {TRUTH.name, PRIMITIVE.name}}
    drawn = [message for _, message in messages(replace(flight, series=series), TRANSFORMS)]
    assert len(drawn) > 100
    for message in drawn:
        assert isinstance(message, FrameTransforms)
        assert [part.child_frame_id for part in message.transforms] == [VEHICLE]


def test_a_tube_of_no_uncertainty_is_a_line_and_a_wide_one_is_not() -> None:
    walk = (LIBRARY, WALK, COASTS)
    thin = planned_tube(*walk, start=SE2.identity(), level=0.0)
    assert np.ptp(thin, axis=0).max() == 0.0
    wide = planned_tube(*walk, start=SE2.identity(), level=1.0)
    assert np.linalg.norm(np.ptp(wide[:, -1], axis=0)) > 0.5


@given(times=st.lists(st.integers(0, 2**45), min_size=1, max_size=5), value=st.floats(allow_nan=False))
def test_a_filled_template_is_the_message_that_the_runtime_reads(times: list[int], value: float) -> None:
    template = FrameTransforms()
    part = template.transforms.add(child_frame_id="vehicle")
    part.timestamp.seconds, part.timestamp.nanos = SECONDS, NANOSECONDS
    part.translation.x, part.translation.z = 1e300, 2e300
    columns = {1e300: np.full(len(times), value), 2e300: np.arange(len(times), dtype=np.float64)}
    filled = fill_template(template, times=np.array(times), columns=columns)
    for row, time in enumerate(times):
        read = FrameTransforms.FromString(filled[row].tobytes()).transforms[0]
        assert (read.timestamp.ToNanoseconds(), read.child_frame_id) == (time, "vehicle")
        assert (read.translation.x, read.translation.z) == (value, float(row))
