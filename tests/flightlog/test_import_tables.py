"""Tests of the forms, units and vehicles of imported tables."""

import json
from collections.abc import Callable
from math import pi
from pathlib import Path

import numpy as np
import pytest

from flightlog.attachment_names import IMPORT_ATTACHMENT
from flightlog.file.reader import read_log
from flightlog.log import FlightLog
from flightlog.topics import ESTIMATE
from maneuver.app import run
from tests.support.external.flown_circle import SPEED, TIME, check_circle, table, text

DEGREES = 180.0 / pi


def imported(folder: Path, content: str | bytes, *options: str, name: str = "flight.csv") -> FlightLog:
    path, out = folder / name, folder / "flight.mcap"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert run(["import", str(path), *options, "--out", str(out), "--force"]) == 0
    return read_log(out)


def refused(folder: Path, capsys: pytest.CaptureFixture[str], content: str, *options: str) -> str:
    path, out = folder / "flight.csv", folder / "refused.mcap"
    path.write_text(content)
    assert run(["import", str(path), *options, "--out", str(out)]) == 2
    assert not out.exists()
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    return message


def with_times(write: Callable[[float], str]) -> str:
    """Returns the circle's table with its times written in another way."""
    rows = text(table()).splitlines()
    written = [f"{write(time)},{row.partition(',')[2]}" for time, row in zip(TIME, rows[1:], strict=True)]
    return "\n".join([rows[0], *written]) + "\n"


def clock(time: float) -> str:
    seconds = 23 * 3600 + 59 * 60 + 55 + time
    return f"{int(seconds // 3600) % 24:02}:{int(seconds // 60) % 60:02}:{seconds % 60:09.6f}"


PLAIN = text(table())
HEADINGS, _, ROWS = PLAIN.partition("\n")

FORMS: dict[str, str | bytes] = {
    "trailing comma": text(table(), ending=","),
    "semicolons and decimal commas": text(table(), separator=";").replace(".", ","),
    "tabs": text(table(), separator="\t"),
    "blanks": text(table(), separator="  "),
    "bars": text(table(), separator="|"),
    "blanks after commas": text(table(), separator=", "),
    "units row": f"{HEADINGS}\ns,m,m,m,m/s,m/s,m/s,rad\n{ROWS}",
    "units in headings": f"Time [s],X (m),Y (m),Z (m),VX [m/s],VY [m/s],VZ [m/s],yaw_rad\n{ROWS}",
    "comments": f"# a flight\n# of somebody\n{PLAIN}# its end\n",
    "headings of NumPy": f"# {PLAIN}",
    "preamble": f"Flight of Tuesday\nvehicle,any\n\n{PLAIN}",
    "descending": "\n".join([HEADINGS, *reversed(ROWS.splitlines())]) + "\n",
    "UTF-16": PLAIN.encode("utf-16"),
    "UTF-16 without a mark": PLAIN.encode("utf-16-le"),
    "UTF-8 with a mark": PLAIN.encode("utf-8-sig"),
    "carriage returns": PLAIN.replace("\n", "\r\n"),
    "quoted": "\n".join(",".join(f'"{cell}"' for cell in row.split(",")) for row in PLAIN.splitlines()),
    "hours over midnight": with_times(clock),
    "dates": with_times(lambda time: f"2024-05-06T07:08:{9 + time:09.6f}Z"),
    "dates with a blank": with_times(lambda time: f"2024-05-06 07:08:{9 + time:09.6f}"),
}


@pytest.mark.parametrize("form", FORMS)
def test_a_table_is_read_in_any_usual_form(tmp_path: Path, form: str) -> None:
    states = imported(tmp_path, FORMS[form])[ESTIMATE]
    np.testing.assert_allclose(states.time, TIME, atol=1e-6)
    check_circle(states)


def test_endings_in_capitals_are_the_same_endings(tmp_path: Path) -> None:
    check_circle(imported(tmp_path, PLAIN, name="FLIGHT.CSV")[ESTIMATE])


def test_a_number_of_a_column_stands_for_its_heading(tmp_path: Path) -> None:
    rows = PLAIN.replace("time,x,y", "t,a,a", 1)
    check_circle(imported(tmp_path, rows, "--columns", "time=t", "x=#2", "y=#3")[ESTIMATE])


def test_rows_with_a_name_more_than_there_are_headings_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shifted = "\n".join([HEADINGS, *(f"{place},{row}" for place, row in enumerate(ROWS.splitlines()))])
    assert "8 headings above rows of 9 cells: give --columns NAME=#N" in refused(tmp_path, capsys, shifted)
    places = [f"{name}=#{place}" for place, name in enumerate(table(), start=2)]
    check_circle(imported(tmp_path, shifted, "--columns", *places)[ESTIMATE])


def test_columns_not_used_are_listed_with_a_name_they_could_have(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    columns = table()
    log = imported(
        tmp_path, text({**columns, "heading": columns["yaw"], "u": columns["vx"], "battery": TIME})
    )
    assert json.loads(log.attachments[IMPORT_ATTACHMENT])["not used"] == (
        "heading (could be yaw), u (could be body vx), battery"
    )
    assert "heading (could be yaw), u (could be body vx), battery\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "factor", "option"),
    [
        ("yaw", DEGREES, "--angle-unit deg"),
        ("vx vy vz", 1 / 0.3048, "--speed-unit ft/s"),
        ("vx vy vz", 3600 / 1852, "--speed-unit kn"),
        ("vx vy vz", 3.6, "--speed-unit km/h"),
        ("x y z", 1 / 0.3048, "--length-unit ft"),
        ("x y z", 100.0, "--length-unit cm"),
        ("x y z", 1e3, "--length-unit mm"),
    ],
)
def test_units_that_the_motion_contradicts_are_asked_for_and_then_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, factor: float, option: str
) -> None:
    columns = {
        heading: column * (factor if heading in name.split() else 1.0) for heading, column in table().items()
    }
    assert option in refused(tmp_path, capsys, text(columns))
    check_circle(imported(tmp_path, text(columns), *option.split())[ESTIMATE], atol=1e-5)
    # A heading that states the unit is enough.
    stated = {
        f"{heading} [{option.split()[1]}]" if heading in name.split() else heading: column
        for heading, column in columns.items()
    }
    check_circle(imported(tmp_path, text(stated))[ESTIMATE], atol=1e-5)


