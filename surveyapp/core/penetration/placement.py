"""Where the next gyro sides go: what each placement leaves of the lateral error.

A further row changes the normal equations by rank one, so a placement S costs the solution of
equations of its own size:

    y = (G_SS + R_S)^-1 c_S,   v(S) = v - c_S' y,   M_k(S) = M_k + T_kS y

with G = C N^-1 C', c = C N^-1 h for all candidate rows C, R their variances, and M_k what a shared
cause moves the miss by. v(S) alone would do if every cause were in the weights; shared constants,
refraction, deflection and repeated surveys are not, so every placement is judged by the whole
lateral variance.

Source: penetration.md section 2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.penetration.covariance import (
    contributions,
    estimator,
    field_covariance,
    total,
)
from surveyapp.core.penetration.mine import Mine
from surveyapp.core.penetration.rows import (
    LEAST_SIGMA,
    Row,
    RowKind,
    refraction_per_gradient,
    side_centring_sigma,
)
from surveyapp_models.arrays import Floats
from surveyapp_models.sight_refraction import curvature_per_gradient

Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Candidate:
    """A side that may be observed.

    Parameters
    ----------
    heading, side : int
    instrument : str
    sigma : float
        One determination [rad].
    """

    heading: int
    side: int
    instrument: str
    sigma: float


@dataclass(frozen=True, slots=True)
class Outlook:
    """All candidates against what is observed so far.

    Parameters
    ----------
    cofactor : ndarray, shape (n, n)
        G.
    pull : ndarray, shape (n,)
        c.
    noise : ndarray, shape (n,)
        R [rad^2].
    variance : float
        v of the adjustment's own random part [m^2].
    moved : ndarray, shape (k,)
        M_k.
    change : ndarray, shape (k, n)
        T.
    factor : ndarray, shape (k,)
        How often the square of each M_k counts.
    surveys : int
    rest : float
        Lateral variance that no gyro side changes [m^2].
    """

    cofactor: Floats
    pull: Floats
    noise: Floats
    variance: float
    moved: Floats
    change: Floats
    factor: Floats
    surveys: int
    rest: float

    @property
    def lateral(self) -> float:
        """Lateral 1 sigma as observed so far [m]."""
        own = self.variance / self.surveys + float(self.factor @ self.moved**2) + self.rest
        return math.sqrt(max(own, 0.0))

    def each(self) -> Floats:
        """Lateral 1 sigma with one candidate added, for every one [m]."""
        y = self.pull / (np.diag(self.cofactor) + self.noise)
        own = (self.variance - self.pull * y) / self.surveys + self.rest
        shared = self.factor @ (self.moved[:, None] + self.change * y) ** 2
        return np.sqrt(np.maximum(own + shared, 0.0))

    def batch(self, sets: Ints) -> Floats:
        """Lateral 1 sigma for every set of candidates, sets of shape (m, k) [m]."""
        matrix = self.cofactor[sets[:, :, None], sets[:, None, :]]
        size = sets.shape[1]
        matrix[:, np.arange(size), np.arange(size)] += self.noise[sets]
        pull = self.pull[sets]
        y = np.linalg.solve(matrix, pull[:, :, None])[:, :, 0]
        found = (self.variance - np.einsum("mk,mk->m", pull, y)) / self.surveys + self.rest
        for moved, change, factor in zip(self.moved, self.change, self.factor, strict=True):
            found += factor * (moved + np.einsum("mk,mk->m", change[sets], y)) ** 2
        return np.asarray(np.sqrt(np.maximum(found, 0.0)), dtype=np.float64)

    def with_row(self, candidate: int, *, removed: bool = False) -> Outlook:
        """The outlook after one candidate is observed, or no longer."""
        noise = float(self.noise[candidate])
        column = self.cofactor[:, candidate]
        pivot = float(column[candidate]) + (-noise if removed else noise)
        y = float(self.pull[candidate]) / pivot
        return replace(
            self,
            cofactor=self.cofactor - np.outer(column, column / pivot),
            pull=self.pull - column * y,
            variance=self.variance - float(self.pull[candidate]) * y,
            moved=self.moved + self.change[:, candidate] * y,
            change=self.change - np.outer(self.change[:, candidate], column / pivot),
        )


def planned_row(mine: Mine, candidate: Candidate) -> Row:
    """The row that a candidate would add: from the first station of its side to the second."""
    route = mine.routes[candidate.heading]
    sigmas = mine.plan.sigmas
    centring = side_centring_sigma(
        route,
        candidate.side,
        instrument_m=sigmas.centring_instrument_m or 0.0,
        target_m=sigmas.centring_target_m or 0.0,
    )
    return Row(RowKind.GYRO, candidate.side, candidate.sigma, centring, True, candidate.instrument)


def outlook(mine: Mine, candidates: Sequence[Candidate]) -> Outlook:
    """Prepare all candidates of a mine.

    Parameters
    ----------
    mine : Mine
        Its gyros hold every instrument of the candidates.
    candidates : sequence of Candidate
    """
    solved = estimator(mine)
    rows = [planned_row(mine, candidate) for candidate in candidates]
    place = {
        name: mine.arrays.size - len(mine.instruments) + i
        for i, name in enumerate(mine.instruments)
    }
    n = len(rows)
    design = np.zeros((mine.arrays.size, n))
    for j, (candidate, row) in enumerate(zip(candidates, rows, strict=True)):
        design[mine.first_side[candidate.heading] + row.side, j] = 1.0
        design[place[row.instrument], j] = 1.0
    spread = np.asarray(np.linalg.solve(solved.normal, design), dtype=np.float64)
    weighted = mine.arrays.weight[:, None] * mine.arrays.apply(spread)
    observed, planned, factor = _shared(mine, candidates, rows)
    gain = solved.gain[:, 0]
    noise = np.array([max(math.hypot(r.reading, r.centring), LEAST_SIGMA) ** 2 for r in rows])
    found = Outlook(
        cofactor=design.T @ spread,
        pull=design.T @ solved.movement[:, 0],
        noise=noise,
        variance=float(mine.levers()[:, 0] @ solved.movement[:, 0]),
        moved=observed @ gain,
        change=planned - observed @ weighted,
        factor=factor,
        surveys=mine.plan.independent_surveys,
        rest=0.0,
    )
    whole = float(total(contributions(mine, solved))[0][0, 0])
    return replace(found, rest=whole - found.lateral**2 if found.variance > 0.0 else whole)


def _shared(
    mine: Mine, candidates: Sequence[Candidate], rows: Sequence[Row]
) -> tuple[Floats, Floats, Floats]:
    """Columns of the shared causes on observed and planned rows, and how often each counts."""
    arrays, surveys = mine.arrays, mine.plan.independent_surveys
    n = len(rows)
    columns: list[tuple[Floats, Floats, float]] = []
    for i, (name, sigma) in enumerate(zip(mine.instruments, mine.constant_sigma, strict=True)):
        planned = np.array([float(sigma) if row.instrument == name else 0.0 for row in rows])
        observed = np.where(arrays.instrument == i, float(sigma), 0.0)
        columns.append((observed, planned, 1.0 - 1.0 / surveys))
    columns += _start_columns(mine, n)
    columns += _wall_columns(mine, candidates, rows)
    observed = np.array([c[0] for c in columns]).reshape(-1, arrays.reading.size)
    planned = np.array([c[1] for c in columns]).reshape(-1, n)
    factor = np.array([c[2] for c in columns])
    if mine.plan.deflection is not None:
        own, new = _deflection_columns(mine, candidates)
        observed, planned = np.vstack([observed, own]), np.vstack([planned, new])
        factor = np.concatenate([factor, np.ones(len(own))])
    return observed, planned, factor


def _start_columns(mine: Mine, n: int) -> list[tuple[Floats, Floats, float]]:
    """Start azimuths: in the weights one by one, in truth group by group."""
    arrays = mine.arrays
    start = arrays.kind == RowKind.AZIMUTH
    columns = []
    for row in np.flatnonzero(start):
        alone = np.zeros(arrays.reading.size)
        alone[row] = arrays.reading[row]
        columns.append((alone, np.zeros(n), -1.0 / mine.plan.independent_surveys))
    groups: dict[str, list[int]] = {}
    for number, heading in enumerate(mine.plan.headings):
        groups.setdefault(heading.start.group or f"\0{number}", []).append(number)
    for numbers in groups.values():
        of_group = start & np.isin(arrays.heading, numbers)
        columns.append((np.where(of_group, arrays.reading, 0.0), np.zeros(n), 1.0))
    return columns


def _wall_columns(
    mine: Mine, candidates: Sequence[Candidate], rows: Sequence[Row]
) -> list[tuple[Floats, Floats, float]]:
    refraction = mine.plan.refraction
    if refraction is None:
        return []
    curvature = curvature_per_gradient(
        pressure_hpa=refraction.pressure_hpa, temperature_c=refraction.temperature_c
    )
    planned = refraction.gradient_sigma * np.array(
        [
            refraction_per_gradient(mine.routes[candidate.heading], row, curvature)
            for candidate, row in zip(candidates, rows, strict=True)
        ]
    )
    observed = refraction.gradient_sigma * mine.arrays.refraction
    if refraction.shared == "all":
        return [(observed, planned, 1.0)]
    of_heading = np.array([candidate.heading for candidate in candidates])
    return [
        (
            np.where(mine.arrays.heading == number, observed, 0.0),
            np.where(of_heading == number, planned, 0.0),
            1.0,
        )
        for number in range(len(mine.headings))
    ]


def _deflection_columns(mine: Mine, candidates: Sequence[Candidate]) -> tuple[Floats, Floats]:
    """Independent columns of the field of deflections on observed and planned gyro rows."""
    arrays = mine.arrays
    gyro = np.flatnonzero(arrays.kind == RowKind.GYRO)
    base = np.concatenate(([0], np.cumsum([route.sides + 1 for route in mine.routes])))
    new = np.array([base[c.heading] + c.side for c in candidates], dtype=np.int64)
    every = np.concatenate([arrays.station[gyro], new])
    stations, index = np.unique(every, return_inverse=True)
    e = np.concatenate([route.e for route in mine.routes])[stations]
    n = np.concatenate([route.n for route in mine.routes])[stations]
    values, vectors = np.linalg.eigh(field_covariance(mine, e, n))
    root = (vectors * np.sqrt(np.maximum(values, 0.0))).T[:, index]
    observed = np.zeros((len(root), arrays.reading.size))
    observed[:, gyro] = root[:, : gyro.size]
    return observed, root[:, gyro.size :]
