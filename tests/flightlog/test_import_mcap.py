"""Tests of the import of MCAP files from other programs."""

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flight.automaton.library import Library
from flight.automaton.library_file import library_text, read_library
from flightlog.attachment_names import IMPORT_ATTACHMENT
from flightlog.file.reader import read_log
from flightlog.file.writer import write_log
from flightlog.imports.axes import Axes, quaternions_from_euler
from flightlog.imports.measured_motion import attitude_source
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ESTIMATE, TRUTH
from flightlog.viewers.z_up_frames import attitudes
from maneuver.app import run
from tests.support.external_bags import plain_bag, ros2_bag
from tests.support.synthetic_log import synthetic_library, synthetic_log


def tilted() -> Series:
    """Returns a motion that excites all axes."""
    time = 0.02 * np.arange(400)
    heading, roll, pitch = 2.0 + 0.5 * time, 0.3 + 0.2 * np.sin(time), -0.2 + 0.1 * np.cos(1.3 * time)
    forward, side, descent = 3.0 + np.sin(time), 0.5 * np.cos(time), 0.2 * np.sin(0.7 * time)
    c, s = np.cos(heading), np.sin(heading)
    north = np.cumsum(0.02 * (c * forward - s * side))
    east = np.cumsum(0.02 * (s * forward + c * side))
    down = -20.0 + np.cumsum(0.02 * descent)
    rates = [np.gradient(angle, time) for angle in (roll, pitch, heading)]
    p = rates[0] - np.sin(pitch) * rates[2]
    q = np.cos(roll) * rates[1] + np.sin(roll) * np.cos(pitch) * rates[2]
    r = -np.sin(roll) * rates[1] + np.cos(roll) * np.cos(pitch) * rates[2]
    columns = [north, east, down, forward, side, descent, roll, pitch, heading, p, q, r, rates[2]]
    return Series(TRUTH, time, np.column_stack(columns))


FLOWN = tilted()


@pytest.fixture(scope="module")
def bags(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("bags")
    paths = {"ros": folder / "ros.mcap", "plain": folder / "plain.mcap"}
    paths["ros"].write_bytes(ros2_bag(FLOWN))
    paths["plain"].write_bytes(plain_bag(FLOWN))
    return paths


def imported(bag: Path, folder: Path, *options: str) -> FlightLog:
    out = folder / "flight.mcap"
    assert run(["import", str(bag), *options, "--out", str(out), "--force", "--json"]) == 0
    return read_log(out)


@pytest.mark.parametrize(
    ("bag", "options", "tolerance"),
    [
        ("ros", ("--pose", "/odom"), 1e-9),
        ("ros", ("--pose", "/pose", "--velocity", "/velocity"), 1e-9),
        ("ros", ("--pose", "/pose", "--velocity", "/odom"), 1e-9),
        ("ros", ("--pose", "/fmu/out/vehicle_odometry"), 2e-5),
        ("plain", ("--pose", "/odometry"), 1e-9),
        ("plain", ("--pose", "/pose", "--velocity", "/odometry"), 1e-9),
    ],
)
def test_every_number_of_the_motion_comes_back(
    bags: dict[str, Path], tmp_path: Path, bag: str, options: tuple[str, ...], tolerance: float
) -> None:
    estimate = imported(bags[bag], tmp_path, *options)[ESTIMATE]
    np.testing.assert_allclose(estimate.time, FLOWN.time, atol=1e-6)
    for field in FLOWN.topic.field_names:
        if field in {"heading", "yaw_rate"}:
            continue
        np.testing.assert_allclose(estimate[field], FLOWN[field], atol=tolerance, err_msg=field)
    # The heading may differ by whole turns; its rate was differentiated numerically.
    turns = (estimate["heading"] - FLOWN["heading"]) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.rint(turns), atol=tolerance)
    np.testing.assert_allclose(estimate["yaw_rate"], FLOWN["yaw_rate"], atol=1e-4)