def test_wrapped_degrees_and_steep_angles_are_degrees(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    still = {"time": TIME, "roll": 0.0 * TIME, "pitch": 0.0 * TIME, "yaw": (350.0 + TIME) % 360.0}
    assert "yaw jumps by 360 and reaches 360: give --angle-unit deg" in refused(tmp_path, capsys, text(still))
    steep = {**still, "yaw": 0.0 * TIME, "pitch": 20.0 * np.sin(TIME)}
    assert "pitch reaches 20, more than 1.57 rad" in refused(tmp_path, capsys, text(steep))
    many = {**still, "yaw": 2.0 * TIME}
    assert "--angle-unit deg or --angle-unit rad" in refused(tmp_path, capsys, text(many))
    turned = imported(tmp_path, text(many), "--angle-unit", "rad")[ESTIMATE]
    np.testing.assert_allclose(turned["yaw_rate"], 2.0, atol=1e-6)


def test_body_rates_in_degrees_are_noticed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    columns = {**table(), "wz": np.full(len(TIME), 0.2 * DEGREES)}
    assert "give --rate-unit deg/s" in refused(tmp_path, capsys, text(columns))
    states = imported(tmp_path, text(columns), "--rate-unit", "deg/s")[ESTIMATE]
    np.testing.assert_allclose(states["body_yaw_rate"], 0.2, atol=1e-6)


def test_body_velocities_are_told_from_those_of_the_world(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    columns = {**table(), "vx": np.full(len(TIME), SPEED), "vy": 0.0 * TIME}
    assert "give --velocity-in body" in refused(tmp_path, capsys, text(columns))
    check_circle(imported(tmp_path, text(columns), "--velocity-in", "body")[ESTIMATE])


def test_two_vehicles_in_one_table_are_told_apart(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = {**table(), "time": TIME + 0.005, "x": table()["x"] + 100.0}
    rows = np.concatenate(
        [
            np.column_stack([np.full(1000, float(number)), *columns.values()])
            for number, columns in ((1, table()), (2, other))
        ]
    )
    rows = rows[np.argsort(rows[:, 1], kind="stable")]
    both = text(dict(zip(["id", *other], rows.T, strict=True)))
    assert "has several vehicles: give --vehicle-id, one of 1, 2" in refused(tmp_path, capsys, both)
    assert "no vehicle 3; it has 1, 2" in refused(tmp_path, capsys, both, "--vehicle-id", "3")
    check_circle(imported(tmp_path, both, "--vehicle-id", "1")[ESTIMATE])
    np.testing.assert_allclose(imported(tmp_path, both, "--vehicle-id", "2")[ESTIMATE]["north"][0], 100.0)


def test_latitudes_and_longitudes_are_laid_on_a_plane(tmp_path: Path) -> None:
    pytest.importorskip("pymap3d", reason="pymap3d is an extra")
    # Radii of curvature of WGS 84 at the first point, independent of the library.
    latitude, first, flattening = np.radians(47.0), 6_378_137.0, 1.0 / 298.257223563
    squared = flattening * (2.0 - flattening)
    bow = 1.0 - squared * np.sin(latitude) ** 2
    meridian, normal = first * (1.0 - squared) / bow**1.5 + 400.0, first / np.sqrt(bow) + 400.0
    columns = table()
    geodetic = {
        "time": TIME,
        "lat": 47.0 + np.degrees(columns["x"] / meridian),
        "lon": 8.0 + np.degrees(columns["y"] / (normal * np.cos(latitude))),
        "alt": 400.0 + 0.1 * TIME,
        "yaw": columns["yaw"],
    }
    log = imported(tmp_path, text(geodetic))
    # Nine decimals of a degree are a tenth of a millimetre.
    check_circle(log[ESTIMATE], fields=["north", "east"], atol=5e-4)
    np.testing.assert_allclose(log[ESTIMATE]["down"], -0.1 * TIME, atol=1e-6)
    assert "local plane at 47.0000000, 8.0000000" in log.attachments[IMPORT_ATTACHMENT].decode()


def test_a_pointer_of_git_lfs_is_named_as_such(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 5\n"
    assert "pointer of Git LFS" in refused(tmp_path, capsys, pointer)


def test_several_logs_become_one_log_each_with_a_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, out = tmp_path / "logs", tmp_path / "flights"
    folder.mkdir()
    for name in ("first.csv", "second.csv"):
        (folder / name).write_text(PLAIN)
    (folder / "third.csv").write_text("no table")
    assert run(["import", str(folder), "--out", str(out)]) == 2
    said = capsys.readouterr()
    assert said.err.count("\n") == 1
    assert [row.split()[1] for row in said.out.splitlines()] == ["19.98", "19.98", "not"]
    for name in ("first.mcap", "second.mcap"):
        check_circle(read_log(out / name)[ESTIMATE])
