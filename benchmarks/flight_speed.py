"""How fast the whole flight loop is, against the bare physics step: `python -m benchmarks.flight_speed`.

CPU seconds of one core. The limit is `mj_step` of the same model with nothing around it.
"""

from time import process_time

import mujoco

import models
from flight.library import Library
from flight.se2 import SE2
from flight.sequence import Sequence
from maneuver.campaign_flights import campaign_library
from maneuver.files import find_campaign
from sim.campaign import fly_specification
from sim.specification import specify_sequence

WALK = (1, 2, 5, 7, 3, 6, 4, 2, 1)
COAST = 8.0
BARE_STEPS = 100_000


def main() -> None:
    """Prints both rates and their ratio."""
    library = campaign_library(find_campaign("gtmax"), "gtmax")
    flown, spent = whole_loop(library)
    bare = bare_step()
    print(f"whole loop   {flown / spent:8.0f} x real time   ({flown:.0f} s flown in {spent:.2f} CPU s)")
    print(f"bare mj_step {bare:8.0f} x real time")
    print(f"ratio        {bare * spent / flown:8.1f}")


def bare_step() -> float:
    """Returns seconds simulated a CPU second by `mj_step` on the vehicle's model."""
    model = mujoco.MjModel.from_xml_path(str(models.FOLDER / "gtmax.xml"))
    data = mujoco.MjData(model)
    data.qpos[2] = 1e5  # stays above the ground
    began = process_time()
    mujoco.mj_step(model, data, nstep=BARE_STEPS)
    spent = process_time() - began
    return float(BARE_STEPS * model.opt.timestep / spent)


def whole_loop(library: Library) -> tuple[float, float]:
    """Returns seconds flown and CPU seconds spent, the log in memory included."""
    sequence = Sequence("speed", SE2.identity(), WALK, (COAST,) * len(WALK), "gtmax")
    fly_specification(specify_sequence(sequence, seed=1), library)
    began = process_time()
    log = fly_specification(specify_sequence(sequence, seed=2), library)
    return log.duration, process_time() - began


if __name__ == "__main__":
    main()
