"""RotorPy's own loop at 100 Hz on a circle, in still air.

Run by the Python of RotorPy's environment; independent of this project. Prints simulated seconds per CPU
second.
"""

from time import process_time

import numpy as np
from rotorpy.controllers.quadrotor_control import SE3Control
from rotorpy.environments import Environment
from rotorpy.trajectories.circular_traj import ThreeDCircularTraj
from rotorpy.vehicles.hummingbird_params import quad_params
from rotorpy.vehicles.multirotor import Multirotor

SECONDS, ROUNDS = 5.0, 3


def main() -> None:
    """Prints the best of some rounds."""
    trajectory = ThreeDCircularTraj(radius=np.array([2.0, 2.0, 0.0]), freq=np.array([0.1, 0.1, 0.0]))
    loop = Environment(Multirotor(quad_params), SE3Control(quad_params), trajectory, sim_rate=100)
    best = 0.0
    for _ in range(ROUNDS):
        began = process_time()
        flown = loop.run(t_final=SECONDS, plot=False, verbose=False)
        best = max(best, flown["time"][-1] / (process_time() - began))
    print(best)


if __name__ == "__main__":
    main()
