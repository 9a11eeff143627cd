"""Positions on a table none of which is seated like the others: `flip_error` of the whole record.

A seat that is off by a small angle turns the table's rate into the gyros across its axis, with
opposite signs both ways. What the positions of a record show of that, beyond the twelve parameters
of the unit, is compared with everything else that is left (an F test). One crooked position among
good ones is left to the search of effects, which names its place; here are those records that
still show it without their most crooked position: every seat has then an unknown of its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from surveyapp.core.statistics.distributions import f_tail
from surveyapp.diagnosis.result import (
    Adoption,
    CandidateResult,
    Diagnosis,
    ModelResult,
    NamedCoefficient,
)
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.languages import said, term
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.rate.flip_error import EFFECT, SEAT_SD

ALARM: Final = 0.001
"""Of each of the two F tests: small beside the five per cent of the search."""
LEAST_LEFT: Final = 6
"""Degrees of freedom that the noise beside the seats must have."""


@dataclass(frozen=True, slots=True)
class Seats:
    """What the seats of a record do to its stops.

    Parameters
    ----------
    columns : ndarray, shape (n, k)
        Orthonormal, and orthogonal to the base model; a row for each observation.
    sd : float
        Standard deviation of a seat about either axis across the table's [rad].
    p : float
        Of the F test with all of them.
    """

    columns: Floats
    sd: float
    p: float

    @property
    def effective(self) -> int:
        """How many combinations of seats the record shows."""
        return int(self.columns.shape[1])


def crooked_seats(observed: Floats, base: Floats, by_place: Sequence[Floats]) -> Seats | None:
    """The seats of a record on a table; None where they need no unknowns of their own.

    Parameters
    ----------
    observed : ndarray, shape (n,)
        Outputs of the gyros at the stops [rad/s].
    base : ndarray, shape (n, b)
        Design of the base model.
    by_place : sequence of ndarray, shape (n, 2)
        What small turns of each position do [rad/s per rad].
    """
    base = _span(base)
    across = _beside(np.hstack(list(by_place)), base)
    shown = _span(across)
    left = observed.size - base.shape[1] - shown.shape[1]
    if shown.shape[1] < 2 or left < LEAST_LEFT:
        return None
    rest = _beside(observed, base)
    explained = _explained(rest, shown)
    noise = (float(rest @ rest) - explained) / left
    p = _p(explained, shown.shape[1], noise, left)
    worst = max((_span(_beside(own, base)) for own in by_place), key=partial(_explained, rest))
    others = _span(_beside(across, worst))
    if p > ALARM or _p(_explained(rest, others), others.shape[1], noise, left) > ALARM:
        return None
    variance = (explained - shown.shape[1] * noise) / float(np.sum(across**2))
    return Seats(shown, math.sqrt(max(variance, 0.0)), p)


def _span(columns: Floats) -> Floats:
    """Orthonormal columns that span the same."""
    size = np.linalg.norm(columns, axis=0)
    kept = size > 1e-9 * size.max(initial=0.0)
    if not kept.any():
        return columns[:, :0]
    u, s, _ = np.linalg.svd(columns[:, kept] / size[kept], full_matrices=False)
    return np.asarray(u[:, s > 1e-6 * s[0]])


def _beside(values: Floats, span: Floats) -> Floats:
    """What orthonormal columns do not explain."""
    return np.asarray(values - span @ (span.T @ values))


def _explained(rest: Floats, span: Floats) -> float:
    """Sum of squares that orthonormal columns explain."""
    return float(np.sum((span.T @ rest) ** 2))


def _p(explained: float, columns: int, noise: float, left: int) -> float:
    """Of the F test of a sum of squares against a variance of noise."""
    if columns == 0 or noise <= 0.0:
        return 0.0 if explained > 0.0 else 1.0
    return f_tail(explained / columns / noise, dof_numerator=columns, dof_denominator=left)


def with_seats(found: Diagnosis, seats: Seats, before: ModelResult) -> Diagnosis:
    """A diagnosis whose base model holds the seats, told as what it is: an effect that it names.

    ``before`` is the base model without them.
    """
    error = seats.sd / math.sqrt(2.0 * seats.effective)
    named = NamedCoefficient(SEAT_SD, seats.sd / ARCSEC, error / ARCSEC, "arcsec")
    after = found.after
    record = AdoptedEffect(
        id=EFFECT.id,
        coefficients=((named.name, named.value, named.sigma or 0.0, named.unit),),
        grid=(),
        data_sha256=str(found.ledger.get("data_sha256", "")),
        before=before.rms / found.scale,
        after=after.rms / found.scale,
        unit=found.unit,
    )
    title = said("Crooked seats in every position")
    symptom = said("every position stood off in the gyros across its axis")
    adoption = Adoption(EFFECT.id, title, (named,), (), seats.p, None, record, symptom=symptom)
    others = tuple(c for c in found.candidates if c.effect != EFFECT.id)
    verdict = CandidateResult(EFFECT.id, "adopted", seats.p, seats.p, None, "named")
    remedy = said("Seat the unit more exactly, or state the standard deviation of a flip.")
    return replace(
        found,
        verdict="explained" if found.verdict == "adequate" else found.verdict,
        adopted=(adoption, *found.adopted),
        candidates=(verdict, *others),
        before=before,
        after=replace(after, effects=(EFFECT.id, *after.effects)),
        after_best=replace(found.after_best, effects=(EFFECT.id, *found.after_best.effects)),
        remedy=(term(remedy), *found.remedy),
    )
