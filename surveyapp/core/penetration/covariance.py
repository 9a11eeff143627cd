"""Covariance of the miss at the meeting point, cause by cause.

The estimator is what an adjustment does: weights from the independent parts (reading and
centring), every gyro constant an unknown with its prior; refraction and deflection are not in the
weights. A cause has one column per thing that is common; its contribution is the sum of the
squares of what each column moves the miss by, and the causes add.

Source: penetration.md section 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surveyapp.core.penetration.mine import MM, PPM, Mine
from surveyapp.core.penetration.rows import LEAST_SIGMA, RowKind
from surveyapp_models.arrays import Floats

Source = Literal[
    "angles",
    "gyro_sides",
    "centring",
    "gyro_constant",
    "start_azimuth",
    "start_position",
    "deflection",
    "lateral_refraction",
    "distances",
    "distance_scale",
    "heights_levelling",
    "heights_trigonometric",
    "height_transfer",
]
HEIGHT_TRANSFER_DIVISOR = 2.0 * math.sqrt(2.0) * 8000.0
"""One transfer of height through a shaft: h/(2 sqrt2 8000) (two may differ by h/8000)."""


@dataclass(frozen=True, slots=True)
class Contribution:
    """What one cause does to the miss.

    Parameters
    ----------
    source : str
    heading : str or None
        None: common to several headings.
    plane : ndarray, shape (2, 2)
        Covariance of (lateral, longitudinal) [m^2].
    vertical : float
        Variance [m^2].
    """

    source: Source
    heading: str | None
    plane: Floats
    vertical: float = 0.0

    @property
    def sigmas(self) -> tuple[float, float, float]:
        """1 sigma lateral, longitudinal, vertical [m]."""
        return (
            math.sqrt(max(float(self.plane[0, 0]), 0.0)),
            math.sqrt(max(float(self.plane[1, 1]), 0.0)),
            math.sqrt(max(self.vertical, 0.0)),
        )


@dataclass(frozen=True, slots=True)
class Estimator:
    """What an ordinary adjustment makes of every row.

    Parameters
    ----------
    normal : ndarray, shape (unknowns, unknowns)
    movement : ndarray, shape (unknowns, 2)
        Solution of the normal equations for both levers.
    gain : ndarray, shape (rows, 2)
        Lateral and longitudinal movement of the miss per error of each row [m/rad].
    """

    normal: Floats
    movement: Floats
    gain: Floats


def normal_matrix(mine: Mine) -> Floats:
    """Normal equations of all azimuths and constants, with the priors of the constants."""
    rows = mine.arrays
    size = rows.size
    normal = np.zeros((size + 1, size + 1))
    for i in range(3):
        for j in range(3):
            value = rows.weight * rows.partials[:, i] * rows.partials[:, j]
            np.add.at(normal, (rows.unknowns[:, i], rows.unknowns[:, j]), value)
    normal = normal[:size, :size]
    sides = size - len(mine.instruments)
    for i, sigma in enumerate(mine.constant_sigma):
        normal[sides + i, sides + i] += 1.0 / max(float(sigma), LEAST_SIGMA) ** 2
    return normal


def estimator(mine: Mine) -> Estimator:
    """Solve for the miss; every heading is oriented, so the equations have a solution."""
    normal = normal_matrix(mine)
    movement: Floats = np.asarray(np.linalg.solve(normal, mine.levers()), dtype=np.float64)
    gain: Floats = mine.arrays.weight[:, None] * mine.arrays.apply(movement)
    return Estimator(normal, movement, gain)


def squares(columns: Floats) -> Floats:
    """Sum of the outer products of columns of shape (k, 2)."""
    return np.asarray(columns.T @ columns, dtype=np.float64)


def contributions(mine: Mine, solved: Estimator | None = None) -> tuple[Contribution, ...]:
    """Every cause of the miss, in the order of the budget; what contributes nothing is left out."""
    found = estimator(mine) if solved is None else solved
    parts = [
        *_random(mine, found),
        *_constants(mine, found),
        *_starts(mine, found),
        *_deflection(mine, found),
        *_refraction(mine, found),
        *_lengths(mine),
        *_heights(mine),
    ]
    return tuple(part for part in parts if any(part.sigmas))


def _random(mine: Mine, found: Estimator) -> list[Contribution]:
    """Readings and centring: independent from row to row and from survey to survey."""
    rows, surveys = mine.arrays, mine.plan.independent_surveys
    parts: list[Contribution] = []
    kinds: tuple[tuple[Source, RowKind], ...] = (
        ("angles", RowKind.ANGLE),
        ("gyro_sides", RowKind.GYRO),
    )
    for source, kind in kinds:
        for number, heading in enumerate(mine.headings):
            mine_rows = (rows.heading == number) & (rows.kind == kind)
            plane = squares(found.gain[mine_rows] * rows.reading[mine_rows, None])
            parts.append(Contribution(source, heading.route.heading.name, plane / surveys))
    for number, heading in enumerate(mine.headings):
        mine_rows = rows.heading == number
        plane = squares(found.gain[mine_rows] * rows.centring[mine_rows, None])
        along = heading.route.sign * heading.route.along @ mine.axes
        plane = plane + squares(along * heading.length_centring[:, None])
        parts.append(Contribution("centring", heading.route.heading.name, plane / surveys))
    return parts


def _names(mine: Mine, numbers: set[int]) -> str | None:
    """Heading of a cause: its name, None where several share it."""
    if len(numbers) != 1:
        return None
    return mine.plan.headings[next(iter(numbers))].name


def _constants(mine: Mine, found: Estimator) -> list[Contribution]:
    """One column per gyro: its constant stands in every row of it, in both headings."""
    rows = mine.arrays
    by_heading: dict[str | None, Floats] = {}
    for i, sigma in enumerate(mine.constant_sigma):
        of_gyro = rows.instrument == i
        if not of_gyro.any():
            continue
        column = float(sigma) * found.gain[of_gyro].sum(axis=0)
        name = _names(mine, set(rows.heading[of_gyro].tolist()))
        by_heading[name] = by_heading.get(name, np.zeros((2, 2))) + np.outer(column, column)
    return [Contribution("gyro_constant", name, plane) for name, plane in by_heading.items()]


def _starts(mine: Mine, found: Estimator) -> list[Contribution]:
    """Start azimuths and positions; those of one group are one column."""
    rows = mine.arrays
    groups: dict[str, list[int]] = {}
    for number, heading in enumerate(mine.plan.headings):
        groups.setdefault(heading.start.group or f"\0{number}", []).append(number)
    azimuths, positions = [], []
    for numbers in groups.values():
        name = _names(mine, set(numbers))
        column, place = np.zeros(2), np.zeros((2, 2))
        for number in numbers:
            of_start = (rows.heading == number) & (rows.kind == RowKind.AZIMUTH)
            column = column + (found.gain[of_start] * rows.reading[of_start, None]).sum(axis=0)
            sigma = mine.plan.headings[number].start.position_sigma_m
            place = place + mine.routes[number].sign * sigma * mine.axes
        azimuths.append(Contribution("start_azimuth", name, np.outer(column, column)))
        positions.append(Contribution("start_position", name, squares(place)))
    return azimuths + positions


def deflection_covariance(mine: Mine) -> tuple[Floats, Floats]:
    """Covariance of what deflections do to gyro rows [rad^2], and which rows these are.

    eta is a field along the drive with covariance sigma^2 exp(-d/l); a gyro row at P gets
    -(eta_P - eta_cal) tan(phi).
    """
    field, rows = mine.plan.deflection, mine.arrays
    gyro = np.flatnonzero(rows.kind == RowKind.GYRO)
    if field is None or mine.calibrated is None or not gyro.size:
        return np.zeros((0, 0)), np.zeros(0)
    e = np.concatenate([route.e for route in mine.routes])[rows.station[gyro]]
    n = np.concatenate([route.n for route in mine.routes])[rows.station[gyro]]
    return field_covariance(mine, e, n), gyro.astype(np.float64)


def field_covariance(mine: Mine, e: Floats, n: Floats) -> Floats:
    """Covariance of -(eta_P - eta_cal) tan(phi) at places P [rad^2]."""
    field, place = mine.plan.deflection, mine.calibrated
    if field is None or place is None:
        return np.zeros((e.size, e.size))
    length = field.correlation_length_m
    between = np.exp(-np.hypot(e[:, None] - e[None, :], n[:, None] - n[None, :]) / length)
    apart = np.exp(-np.hypot(e - place[0], n - place[1]) / length)
    relative = between - apart[:, None] - apart[None, :] + 1.0
    return np.asarray((field.sigma * math.tan(field.latitude)) ** 2 * relative, dtype=np.float64)


def _deflection(mine: Mine, found: Estimator) -> list[Contribution]:
    covariance, gyro = deflection_covariance(mine)
    if not gyro.size:
        return []
    places = gyro.astype(np.int64)
    gain = found.gain[places]
    name = _names(mine, set(mine.arrays.heading[places].tolist()))
    return [Contribution("deflection", name, gain.T @ covariance @ gain)]


def refraction_columns(mine: Mine, found: Estimator) -> list[tuple[str | None, Floats]]:
    """Movement of the miss per gradient of 1 K/m at the walls [m per K/m], heading by heading."""
    rows, refraction = mine.arrays, mine.plan.refraction
    if refraction is None:
        return []
    moved = found.gain * rows.refraction[:, None]
    touched = set(rows.heading[rows.refraction != 0.0].tolist())
    if refraction.shared == "all":
        return [(_names(mine, touched), moved.sum(axis=0))] if touched else []
    return [
        (mine.plan.headings[number].name, moved[rows.heading == number].sum(axis=0))
        for number in sorted(touched)
    ]


def _refraction(mine: Mine, found: Estimator) -> list[Contribution]:
    refraction = mine.plan.refraction
    sigma = 0.0 if refraction is None else refraction.gradient_sigma
    return [
        Contribution("lateral_refraction", name, sigma**2 * np.outer(column, column))
        for name, column in refraction_columns(mine, found)
    ]


def scale_column(mine: Mine) -> Floats:
    """Movement of the miss per relative error of the distance meter [m]."""
    moved = np.zeros(2)
    for route in mine.routes:
        moved = moved + route.sign * (route.length[:, None] * route.along).sum(axis=0) @ mine.axes
    return moved


def _lengths(mine: Mine) -> list[Contribution]:
    parts = []
    for heading in mine.headings:
        along = heading.route.sign * heading.route.along @ mine.axes
        plane = squares(along * heading.length_sigma[:, None]) / mine.plan.independent_surveys
        parts.append(Contribution("distances", heading.route.heading.name, plane))
    column = (mine.plan.sigmas.scale_ppm or 0.0) * PPM * scale_column(mine)
    name = _names(mine, set(range(len(mine.headings))))
    parts.append(Contribution("distance_scale", name, np.outer(column, column)))
    return parts


def _heights(mine: Mine) -> list[Contribution]:
    surveys, nothing = mine.plan.independent_surveys, np.zeros((2, 2))
    parts: list[Contribution] = []
    transfers: dict[str, list[tuple[int, float]]] = {}
    for number, heading in enumerate(mine.headings):
        source, variance = _carried(mine, number)
        variance *= heading.route.sign**2
        name = heading.route.heading.name
        parts.append(Contribution(source, name, nothing, variance / surveys))
        depth = heading.route.heading.height_transfer_m
        if depth is not None:
            key = heading.route.heading.shaft or f"\0{number}"
            transfers.setdefault(key, []).append((number, heading.route.sign * depth))
    for members in transfers.values():
        # one transfer serves all headings of its shaft: what they share cancels in the miss
        column = sum(depth for _, depth in members) / HEIGHT_TRANSFER_DIVISOR
        shared = _names(mine, {number for number, _ in members})
        parts.append(Contribution("height_transfer", shared, nothing, column**2 / surveys))
    return parts


def _carried(mine: Mine, number: int) -> tuple[Source, float]:
    """Variance of the height carried along a heading [m^2], and what carries it."""
    method = mine.plan.height
    trig = method is not None and method.method == "trig"
    source: Source = "heights_trigonometric" if trig else "heights_levelling"
    return source, float(np.sum(side_height_variance(mine, number)))


def side_height_variance(mine: Mine, number: int) -> Floats:
    """Variance of the height difference of every side of a heading [m^2]."""
    heading, method = mine.headings[number], mine.plan.height
    length = heading.route.length
    assumed = np.zeros(length.size)
    if method is not None and method.method == "levelling":
        assumed = method.sigma_m_per_sqrt_km**2 * length / 1000.0
    elif method is not None:
        half = 0.5 if method.reciprocal else 1.0
        ends = method.sigma_hi_m**2 + method.sigma_ht_m**2
        assumed = half * (length * method.sigma_zenith) ** 2 + ends
    return np.where(np.isfinite(heading.height_sigma), heading.height_sigma**2, assumed)


def heights_known(mine: Mine) -> bool:
    """Whether something is said about how the height is carried along every side."""
    if mine.plan.height is not None:
        return True
    return all(bool(np.isfinite(heading.height_sigma).all()) for heading in mine.headings)


def total(parts: tuple[Contribution, ...]) -> tuple[Floats, float]:
    """Covariance of (lateral, longitudinal) and variance of the vertical miss [m^2]."""
    plane = np.zeros((2, 2))
    for part in parts:
        plane = plane + part.plane
    return plane, sum(part.vertical for part in parts)


__all__ = [
    "Contribution",
    "Estimator",
    "MM",
    "contributions",
    "deflection_covariance",
    "estimator",
    "field_covariance",
    "refraction_columns",
    "scale_column",
    "total",
]