def test_json_gives_pose_and_velocity_and_the_rest_is_absent(
    bags: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ("--pose", "/json_pose", "--velocity", "/json_velocity", "--as", "truth")
    log = imported(bags["plain"], tmp_path, *options)
    summary = json.loads(capsys.readouterr().out)
    truth = log[TRUTH]
    np.testing.assert_allclose(truth["side"], FLOWN["side"], atol=1e-9)
    assert not truth.has_fields("roll_rate")
    assert summary["absent_of_the_state"] == ["roll_rate", "pitch_rate", "body_yaw_rate"]
    assert {"/estimate", "/wind", "/command"} <= set(summary["absent"])
    # Without body rates the rate of the heading is its slope.
    np.testing.assert_allclose(truth["yaw_rate"], 0.5, atol=1e-6)


def test_a_pose_alone_is_differentiated_and_this_is_recorded(bags: dict[str, Path], tmp_path: Path) -> None:
    log = imported(bags["ros"], tmp_path, "--pose", "/pose")
    assert json.loads(log.attachments[IMPORT_ATTACHMENT])["velocity"] == "the slope of the position"
    inner = slice(1, -1)
    np.testing.assert_allclose(log[ESTIMATE]["forward"][inner], FLOWN["forward"][inner], atol=0.03)


def test_stated_axes_are_used_and_wrong_ones_are_detected(
    bags: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    right = ("--pose", "/odom", "--world", "enu", "--body", "flu", "--velocity-in", "body")
    log = imported(bags["ros"], tmp_path, *right)
    assert capsys.readouterr().err == ""
    out = tmp_path / "refused.mcap"
    for wrong, words in (
        (("--velocity-in", "world"), "velocities differ from the slope of the positions by"),
        (("--velocity-in", "world"), "give --velocity-in body"),
        (("--world", "ned"), "inverted flight most of the time: give --body frd"),
    ):
        order = ["import", str(bags["ros"]), "--pose", "/odom", *wrong, "--out", str(out)]
        assert run(order) == 2
        assert words in capsys.readouterr().err
        assert not out.exists()
    twisted = imported(bags["ros"], tmp_path, "--pose", "/odom", "--velocity-in", "world", "--unchecked")
    assert not np.allclose(twisted[ESTIMATE].values, log[ESTIMATE].values, atol=0.1)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "expected --pose TOPIC"),
        (
            ("--pose", "/pos"),
            "no topic /pos; it has /fmu/out/vehicle_odometry (px4_msgs/msg/VehicleOdometry)",
        ),
        (("--pose", "/velocity"), "/velocity (geometry_msgs/msg/TwistStamped): expected a position"),
        (("--pose", "/pose", "--velocity", "/pose"), "expected a velocity, got none"),
        (("--pose", "/pose", "--columns", "time=t"), "--columns: not valid for an .mcap file"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_one_line(
    bags: dict[str, Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    options: tuple[str, ...],
    words: str,
) -> None:
    out = tmp_path / "flight.mcap"
    assert run(["import", str(bags["ros"]), *options, "--out", str(out)]) == 2
    refusal = capsys.readouterr().err
    assert words in refusal
    assert refusal.count("\n") == 1
    assert not out.exists()


def test_damaged_bags_are_refused_in_one_line(
    bags: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content, rng = bags["ros"].read_bytes(), np.random.default_rng(5)
    path, refused = tmp_path / "damaged.mcap", 0
    for trial in range(30):
        broken = bytearray(content[: rng.integers(0, len(content))] if trial % 2 else content)
        for place in rng.integers(0, max(len(broken), 1), 20 if broken else 0):
            broken[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(bytes(broken))
        code = run(["import", str(path), "--pose", "/odom", "--out", str(tmp_path / "out.mcap"), "--force"])
        message = capsys.readouterr().err
        assert code in {0, 2}
        if code == 2:
            refused += 1
            assert message.count("\n") == 1
    assert refused >= 15


def along(library: Library, walk: tuple[int, ...]) -> Library:
    """Returns a library of the trims and maneuvers of a walk."""
    trims, edges = set(walk), set(pairwise(walk))
    joined = [one for one in library.maneuvers if (one.from_trim, one.to_trim) in edges]
    rule = library.conditions.maneuver_end
    assert rule is not None
    bands = {trim: band for trim, band in rule.bands.items() if trim in trims}
    return replace(
        library,
        trims=tuple(trim for trim in library.trims if trim.id in trims),
        maneuvers=tuple(replace(one, id=place) for place, one in enumerate(joined, start=1)),
        conditions=replace(library.conditions, maneuver_end=replace(rule, bands=bands)),
    )


def with_rates_of_the_turn(states: Series) -> Series:
    """Returns states whose body rates agree with their yaw rate.

    Those of a synthetic log do not.
    """
    values = states.values.copy()
    turning = np.cos(states["pitch"]) * states["yaw_rate"]
    for field, share in (("pitch_rate", np.sin(states["roll"])), ("body_yaw_rate", np.cos(states["roll"]))):
        values[:, states.topic.field_names.index(field)] = share * turning
    return replace(states, values=values)


def test_an_imported_flight_gives_the_library_that_its_original_gives(tmp_path: Path) -> None:
    walk, coasts = (1, *(2, 3, 7, 3, 2, 1) * 2), (3.0,) * 13
    library = along(synthetic_library(), walk)
    flown = synthetic_log(library, walk, coasts, seed=1)
    bag, named = tmp_path / "bag.mcap", tmp_path / "named.json"
    logs = {"imported": tmp_path / "imported.mcap", "original": tmp_path / "original.mcap"}
    truth = with_rates_of_the_turn(flown[TRUTH])
    bag.write_bytes(ros2_bag(truth, topics=["/odom"]))
    named.write_text(library_text(library))
    write_log(replace(flown, series={TRUTH.name: truth}), logs["original"])
    assert run(["import", str(bag), "--pose", "/odom", "--as", "truth", "--out", str(logs["imported"])]) == 0
    found = {}
    for name, log in logs.items():
        out = tmp_path / f"{name}.json"
        order = ["identify", str(log), "--trims", str(named), "--out", str(out), "--workers", "1"]
        assert run(order) == 0
        found[name] = read_library(out)
    assert len(found["imported"].maneuvers) == 6
    for ours, theirs in zip(found["original"].maneuvers, found["imported"].maneuvers, strict=True):
        assert theirs.duration == pytest.approx(ours.duration, abs=1e-6)
        assert theirs.displacement.x == pytest.approx(ours.displacement.x, abs=1e-4)
        assert theirs.displacement.heading == pytest.approx(ours.displacement.heading, abs=1e-5)


quaternions = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)


@given(quaternion=quaternions)
def test_axes_turn_as_matrices_do(quaternion: tuple[float, ...]) -> None:
    w, x, y, z = np.array(quaternion) / np.linalg.norm(quaternion)
    theirs = Rotation.from_quat([x, y, z, w]).as_matrix()
    swap, flip = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]]), np.diag([1.0, -1, -1])
    ours = Axes("enu", "flu").in_ned_frd(np.array([[w, x, y, z]]))[0]
    np.testing.assert_allclose(
        Rotation.from_quat(ours[[1, 2, 3, 0]]).as_matrix(), swap @ theirs @ flip, atol=1e-12
    )
    same = Axes("ned", "frd").in_ned_frd(np.array([[w, x, y, z]]))
    np.testing.assert_array_equal(same, [[w, x, y, z]])


@given(roll=st.floats(-3.1, 3.1), pitch=st.floats(-1.5, 1.5), yaw=st.floats(-3.1, 3.1))
def test_angles_of_a_quaternion_of_angles_are_these_angles(roll: float, pitch: float, yaw: float) -> None:
    one = quaternions_from_euler(*(np.array([angle]) for angle in (roll, pitch, yaw)))
    angles = attitude_source(np.zeros(1), one).columns
    np.testing.assert_allclose(
        [angles[name][0] for name in ("roll", "pitch", "heading")], [roll, pitch, yaw], atol=1e-7
    )


def test_the_viewers_channels_of_a_ros_bag_are_its_own_poses_again() -> None:
    """Checks that export to viewers inverts the import."""
    from tests.support.external_bags import MatrixMotion

    there = attitudes(replace(FLOWN))
    theirs = MatrixMotion(FLOWN).quaternions
    same = np.minimum(np.abs(there - theirs).max(axis=1), np.abs(there + theirs).max(axis=1))
    assert same.max() < 1e-12
