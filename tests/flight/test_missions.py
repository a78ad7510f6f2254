"""Missions, sequences and campaigns as files: read exactly, refused in one line."""

from math import pi
from pathlib import Path

import pytest

from experiments.thesis.printed_libraries import thesis_gtmax
from flight.errors import BadFileError
from flight.mission.campaign import NoRuleForWindError, read_campaign
from flight.mission.mission import read_mission
from flight.mission.sequence import read_sequence
from planner.policies.nominal import nominal_planner
from scenarios.find import CAMPAIGNS, MISSIONS, SEQUENCES, find_mission

MISSION = """
name = "out"
[start]
position = [0.0, 1.0]
heading = 0.5
trim = 2
[goal]
position = [9.144, 0]
tolerance = 0.9144
[planner]
max_trims = 3
"""

SEQUENCE = """
name = "there and back"
trims = [1, 2, 1]
coasting_times = { shortest = 1.0, longest = 5.0, seed = 7 }
wind = "calm"
"""


def test_a_mission_is_read(tmp_path: Path) -> None:
    path = tmp_path / "out.toml"
    path.write_text(MISSION)
    mission = read_mission(path)
    assert (mission.start.x, mission.start.y, mission.start.heading, mission.start_trim) == (0.0, 1.0, 0.5, 2)
    assert (mission.goal, mission.tolerance, mission.max_trims) == ((9.144, 0.0), 0.9144, 3)
    assert (mission.goal_heading, mission.heading_tolerance, mission.goal_trim) == (None, pi, None)


@pytest.mark.parametrize("path", sorted(MISSIONS.glob("*.toml")), ids=lambda path: path.stem)
def test_a_shipped_mission_is_named_for_its_file(path: Path) -> None:
    assert read_mission(path).name == path.stem


@pytest.mark.parametrize("path", sorted(SEQUENCES.glob("*.toml")), ids=lambda path: path.stem)
def test_a_shipped_sequence_is_named_for_its_file(path: Path) -> None:
    assert read_sequence(path).name == path.stem


@pytest.mark.parametrize("path", sorted(CAMPAIGNS.glob("*.toml")), ids=lambda path: path.stem)
def test_a_shipped_campaign_is_named_for_its_file(path: Path) -> None:
    campaign = read_campaign(path)
    assert campaign.name == path.stem
    assert campaign.rule(campaign.wind).dwell > 0
    with pytest.raises(NoRuleForWindError, match="no maneuver_end for wind 'hurricane'; it has"):
        campaign.rule("hurricane")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("trim = 2", 'trim = "two"', "start.trim: .*integer"),
        ("tolerance = 0.9144", "tolerance = -1.0", "goal.tolerance: .*greater than or equal to 0"),
        ("tolerance = 0.9144", "tolerance = nan", "goal.tolerance: .*finite"),
        ("position = [9.144, 0]", "position = [9.144]", r"goal.position\[1\]: is missing"),
        ("position = [9.144, 0]", "", "goal.position: is missing"),
        ("max_trims = 3", "max_trims = 0", "planner.max_trims: .*greater than 0"),
        ("max_trims = 3", "max_trimz = 3", "planner.max_trimz: Extra inputs are not permitted"),
        ("heading = 0.5", "heading = 1e17", "start.heading: .*from -1000 to 1000 rad, got 1e.17 rad"),
        ("position = [9.144, 0]", "position = [9.144, -2e6]", r"goal.position\[1\]: .*1e.06 m, got -2e.06 m"),
        ("max_trims = 3", "max_trims = 9", "planner.max_trims: .*less than or equal to 8"),
        ("heading = 0.5", "heading = 1979-05-27", "got a date or time"),
        ("[goal]", "[goal", "is not TOML"),
    ],
)
def test_a_broken_mission_is_refused_in_one_line(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert MISSION.count(old) == 1
    path = tmp_path / "broken.toml"
    path.write_text(MISSION.replace(old, new))
    with pytest.raises(BadFileError, match=words) as caught:
        read_mission(path)
    assert "\n" not in str(caught.value)


def test_drawn_coasting_times_are_the_same_every_time(tmp_path: Path) -> None:
    path = tmp_path / "there and back.toml"
    path.write_text(SEQUENCE)
    sequence = read_sequence(path)
    assert sequence == read_sequence(path)
    assert len(set(sequence.coasting_times)) == 3
    assert all(1.0 <= time <= 5.0 for time in sequence.coasting_times)
    path.write_text(SEQUENCE.replace("seed = 7", "seed = 8"))
    assert read_sequence(path) != sequence


def test_a_sequence_has_a_coasting_time_for_each_trim(tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    path.write_text('name = "short"\ntrims = [1, 2, 1]\ncoasting_times = [1.0, 2.0]\n')
    with pytest.raises(BadFileError, match="one for each of the 3 trims, got 2"):
        read_sequence(path)


def test_a_heading_is_wanted_to_within_a_tolerance(tmp_path: Path) -> None:
    path = tmp_path / "heading.toml"
    path.write_text(MISSION.replace("[planner]", "heading = 1.0\n[planner]"))
    with pytest.raises(BadFileError, match="heading and heading_tolerance: expected both or none, got one"):
        read_mission(path)
    path.write_text(MISSION.replace("[planner]", "heading = 1.0\nheading_tolerance = 0.2\n[planner]"))
    assert (read_mission(path).goal_heading, read_mission(path).heading_tolerance) == (1.0, 0.2)


@pytest.mark.parametrize(("position", "heading"), [(1e6, 1e3), (-1e6, -1e3), (1e6, -999.9)])
def test_the_farthest_mission_that_a_file_may_say_has_a_plan_that_passes_its_check(
    tmp_path: Path, position: float, heading: float
) -> None:
    path = tmp_path / "far.toml"
    path.write_text(
        MISSION.replace("heading = 0.5", f"heading = {heading}")
        .replace("position = [9.144, 0]", f"position = [{position}, {-position}]")
        .replace("tolerance = 0.9144", "tolerance = 0.0")
    )
    assert nominal_planner(thesis_gtmax()).plan(read_mission(path)).verified


def test_a_mission_names_the_place_of_a_trim_that_the_library_lacks(tmp_path: Path) -> None:
    path = tmp_path / "lost.toml"
    for old, key in (("trim = 2", "start.trim"), ("[planner]", "goal.trim")):
        path.write_text(MISSION.replace(old, "trim = 99" if old != "[planner]" else "trim = 99\n[planner]"))
        with pytest.raises(BadFileError, match=rf"lost.toml: {key}: no trim 99; the library has \[1, 2"):
            find_mission(str(path), thesis_gtmax())
