"""Flow of trims along many walks at once, as arrays.

Vectorised form of `kinematics.WalkMotion.end`. Positions are complex numbers (north + i east) from a start at
the origin that heads north. The heading changes of maneuvers are folded into the velocities and displacements
after them, so that headings come from coasting alone. The last axis is that of the trims; shorter walks are
padded with trims at rest. `planner.check` keeps a flow of its own, because it shares no code with the search.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float


@dataclass(frozen=True, slots=True, eq=False)
class WalkFlow:
    """Headings, positions and end velocities along walks.

    Attributes:
        facing: exp(i heading) before each coast.
        mean: of exp(i angle) over each coast, the angle counted from its beginning.
        exit: position after each coast, metres.
        heading: after each coast, radians.
        velocity: of the end along each coasting time, metres per second.
    """

    facing: Complex[np.ndarray, "*walks trims"]
    mean: Complex[np.ndarray, "*walks trims"]
    exit: Complex[np.ndarray, "*walks trims"]
    heading: Float[np.ndarray, "*walks trims"]
    velocity: Complex[np.ndarray, "*walks trims"]

    @property
    def end(self) -> Complex[np.ndarray, "*walks"]:
        """Position after the walk, metres."""
        end: Complex[np.ndarray, "*walks"] = self.exit[..., -1]
        return end


def fly_walks(
    velocity: Complex[np.ndarray, "*#walks trims"],
    rate: Float[np.ndarray, "*#walks trims"],
    displacement: Complex[np.ndarray, "*#walks trims"],
    times: Float[np.ndarray, "*#walks trims"],
) -> WalkFlow:
    """Returns the flow along walks (thesis, eq. 8, 17-18).

    Coasting longer in a trim carries the rest of the walk along, and turns it about the end of the coast.
    Arrays are broadcast.

    Args:
        velocity: folded, metres per second.
        rate: yaw rates, radians per second.
        displacement: of the maneuver before each trim, folded, metres; 0 for the first.
        times: seconds.
    """
    swept = rate * times
    half = 0.5 * swept
    turn, shorter = np.exp(1j * half), np.sinc(half / np.pi)
    heading = np.cumsum(swept, axis=-1)
    facing = np.exp(1j * (heading - swept))
    exit_ = np.cumsum(facing * (displacement + velocity * times * shorter * turn), axis=-1)
    along = facing * turn * turn * velocity + 1j * rate * (exit_[..., -1:] - exit_)
    return WalkFlow(facing, shorter * turn, exit_, heading, along)


def mean_direction(angle: np.ndarray) -> np.ndarray:
    """Returns the integral of `exp(i angle s)` over [0, 1]."""
    half = 0.5 * angle
    mean: np.ndarray = np.sinc(half / np.pi) * np.exp(1j * half)
    return mean


def fold_turns(
    velocity: Complex[np.ndarray, "*walks trims"],
    displacement: Complex[np.ndarray, "*walks trims"],
    turn: Float[np.ndarray, "*walks trims"],
) -> tuple[
    Complex[np.ndarray, "*walks trims"],
    Complex[np.ndarray, "*walks trims"],
    Float[np.ndarray, "*walks trims"],
]:
    """Returns velocities and displacements turned by earlier maneuvers, and these turns.

    Args:
        velocity: in the body frame, forward + i side, metres per second.
        displacement: of the maneuver before each trim, in the body frame at entry, metres; 0 for the first.
        turn: heading change of that maneuver, radians; 0 for the first.
    """
    turned = np.cumsum(turn, axis=-1)
    return velocity * np.exp(1j * turned), displacement * np.exp(1j * (turned - turn)), turned
