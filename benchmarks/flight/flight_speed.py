"""Flight speed against its limit and a peer: `python -m benchmarks.flight.flight_speed`.

The complete loop (turbulence, sensors, filter, controller, vehicle, log in memory) interpreted and compiled;
the limit, which is MuJoCo's `mj_step` of the same model at the same step with nothing around it; RotorPy's
own loop, from the package index, in an environment of its own; and many flights in several processes. Speeds
are simulated seconds a CPU second of one core, the best of several rounds in turn, so that all see the same
machine; those in processes are by the clock, and vary with other load. The settling before a flight counts as
flown here; `a period` is the loop alone.
"""

from dataclasses import dataclass
from functools import partial
from time import perf_counter, process_time

import mujoco

import models
from experiments.campaign.fly_campaign import campaign_library
from flight.automaton.library import Library
from flight.mission.sequence import Sequence
from flight.se2 import SE2
from runtime.executor import default_workers, worker_pool
from scenarios.find import find_campaign
from sim.campaign_flight import fly_sequence
from sim.loop.backend import Backend, best_backend
from sim.loop.specification import CONTROL_PERIOD, specify_sequence
from sim.simulated_helicopter import SimulatedHelicopter

from .peer import NoPeerError, peer_speed

WALK = (1, 2, 5, 7, 3, 6, 4, 2, 1)
COAST = 8.0
ROUNDS = 7
STEPS = 20_000
PROCESSES = (1, 2, 4)
FLIGHTS = 8
LIMITS = {Backend.INTERPRETED: 200.0, Backend.COMPILED: 400.0}


@dataclass
class Speeds:
    """Best speeds: simulated seconds per CPU second, CPU seconds per control period."""

    flight: float = 0.0
    period: float = 1.0


def main() -> None:
    """Prints speeds and their ratios."""
    library = campaign_library(find_campaign("gtmax"), "gtmax")
    backends = [Backend.INTERPRETED]
    if best_backend() is Backend.COMPILED:
        backends.append(Backend.COMPILED)
    else:
        print("no working C compiler: interpreted only")
    speeds, bare = {backend: Speeds() for backend in backends}, 0.0
    for backend in backends:
        fly(library, backend, 0)
    for number in range(ROUNDS):
        bare = max(bare, bare_step())
        for backend in backends:
            measure(library, backend, number, speeds[backend])
    print(f"{'':32} x real time   of the limit   a period")
    row("bare mj_step, the limit", bare, 1.0, 1e6 * CONTROL_PERIOD / bare)
    for backend, found in speeds.items():
        bar = f"   limit {LIMITS[backend]:.0f}"
        row(f"complete loop, {backend}", found.flight, found.flight / bare, 1e6 * found.period, bar)
    best = speeds[backends[-1]].flight
    try:
        peer = peer_speed()
        row("RotorPy's loop, without wind", peer, peer / bare, 1e6 * CONTROL_PERIOD / peer)
        ratios = ", ".join(f"{backend} {found.flight / peer:.0f}" for backend, found in speeds.items())
        print(f"complete loop over RotorPy's: {ratios}")
    except NoPeerError as error:
        print(error)
    print(f"\n{FLIGHTS} flights, {backends[-1]}, by the clock, on {default_workers()} processors")
    alone = 0.0
    for processes in PROCESSES:
        speed = parallel_speed(library, backends[-1], processes)
        alone = alone or speed
        share = f"{speed / alone:5.2f} x one   {speed / best:5.2f} x a core's CPU second"
        print(f"{processes} processes {speed:8.0f} x real time   {share}")


def row(name: str, speed: float, share: float, period: float, more: str = "") -> None:
    """Prints one line; the period in microseconds."""
    print(f"{name:32} {speed:11.0f} {share:14.3f} {period:8.1f} us{more}")


def measure(library: Library, backend: Backend, seed: int, best: Speeds) -> None:
    """Flies once and records improvements."""
    began = process_time()
    flown, loop = fly(library, backend, seed)
    best.flight = max(best.flight, flown / (process_time() - began))
    best.period = min(best.period, loop)


def fly(library: Library, backend: Backend, seed: int) -> tuple[float, float]:
    """Flies a walk through all trims, with its log in memory.

    Returns:
        Seconds simulated, the settling included, and CPU seconds a control period without it.
    """
    sequence = Sequence("speed", SE2.identity(), WALK, (COAST,) * len(WALK), "gtmax")
    specification = specify_sequence(sequence, seed=seed)
    helicopter = SimulatedHelicopter(specification, library, backend=backend)
    began = process_time()
    fly_sequence(helicopter, sequence, library=library)
    loop = process_time() - began
    flown = helicopter.log().duration
    return flown + specification.settling_time, loop * CONTROL_PERIOD / flown


def bare_step() -> float:
    """Returns seconds simulated a CPU second by `mj_step` on the vehicle's model."""
    model = mujoco.MjModel.from_xml_path(str(models.FOLDER / "gtmax.xml"))
    data = mujoco.MjData(model)
    data.qpos[2] = 1e5  # stays above the ground
    began = process_time()
    mujoco.mj_step(model, data, nstep=STEPS)
    return float(STEPS * model.opt.timestep / (process_time() - began))


def parallel_speed(library: Library, backend: Backend, processes: int) -> float:
    """Returns simulated seconds per clock second of several started processes."""
    with worker_pool(processes) as pool:
        task = partial(fly, library, backend)
        list(pool.map(task, range(4 * processes)))
        began = perf_counter()
        flown = [seconds for seconds, _ in pool.map(task, range(FLIGHTS))]
        return sum(flown) / (perf_counter() - began)


if __name__ == "__main__":
    main()
