"""Pictures of a validation from its stored results."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from experiments.mission.policies import FlownPolicy, planner_of
from experiments.mission.result import FlownLeg, MissionResult
from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from review.pictures.flight_picture import write_picture

from .bundle_picture import bundle_picture
from .closed_loop_picture import closed_loop_picture
from .flight_style import FlightTrack, LegTrack
from .gamma_picture import LevelSummary, gamma_picture
from .occurrence_picture import occurrence_picture
from .prediction_picture import prediction_picture
from .scorecard import Proportion, ScorecardCell
from .time_bound_trial import TimeBoundTrial

MOST_MAPS = 24
"""Largest number of maps over all plants and winds."""

MOST_BUNDLES = 8
"""Largest number of missions with bundle pictures."""

MOST_FLIGHTS = 8
"""Largest number of flights of one policy on one map."""

WORLDS = 40
"""Number of worlds of a bundle picture."""


def write_validation_pictures(
    folder: Path,
    results: Sequence[MissionResult],
    missions: Sequence[Mission],
    library: Library,
    *,
    totals: Sequence[ScorecardCell],
    time_bounds: Sequence[TimeBoundTrial],
) -> None:
    """Writes all pictures of a validation.

    Args:
        folder: output folder.
        results: all flights.
        missions: missions flown.
        library: library of the plans.
        totals: cells of all missions together, one per condition.
        time_bounds: calibrated time bounds.
    """
    highest = max((row.gamma for row in results), default=0.0)
    places = list(dict.fromkeys((row.plant, row.wind) for row in results))
    for place in places:
        rows = [row for row in results if (row.plant, row.wind) == place]
        own = [bound for bound in time_bounds if (bound.plant, bound.wind) == place]
        _draw_condition(folder, rows, missions[: max(MOST_MAPS // len(places), 1)], library, time_bounds=own)
    for mission in missions[:MOST_BUNDLES]:
        plans = _plans(mission, library, tuple(dict.fromkeys(row.policy for row in results)), highest)
        figure = bundle_picture(mission, library, plans, _worlds(library), gamma=highest or 1.0)
        write_picture(figure, folder / f"bundle-{mission.name}.png", force=True)
    _draw_over_levels(folder / "gamma.png", totals, library)


def _draw_condition(
    folder: Path,
    rows: Sequence[MissionResult],
    missions: Sequence[Mission],
    library: Library,
    *,
    time_bounds: Sequence[TimeBoundTrial],
) -> None:
    """Draws one plant in one wind, worst case at the highest gamma."""
    highest = max(row.gamma for row in rows)
    own = [row for row in rows if row.policy in {"nominal", "feedback"} or row.gamma == highest]
    plant, wind = own[0].plant, own[0].wind
    words = f"{plant}, wind {wind}" if wind != "none" else f"automaton, {plant}"
    stem = words.replace(",", "").replace("wind ", "").replace("+", "").replace(" ", "-")
    for mission in missions:
        _draw_map(
            folder / f"map-{mission.name}-{stem}.png", mission, library, own, gamma=highest, words=words
        )
    flights = [_flight_track(row, library) for row in own]
    title = f"{library.name}, {words}"
    bars = occurrence_picture(flights, library, title=title)
    write_picture(bars, folder / f"occurrence-{stem}.png", force=True)
    factors: dict[str, float] = {
        bound.policy: bound.factor
        for bound in time_bounds
        if bound.factor is not None and bound.gamma in {0.0, highest}
    }
    points = prediction_picture(flights, factors, title=title)
    write_picture(points, folder / f"predicted-{stem}.png", force=True)


def _draw_map(
    path: Path,
    mission: Mission,
    library: Library,
    rows: Sequence[MissionResult],
    *,
    gamma: float,
    words: str,
) -> None:
    own = [row for row in rows if row.mission == mission.name]
    policies = tuple(dict.fromkeys(row.policy for row in own))
    flights = [
        _flight_track(row, library)
        for policy in policies
        for row in [row for row in own if row.policy == policy][:MOST_FLIGHTS]
    ]
    plans = _plans(mission, library, policies, gamma)
    figure = closed_loop_picture(mission, library, plans, flights, title=f"{mission.name}: {words}")
    write_picture(figure, path, force=True)


def _plans(
    mission: Mission, library: Library, policies: Sequence[FlownPolicy], gamma: float
) -> dict[str, Plan]:
    return {
        policy: planner_of(policy, library, gamma=gamma).plan(mission)
        for policy in policies
        if policy != "feedback"
    }


def _worlds(library: Library) -> list[Library]:
    """Returns libraries with independent uniform errors of every primitive."""
    rng = np.random.default_rng(0)
    worlds = []
    for _ in range(WORLDS):
        trims = [replace(trim, velocity=trim.at(rng.uniform(-1, 1))) for trim in library.trims]
        maneuvers = []
        for maneuver in library.maneuvers:
            outcome = maneuver.at(rng.uniform(-1, 1))
            maneuvers.append(
                replace(maneuver, duration=max(outcome.duration, 0.0), displacement=outcome.displacement)
            )
        worlds.append(replace(library, trims=tuple(trims), maneuvers=tuple(maneuvers)))
    return worlds


def _draw_over_levels(path: Path, totals: Sequence[ScorecardCell], library: Library) -> None:
    """Draws success and time over the true gamma, or the planned one."""
    of_plant = [cell for cell in totals if cell.plant.startswith("gamma ")]
    rows = [_level_summary(cell, float(cell.plant.removeprefix("gamma "))) for cell in of_plant]
    axis = "true gamma of the automaton"
    if not rows:
        first = [cell for cell in totals if (cell.plant, cell.wind) == (totals[0].plant, totals[0].wind)]
        rows = [_level_summary(cell, cell.gamma) for cell in first]
        axis = "gamma of the plans"
    if max(sum(row.policy == policy for row in rows) for policy in {row.policy for row in rows}) > 1:
        write_picture(gamma_picture(rows, title=f"{library.name}: all missions", axis=axis), path, force=True)


def _level_summary(cell: ScorecardCell, level: float) -> LevelSummary:
    return LevelSummary(
        policy=cell.policy,
        level=level,
        reached=_with_interval(cell.reached),
        inside=_with_interval(cell.inside),
        flown_time=cell.flown_time,
        predicted_time=cell.predicted_time,
    )


def _with_interval(share: Proportion) -> tuple[float, float, float]:
    return share.count / share.of, share.low, share.high


def _flight_track(row: MissionResult, library: Library) -> FlightTrack:
    return FlightTrack(
        policy=row.policy,
        reached=row.reached,
        flown_time=row.flown_time,
        predicted_time=row.predicted_time,
        level=row.gamma,
        legs=tuple(_leg_track(leg, library) for leg in row.legs),
    )


def _leg_track(leg: FlownLeg, library: Library) -> LegTrack:
    maneuver = None if leg.to_trim is None else library.maneuver(leg.trim, leg.to_trim).id
    return LegTrack(leg.trim, maneuver, leg.duration, np.array(leg.track).reshape(-1, 2))
