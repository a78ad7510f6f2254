"""Statement of the air for logs, libraries and data sheets."""

from .dryden import dryden
from .wind_class import wind_class

STILL_AIR = "still air"


def state_wind(name: str, *, height: float) -> str:
    """Returns mean wind, standard deviations and intensities at a height."""
    wind = wind_class(name)
    if not wind.wind_at_20_ft:
        return STILL_AIR
    mean, gusts = wind.mean_wind(height), dryden(wind.wind_at_20_ft, height=height, span=1.0)
    return (
        f"wind at 20 ft {wind.wind_at_20_ft:.2f} m/s, at {height:g} m mean {mean:.2f} m/s, "
        f"gusts {gusts.sigma_horizontal:.2f} m/s ({gusts.sigma_horizontal / mean:.1%}) horizontal, "
        f"{gusts.sigma_vertical:.2f} m/s ({gusts.sigma_vertical / mean:.1%}) vertical"
    )
