"""Joint law of a maneuver: values, path, dependence on the entry."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.automaton.joint_law import (
    PATH_INSTANTS,
    EntryDependence,
    ManeuverLaw,
    PathInstant,
    PreviousShift,
    Row3,
    Row4,
)
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from identification.segmentation.flight_evidence import FlightEvidence
from identification.segmentation.segmentation import ManeuverSegment

from .coverage import joint_coverage
from .digits import matrix4, rounded_down, rounded_up, row3, row4
from .entry_model import Entries, EntryFit, EntryTerms, fit_entries, held_out_errors
from .samples import MANEUVER_SCALARS, maneuver_row, performances_of


@dataclass(frozen=True, slots=True, eq=False)
class Performances:
    """Settled performances of one maneuver in all flights.

    Attributes:
        entries: values and entries.
        paths: displacements at even shares of the duration.
    """

    entries: Entries
    paths: Float[np.ndarray, "n instants 3"]


def performances(maneuver: Maneuver, flights: Sequence[FlightEvidence], library: Library) -> Performances:
    """Returns the settled performances of a maneuver, in the flights' order."""
    rows = [
        (place, segment)
        for place, flight in enumerate(flights)
        for segment in performances_of(flight, maneuver.id)
        if segment.settled
    ]
    velocity = library.trim(maneuver.from_trim).velocity
    segments = [segment for _, segment in rows]
    entries = Entries(
        flight=np.array([place for place, _ in rows], dtype=np.int64),
        values=np.array([maneuver_row(one) for one in segments]).reshape(-1, len(MANEUVER_SCALARS)),
        previous=np.array([one.previous or 0 for one in segments], dtype=np.int64),
        coast=np.array([one.coast for one in segments]),
        offset=np.array([_offset(one) for one in segments]).reshape(-1, 3)
        - (velocity.forward, velocity.side, velocity.yaw_rate),
    )
    return Performances(entries, np.array([one.path for one in segments]).reshape(-1, PATH_INSTANTS, 3))


def _offset(segment: ManeuverSegment) -> tuple[float, float, float]:
    return segment.believed.forward, segment.believed.side, segment.believed.yaw_rate


def identify_maneuver_law(
    known: Performances, chosen: Sequence[int], entry: EntryDependence | None
) -> ManeuverLaw | None:
    """Returns the joint law of a maneuver; None without two performances.

    Args:
        known: performances in all flights.
        chosen: places of the flights whose deviations are kept.
        entry: dependence on the entry.
    """
    values = known.entries.values
    if len(values) < 2:
        return None
    mean = values.mean(axis=0)
    return ManeuverLaw(
        mean=row4(mean),
        covariance=_covariance(values - mean),
        deviations=_chosen_rows(known.entries, values - mean, chosen),
        path=tuple(
            PathInstant(row3(centre), row3(spread))
            for centre, spread in zip(known.paths.mean(axis=0), known.paths.std(axis=0, ddof=1), strict=True)
        ),
        entry=entry,
    )


def identify_entry(
    known: Performances,
    nominal: Performances,
    bounding: Performances,
    *,
    terms: EntryTerms,
    chosen: Sequence[int],
    discarded: int,
    confidence: float,
) -> EntryDependence | None:
    """Returns a maneuver's dependence on its entry, with bounds about it.

    It is fitted to the nominal flights, so that the bounds of the others about it have the coverage of bounds
    about a fixed centre. Without nominal flights it is fitted to all, deviations are held-out ones, and no
    coverage is claimed.

    Args:
        known: performances in all flights.
        nominal: performances in the flights for the values.
        bounding: performances in the flights for the bounds.
        terms: terms of the model.
        chosen: places of the flights whose deviations are kept.
        discarded: samples outside the bounds.
        confidence: confidence of the coverage.
    """
    if not (terms.shifts or terms.velocity):
        return None
    apart = len(nominal.entries.values) > 1
    fit = _rounded_fit(fit_entries((nominal if apart else known).entries, terms))
    if apart:
        errors = known.entries.values - fit.means(known.entries)
        off = np.abs(bounding.entries.values - fit.means(bounding.entries))
        count = len(set(bounding.entries.flight.tolist())) + discarded
        coverage = joint_coverage(
            count, support=len(MANEUVER_SCALARS), confidence=confidence, discarded=discarded
        )
    else:
        errors = held_out_errors(known.entries, terms)
        off, coverage = np.abs(errors), 0.0
    shifts = zip(fit.previous, fit.shifts, strict=True)
    return EntryDependence(
        base=row4(fit.base),
        previous=tuple(PreviousShift(number, row4(row)) for number, row in shifts),
        fade_time=fit.fade_time,
        velocity=_matrix4x3(fit.velocity),
        covariance=_covariance(errors),
        deviations=_chosen_rows(known.entries, errors, chosen),
        bounds=row4(map(rounded_up, off.max(axis=0).tolist())),
        coverage=rounded_down(coverage),
    )


def _rounded_fit(fit: EntryFit) -> EntryFit:
    """Returns the fit in the digits of files, for bounds about it."""
    return EntryFit(
        base=np.array(row4(fit.base)),
        previous=fit.previous,
        shifts=np.array([row4(row) for row in fit.shifts]).reshape(-1, len(MANEUVER_SCALARS)),
        velocity=np.array(_matrix4x3(fit.velocity)),
        fade_time=fit.fade_time,
    )


def _matrix4x3(rows: Float[np.ndarray, "4 3"]) -> tuple[Row3, Row3, Row3, Row3]:
    first, second, third, fourth = map(row3, rows)
    return first, second, third, fourth


def _covariance(errors: Float[np.ndarray, "n 4"]) -> tuple[Row4, Row4, Row4, Row4]:
    return matrix4(np.cov(errors.T))


def _chosen_rows(
    entries: Entries, errors: Float[np.ndarray, "n 4"], chosen: Sequence[int]
) -> tuple[Row4, ...]:
    """Returns the first error of each chosen flight, or the next."""
    flights = entries.flight
    places = [int(np.searchsorted(flights, place)) % len(flights) for place in chosen]
    return tuple(row4(errors[place]) for place in places)
