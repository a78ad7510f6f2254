"""Flights with all content of a review page, and their pages."""

from dataclasses import replace

import numpy as np

from flight.plan.plan import Plan, Policy, Scenario, Status
from flight.se2 import SE2
from flightlog.attachment_names import VEHICLE_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import CONTROLS, NAVIGATION, TRUTH
from review.page.page import ReviewedFlight, review_page
from review.summary.control_limits import control_limits
from review.summary.summary import summarise

from .altered_logs import bound_for, planned, planning, with_attachment
from .synthetic_log import synthetic_library, synthetic_log

LIBRARY = synthetic_library()
WALK, COASTS = (1, 2, 3, 7), (2.0,) * 4


def whole_flight(*, coasts: tuple[float, ...] = COASTS, seed: int = 1, name: str = "synthetic") -> FlightLog:
    """Returns a mission's log with all topics and attachments reviewed."""
    log = synthetic_log(
        LIBRARY, WALK, coasts, seed=seed, start=SE2(5.0, -3.0, 0.7), kind="mission", name=name
    )
    truth = log[TRUTH]
    controls = Series(CONTROLS, truth.time, 0.1 * truth.values[:, :8])
    spread = Series(NAVIGATION, truth.time[::5], np.full((len(truth.time[::5]), 9), 0.2))
    plans = [planning(time, WALK, coasts, gammas=(0.0, -1.0)) for time in (0.0, 3.0, 6.0)]
    servos = {"cyclic_limit": 0.1, "collective_low": -0.1, "collective_high": 0.2}
    vehicle = {"servos": {**servos, "pedal_low": -0.3, "pedal_high": 0.4}}
    series = {**log.series, CONTROLS.name: controls, NAVIGATION.name: spread}
    log = with_attachment(replace(log, series=series), VEHICLE_ATTACHMENT, vehicle)
    log = planned(log, [*plans, planning(9.0, reason="nothing </script> found")])
    return bound_for(log, (20.0, 10.0), 2.0)


def page_of(*logs: FlightLog) -> str:
    flights = [ReviewedFlight(log, summarise(log), f"flight {place}") for place, log in enumerate(logs)]
    return review_page(flights, limits=control_limits(logs[0]))


def plan_of(
    walk: tuple[int, ...],
    maneuvers: tuple[int, ...],
    scenarios: tuple[Scenario, ...],
    *,
    status: Status = "optimal",
    policy: Policy = "worst-case",
    reason: str = "",
) -> Plan:
    """Returns a plan to be drawn."""
    return Plan(
        status=status,
        reason=reason,
        library="l",
        library_hash="",
        mission="out",
        policy=policy,
        gamma=0.0 if policy == "nominal" else 1.0,
        tolerance=2.0,
        sequence=walk,
        maneuvers=maneuvers,
        scenarios=scenarios,
    )
