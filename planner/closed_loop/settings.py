"""Settings of the closed loop."""

from dataclasses import dataclass, field
from math import inf

from .latency import Latency

LONGEST_INTERVAL = 3600.0
"""Seconds between two replans; long enough to fly a whole plan without replanning."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of the closed loop.

    Attributes:
        activation_interval: seconds between two replans; a maneuver under way is finished first.
        max_activations: replans after which the vehicle stops safely.
        final_tolerance: metres within which the goal counts as reached; None for the mission's.
        tolerance_share: share of the remaining distance; replaces the replan's tolerance if it is larger than
            the final one (thesis, 6.3.1).
        aim: share of the final tolerance that replans use: a plan of least time ends at the edge of its
            tolerance, where any error misses.
        latency: planning latency, during which the vehicle flies on.
        replan_in_maneuver: True to replan during every maneuver from its predicted end, so that
            the plan is ready there (thesis, 6.3.3).
        hysteresis: seconds by which a new plan must be faster than one that still reaches the goal.
        learn_level: True to fly the coasting times of the estimated gamma, not of the deciding one.
        arrival_probability: probability of being inside the tolerance, by the vehicle's own covariance, at
            which it declares arrival; 0 trusts the estimate.
        wait: seconds in the rest trim after a safe stop.
    """

    activation_interval: float = 0.5
    max_activations: int = 200
    final_tolerance: float | None = None
    tolerance_share: float = 0.0
    aim: float = 0.5
    latency: Latency = field(default_factory=Latency)
    replan_in_maneuver: bool = False
    hysteresis: float = 1.0
    learn_level: bool = True
    arrival_probability: float = 0.99
    wait: float = 0.0

    def __post_init__(self) -> None:
        """Raises ValueError for a setting outside its range."""
        if not 0 < self.activation_interval <= LONGEST_INTERVAL:
            raise ValueError(
                f"replan interval must be > 0 and <= {LONGEST_INTERVAL} s, got {self.activation_interval} s"
            )
        if self.max_activations < 1:
            raise ValueError(f"number of replans must be >= 1, got {self.max_activations}")
        if self.final_tolerance is not None and not 0 < self.final_tolerance < inf:
            raise ValueError(f"final_tolerance must be > 0 m, got {self.final_tolerance} m")
        if not 0 <= self.tolerance_share < 1:
            raise ValueError(f"tolerance_share must be in [0, 1), got {self.tolerance_share}")
        if not 0 < self.aim <= 1:
            raise ValueError(f"aim must be in (0, 1], got {self.aim}")
        if not 0 <= self.arrival_probability < 1:
            raise ValueError(f"arrival_probability must be in [0, 1), got {self.arrival_probability}")
        if not 0 <= self.wait <= LONGEST_INTERVAL:
            raise ValueError(f"wait must be >= 0 and <= {LONGEST_INTERVAL} s, got {self.wait} s")
        if not 0 <= self.hysteresis < inf:
            raise ValueError(f"hysteresis must be >= 0 s, got {self.hysteresis} s")
