"""Positions on a table none of which is seated like the others: `flip_error` of the whole record.

A seat that is off by a small angle turns the table's rate into the gyros across its axis, with
opposite signs both ways. What the positions of a record show of that, beyond the twelve parameters
of the unit, is compared with everything else that is left (an F test). One crooked position among
good ones is left to the search of effects, which names its place; here are those records that
still show it without their most crooked position: every seat has then an unknown of its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from surveyapp.diagnosis.result import Adoption, CandidateResult, Diagnosis, NamedCoefficient
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
    columns : ndarray, shape (3 n, k)
        Orthonormal, and orthogonal to the base model; three rows a stop.
    sd : float
        Standard deviation of a seat about either axis across the table's [rad].
    p : float
        Of the F test with all of them.
    parameters, bic, rms, sigma0, loo_rms : float
        Of the base model without seats [rad/s]; ``bic`` of printed units.
    dof : int
    """

    columns: Floats
    sd: float
    p: float
    parameters: int
    bic: float
    rms: float
    sigma0: float
    loo_rms: float
    dof: int

    @property
    def effective(self) -> int:
        """How many combinations of seats the record shows."""
        return int(self.columns.shape[1])


def crooked_seats(observed: Floats, rates: Floats, places: Floats, *, unit: float) -> Seats | None:
    """The seats of a record on a table; None where they need no unknowns of their own.

    Parameters
    ----------
    observed : ndarray, shape (n, 3)
        Outputs of the stops [rad/s].
    rates : ndarray, shape (n, 3)
        Known rate of the body there [rad/s].
    places : ndarray, shape (n,)
        Number of each position, of each round anew.
    unit : float
        One printed unit [rad/s].
    """
    y = observed.ravel()
    known = np.column_stack([np.ones(len(rates)), rates])
    base = _span(np.asarray(np.kron(known, np.eye(3)), dtype=np.float64))
    by_place = {float(p): _seat(rates, places == p) for p in np.unique(places)}
    across = np.hstack(list(by_place.values()))
    across = across - base @ (base.T @ across)
    shown = _span(across)
    left = y.size - base.shape[1] - shown.shape[1]
    if shown.shape[1] < 2 or left < LEAST_LEFT:
        return None
    rest = y - base @ (base.T @ y)
    seats = shown.T @ rest
    noise = float(rest @ rest - seats @ seats)
    p = _f(float(seats @ seats), noise, (shown.shape[1], left))
    if p > ALARM or _beside_the_worst(base, rest, by_place, noise=noise, left=left) > ALARM:
        return None
    variance = (float(seats @ seats) - shown.shape[1] * noise / left) / float(np.sum(across**2))
    dof = y.size - base.shape[1]
    total, count = float(rest @ rest), base.shape[1]
    held = _left_out(y, base)
    return Seats(
        shown,
        math.sqrt(max(variance, 0.0)),
        p,
        count,
        y.size * math.log(total / y.size / unit**2) + count * math.log(y.size),
        math.sqrt(total / y.size),
        math.sqrt(total / dof),
        held,
        dof,
    )


def _beside_the_worst(
    base: Floats, rest: Floats, by_place: Mapping[float, Floats], *, noise: float, left: int
) -> float:
    """P of all seats beside the one position that explains most; ``noise`` is a sum of squares."""
    best = None
    for columns in by_place.values():
        own = _span(columns - base @ (base.T @ columns))
        gained = float(np.sum((own.T @ rest) ** 2))
        if best is None or gained > best[0]:
            best = (gained, own)
    if best is None:
        return 1.0
    every = np.hstack(list(by_place.values()))
    every = every - base @ (base.T @ every)
    more = _span(every - best[1] @ (best[1].T @ every))
    if more.shape[1] == 0:
        return 1.0
    return _f(float(np.sum((more.T @ rest) ** 2)), noise, (more.shape[1], left))


def _seat(rates: Floats, here: Floats) -> Floats:
    """What small turns across the table's axis do in one position, shape (3 n, 2)."""
    own = int(np.argmax(np.abs(rates[here]).sum(axis=0)))
    found = np.zeros((*rates.shape, 2))
    for k in range(2):
        found[:, :, k] = np.cross(np.eye(3)[(own + 1 + k) % 3], rates) * here[:, None]
    return found.reshape(-1, 2)


def _span(columns: Floats) -> Floats:
    """Orthonormal columns that span the same."""
    scale = float(np.abs(columns).max(initial=0.0))
    if scale == 0.0:
        return columns[:, :0]
    size = np.linalg.norm(columns, axis=0)
    u, s, _ = np.linalg.svd(columns / np.where(size > 1e-9 * size.max(), size, np.inf), False)
    return np.asarray(u[:, s > 1e-6 * s[0]])


def _f(explained: float, noise: float, dof: tuple[int, int]) -> float:
    from scipy.special import fdtrc

    if noise <= 0.0:
        return 0.0 if explained > 0.0 else 1.0
    return float(fdtrc(dof[0], dof[1], explained / dof[0] / (noise / dof[1])))


def _left_out(y: Floats, base: Floats) -> float:
    """Rms of the stops, each left out in turn."""
    errors = []
    for first in range(0, y.size, 3):
        kept = np.ones(y.size, dtype=bool)
        kept[first : first + 3] = False
        x = np.linalg.lstsq(base[kept], y[kept], rcond=1e-10)[0]
        errors.append(y[~kept] - base[~kept] @ x)
    return float(np.sqrt(np.mean(np.square(errors))))


def with_seats(found: Diagnosis, seats: Seats) -> Diagnosis:
    """A diagnosis whose base model holds the seats, told as what it is: an effect that it names."""
    error = seats.sd / math.sqrt(2.0 * seats.effective)
    named = NamedCoefficient(SEAT_SD, seats.sd / ARCSEC, error / ARCSEC, "arcsec")
    after = found.after
    before = replace(
        found.before,
        parameters=float(seats.parameters),
        bic=seats.bic,
        rms=seats.rms,
        sigma0=seats.sigma0,
        dof=float(seats.dof),
        loo_rms=seats.loo_rms,
    )
    record = AdoptedEffect(
        id=EFFECT.id,
        coefficients=((named.name, named.value, named.sigma or 0.0, named.unit),),
        grid=(),
        data_sha256=str(found.ledger.get("data_sha256", "")),
        before=before.rms / found.scale,
        after=after.rms / found.scale,
        unit=found.unit,
    )
    gained = before.bic - found.before.bic
    adoption = Adoption(EFFECT.id, EFFECT.title, (named,), (), seats.p, gained, record)
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
