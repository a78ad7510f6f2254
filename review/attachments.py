"""What a closed-loop flight's attachments say about where it was going: its mission and its plans."""

import json
from dataclasses import dataclass
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, FiniteFloat, NonNegativeFloat, TypeAdapter, ValidationError

from flight.arrival import Destination
from flight.errors import BadFileError
from flight.file_model import first_problem
from flight.log import MISSION_ATTACHMENT, PLANS_ATTACHMENT, FlightLog

Content = TypeVar("Content")


@dataclass(frozen=True, slots=True)
class PlanOfFlight:
    """One plan of a receding-horizon flight, as far as a picture needs it.

    Attributes:
        time: seconds since the flight's start at which it was made.
        gamma: uncertainty level of its deciding scenario.
        cost: seconds that the deciding scenario takes.
        sequence: trim ids.
        coasting_times: seconds in each trim, of the deciding scenario.
    """

    time: float
    gamma: float
    cost: float
    sequence: tuple[int, ...]
    coasting_times: tuple[float, ...]


class _Part(BaseModel):
    """Attachments may say more than is read here."""

    model_config = ConfigDict(extra="ignore", frozen=True, allow_inf_nan=False)


class _Settings(_Part):
    final_tolerance: NonNegativeFloat | None = None


class _Mission(_Part):
    goal: tuple[FiniteFloat, FiniteFloat]
    tolerance: NonNegativeFloat
    settings: _Settings = _Settings()


class _Scenario(_Part):
    gamma: FiniteFloat
    cost: FiniteFloat
    coasting_times: tuple[NonNegativeFloat, ...]


class _Plan(_Part):
    time: NonNegativeFloat
    sequence: tuple[int, ...]
    scenarios: tuple[_Scenario, ...]


def goal_of_flight(log: FlightLog) -> Destination | None:
    """Returns where the flight was to go, or None where the log does not say.

    Raises:
        BadFileError: the attachment is there, but broken.
    """
    mission = _attachment(log, MISSION_ATTACHMENT, TypeAdapter(_Mission))
    if mission is None:
        return None
    # What the loop was closed with comes before what the mission's file says.
    return Destination(mission.goal, mission.settings.final_tolerance or mission.tolerance)


def plans_of_flight(log: FlightLog) -> tuple[PlanOfFlight, ...]:
    """Returns the plans that had something to fly, in order; empty where the log has none.

    Raises:
        BadFileError: the attachment is there, but broken.
    """
    plans = _attachment(log, PLANS_ATTACHMENT, TypeAdapter(tuple[_Plan, ...])) or ()
    return tuple(_deciding(plan) for plan in plans if plan.scenarios)


def _deciding(plan: _Plan) -> PlanOfFlight:
    scenario = max(plan.scenarios, key=lambda scenario: scenario.cost)
    return PlanOfFlight(plan.time, scenario.gamma, scenario.cost, plan.sequence, scenario.coasting_times)


def _attachment(log: FlightLog, name: str, content: TypeAdapter[Content]) -> Content | None:
    if name not in log.attachments:
        return None
    try:
        return content.validate_python(json.loads(log.attachments[name]))
    except ValidationError as error:
        raise BadFileError(name, first_problem(error)) from None
    except ValueError as error:
        raise BadFileError(name, f"is not JSON: {error}") from None
