"""Dependence of a maneuver's values on its entry, by ridge regression.

A value is modelled as base + shift of the previous maneuver exp(-coast / fade time) + a linear term in the
believed entry velocity less the trim's command. Coefficients are shrunk towards 0 (ridge, in standard
deviations of values and entry velocities), so that a rare previous maneuver shifts little. Terms, fade time
and shrinkage are one for all maneuvers, chosen by squared errors in flights held out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Float, Int

FOLDS = 5
FADE_TIMES = (0.5, 1.0, 2.0)
"""Seconds, tried in turn."""

PENALTIES = (1.0, 4.0, 16.0)
"""Ridge penalties, in observations; tried in turn."""


@dataclass(frozen=True, slots=True, eq=False)
class Entries:
    """Performances of one maneuver with their entries, a row each.

    Attributes:
        flight: place of the flight.
        values: duration, forward, side, heading change.
        previous: id of the maneuver before; 0 where there was none.
        coast: seconds since its end.
        offset: believed entry velocity less the trim's command.
    """

    flight: Int[np.ndarray, "n"]
    values: Float[np.ndarray, "n 4"]
    previous: Int[np.ndarray, "n"]
    coast: Float[np.ndarray, "n"]
    offset: Float[np.ndarray, "n 3"]

    def where(self, rows: np.ndarray) -> "Entries":
        """Returns the chosen rows."""
        parts = (self.flight, self.values, self.previous, self.coast, self.offset)
        return Entries(*(part[rows] for part in parts))


@dataclass(frozen=True, slots=True)
class EntryTerms:
    """Terms of the model, its fade time and its shrinkage."""

    shifts: bool
    velocity: bool
    fade_time: float = 1.0
    penalty: float = 4.0


NO_TERMS = EntryTerms(shifts=False, velocity=False)


@dataclass(frozen=True, slots=True, eq=False)
class EntryFit:
    """Fitted dependence of one maneuver's values.

    Attributes:
        base: values without shift and offset.
        previous: ids of the maneuvers that shift, ascending.
        shifts: a row for each of them.
        velocity: what each value gains per unit of offset.
        fade_time: seconds.
    """

    base: Float[np.ndarray, "4"]
    previous: tuple[int, ...]
    shifts: Float[np.ndarray, "previous 4"]
    velocity: Float[np.ndarray, "4 3"]
    fade_time: float

    def means(self, entries: Entries) -> Float[np.ndarray, "n 4"]:
        """Returns the mean values at given entries."""
        faded = _faded(entries, self.previous, self.fade_time)
        means: Float[np.ndarray, "n 4"] = self.base + faded @ self.shifts + entries.offset @ self.velocity.T
        return means


def fit_entries(entries: Entries, terms: EntryTerms) -> EntryFit:
    """Returns the fitted dependence, shrunk towards a constant."""
    previous = tuple(sorted({int(one) for one in entries.previous} - {0})) if terms.shifts else ()
    faded = _faded(entries, previous, terms.fade_time)
    spread = entries.offset.std(axis=0)
    # A component without scatter tells nothing.
    scale = np.where(spread > 1e-9, spread, np.inf)
    columns = [faded, entries.offset / scale] if terms.velocity else [faded]
    design = np.concatenate(columns, axis=1)
    centre, mean = design.mean(axis=0), entries.values.mean(axis=0)
    moved = design - centre
    matrix = moved.T @ moved + terms.penalty * np.eye(design.shape[1])
    found = np.linalg.solve(matrix, moved.T @ (entries.values - mean))
    velocity = (found[len(previous) :] / scale[:, None]).T if terms.velocity else np.zeros((4, 3))
    return EntryFit(mean - centre @ found, previous, found[: len(previous)], velocity, terms.fade_time)


def held_out_errors(entries: Entries, terms: EntryTerms) -> Float[np.ndarray, "n 4"]:
    """Returns values less means that flights of other folds give."""
    errors = np.empty_like(entries.values)
    for fold in range(FOLDS):
        out = entries.flight % FOLDS == fold
        if not out.any():
            continue
        rest = entries.where(~out)
        learnt = fit_entries(rest if len(rest.values) else entries, terms)
        errors[out] = entries.values[out] - learnt.means(entries.where(out))
    return errors


def choose_terms(maneuvers: Sequence[Entries]) -> EntryTerms:
    """Returns the simplest terms whose held-out score is near the best.

    The score is the mean square of held-out errors in standard deviations of the values. Terms are near where
    they are worse by at most a standard error of the difference, flights being the sample.
    """
    known = [one for one in maneuvers if len(set(one.flight.tolist())) >= 2 * FOLDS]
    if not known:
        return NO_TERMS
    options = [NO_TERMS]
    options += [EntryTerms(shifts=False, velocity=True, penalty=penalty) for penalty in PENALTIES]
    for velocity in (False, True):
        options += [EntryTerms(True, velocity, *pair) for pair in product(FADE_TIMES, PENALTIES)]
    scores = np.array([_score_by_flight(known, terms) for terms in options])
    best = int(scores.mean(axis=1).argmin())
    kinds = [(terms.shifts, terms.velocity) for terms in options]
    for kind in dict.fromkeys(kinds):
        places = [place for place, other in enumerate(kinds) if other == kind]
        place = min(places, key=lambda place: float(scores[place].mean()))
        worse = scores[place] - scores[best]
        if worse.mean() <= worse.std() / np.sqrt(len(worse)):
            return options[place]
    return options[best]


def _score_by_flight(maneuvers: Sequence[Entries], terms: EntryTerms) -> Float[np.ndarray, "flights"]:
    """Returns each flight's mean score over maneuvers and values."""
    flights = np.concatenate([one.flight for one in maneuvers])
    squares = []
    for one in maneuvers:
        spread = one.values.std(axis=0)
        scaled = held_out_errors(one, terms) / np.where(spread > 0, spread, 1.0)
        squares.append((scaled**2).mean(axis=1))
    totals = np.bincount(flights, weights=np.concatenate(squares))
    counts = np.bincount(flights)
    scores: Float[np.ndarray, "flights"] = totals[counts > 0] / counts[counts > 0]
    return scores


def _faded(entries: Entries, previous: tuple[int, ...], fade_time: float) -> Float[np.ndarray, "n previous"]:
    share = np.exp(-entries.coast / fade_time)
    follows = entries.previous[:, None] == np.array(previous, dtype=np.int64)
    return np.asarray(follows * share[:, None])
