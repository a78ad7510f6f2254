"""The policies that can be flown, and how they are named on the command line."""

from typing import Literal, get_args

FlownPolicy = Literal["nominal", "worst-case", "calibrated", "committed"]
"""What can be flown; `calibrated` is the worst case at a level that follows the turbulence."""

FLOWN_POLICIES: tuple[FlownPolicy, ...] = get_args(FlownPolicy)

COMPARED: tuple[FlownPolicy, ...] = ("nominal", "worst-case")
"""What is flown side by side where nothing else is asked."""

PlannedPolicy = Literal["nominal", "worst-case", "committed", "price-of-robustness"]
"""What a single mission can be planned with."""
