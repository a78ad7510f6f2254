"""The policies that can be flown, and how they are named on the command line."""

from typing import Literal

FlownPolicy = Literal["nominal", "worst-case"]
FLOWN_POLICIES: tuple[FlownPolicy, ...] = ("nominal", "worst-case")

PlannedPolicy = Literal["nominal", "worst-case", "committed", "price-of-robustness"]
"""What a single mission can be planned with."""
