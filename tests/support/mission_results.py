"""Results of missions, as made up as a test needs them."""

from experiments.mission.result import MissionResult


def result(mission: str, number: int, *, flown: float = 10.0, reached: bool = True) -> MissionResult:
    """Returns the result of a mission's flight: predicted to take 10 s, reached or lost."""
    return MissionResult(
        mission=mission,
        policy="worst-case",
        gamma=1.0,
        plant="helicopter",
        wind="gtmax",
        seed=number,
        reached=reached,
        claimed=reached,
        flown_time=flown,
        planned_time=9.5,
        predicted_time=10.0,
        closest=0.5 if reached else 3.0,
        replans=20,
        failures=0,
        safe_stops=0,
        reason="reached the goal" if reached else "lost",
        log=None,
        planning_times=(0.001, 0.002),
    )
