"""Readings of a simulated survey: displaced marks, bent rays, drawn constants and deflections.

Errors are those of readings, computed from where instruments and marks really stand and along
which curve the light really comes; nothing here takes a lever or a covariance of the miss.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.penetration.covariance import field_covariance
from surveyapp.core.penetration.mine import Mine
from surveyapp.core.penetration.route import Route
from surveyapp.core.penetration.rows import HeadingRows, Row, RowKind
from surveyapp_models.arrays import Floats
from surveyapp_models.sight_refraction import curvature_per_gradient

Ints = NDArray[np.int64]


class Draw:
    """Standard normal numbers for a number of runs, the runs last."""

    __slots__ = ("generator", "runs")

    def __init__(self, generator: np.random.Generator, runs: int) -> None:
        self.generator, self.runs = generator, runs

    def __call__(self, *shape: int) -> Floats:
        """Numbers of shape (*shape, runs)."""
        return self.generator.standard_normal((*shape, self.runs))


def shared_errors(mine: Mine, draw: Draw, *, gradient: float, shift: float) -> Floats:
    """Errors that every survey of a run repeats, shape (rows, runs) [rad].

    Parameters
    ----------
    mine : Mine
    draw : Draw
    gradient : float
        Undeclared, at every wall that a heading names [K/m].
    shift : float
        Undeclared, of all sides of heading 1 after its first [rad].
    """
    arrays = mine.arrays
    errors = np.zeros((arrays.reading.size, draw.runs))
    gyro = np.flatnonzero(arrays.kind == RowKind.GYRO)
    constants = mine.constant_sigma[:, None] * draw(len(mine.instruments))
    errors[gyro] += constants[arrays.instrument[gyro]]
    errors += bent_rays(mine, draw, gradient=gradient)
    errors[gyro] += deflections(mine, gyro, draw)
    turns: dict[str, Floats] = {}
    for number, heading in enumerate(mine.plan.headings):
        key = heading.start.group or f"\0{number}"
        if key not in turns:
            turns[key] = draw()
        start = (arrays.kind == RowKind.AZIMUTH) & (arrays.heading == number)
        errors[start] += arrays.reading[start, None] * turns[key]
    slipped = np.flatnonzero(
        (arrays.heading == 0) & (arrays.kind == RowKind.ANGLE) & (arrays.unknowns[:, 1] == 0)
    )
    errors[slipped[:1]] += shift
    return errors


def bent_rays(mine: Mine, draw: Draw, *, gradient: float) -> Floats:
    """Readings along curved rays, shape (rows, runs) [rad]."""
    refraction = mine.plan.refraction
    sigma = 0.0 if refraction is None else refraction.gradient_sigma
    curvature = curvature_per_gradient(
        pressure_hpa=1013.25 if refraction is None else refraction.pressure_hpa,
        temperature_c=15.0 if refraction is None else refraction.temperature_c,
    )
    common, found = draw(), []
    for heading in mine.headings:
        own = common
        if refraction is not None and refraction.shared == "heading":
            own = draw()
        wall = np.array(heading.route.heading.wall_signs())
        kappa = curvature * wall[:, None] * (gradient + sigma * own)
        found += [_along_rays(row, heading.route, kappa) for row in heading.rows]
    return np.array(found).reshape(-1, draw.runs)


def _ray(kappa: Floats, ends: tuple[int, int], length: float) -> Floats:
    """Direction in which a target is seen, to the right of the drive looking forward [rad].

    The light bends with a curvature that changes linearly from station to target; its tangent at
    the station is found from the curve that ends on the target.
    """
    first, last = kappa[ends[0]], kappa[ends[1]]
    # y'' = first + (last - first) s/length, y(0) = y(length) = 0: y'(0) is minus the slope needed
    slope = length * (first / 2.0 + (last - first) / 6.0)
    seen = np.arctan(slope)
    return np.asarray(seen if ends[1] > ends[0] else -seen, dtype=np.float64)


def _along_rays(row: Row, route: Route, kappa: Floats) -> Floats:
    side = row.side
    if row.kind is RowKind.ANGLE:
        ahead = _ray(kappa, (side, side + 1), float(route.length[side]))
        return ahead - _ray(kappa, (side, side - 1), float(route.length[side - 1]))
    if row.kind is RowKind.GYRO:
        ends = (side, side + 1) if row.forward else (side + 1, side)
        return _ray(kappa, ends, float(route.length[side]))
    return np.zeros(kappa.shape[1])


def deflections(mine: Mine, gyro: Ints, draw: Draw) -> Floats:
    """-(eta_P - eta_cal) tan(phi) at every gyro row, shape (gyro rows, runs) [rad]."""
    if mine.plan.deflection is None or not gyro.size:
        return np.zeros((gyro.size, draw.runs))
    stations, index = np.unique(mine.arrays.station[gyro], return_inverse=True)
    e = np.concatenate([route.e for route in mine.routes])[stations]
    n = np.concatenate([route.n for route in mine.routes])[stations]
    values, vectors = np.linalg.eigh(field_covariance(mine, e, n))
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.asarray((root @ draw(len(stations)))[index], dtype=np.float64)


def own_errors(mine: Mine, draw: Draw) -> Floats:
    """Reading errors and displaced marks of one survey, shape (rows, runs) [rad]."""
    arrays = mine.arrays
    errors = arrays.reading[:, None] * draw(arrays.reading.size)
    errors[arrays.kind == RowKind.AZIMUTH] = 0.0  # starts are drawn once for all surveys
    place = 0
    for heading in mine.headings:
        for row in heading.rows:
            if row.centring > 0.0:
                errors[place] += _displaced(heading, row, draw)
            place += 1
    return errors


def _displaced(heading: HeadingRows, row: Row, draw: Draw) -> Floats:
    """Change of a reading because instrument and targets do not stand over their marks [rad]."""
    if row.kind is RowKind.AZIMUTH or not any(heading.marks):
        return row.centring * draw()
    at_instrument, at_target = heading.marks
    route, side = heading.route, row.side
    instrument = at_instrument * draw(2)
    if row.kind is RowKind.GYRO:
        return _turned(route, side, instrument, at_target * draw(2))
    ahead = _turned(route, side, instrument, at_target * draw(2))
    # the back sight: from the end of the side behind to its beginning
    return ahead - _turned(route, side - 1, at_target * draw(2), instrument)


def _turned(route: Route, side: int, first: Floats, second: Floats) -> Floats:
    """Turn of a side whose ends are displaced, east and north each [rad]."""
    east = float(route.e[side + 1] - route.e[side])
    north = float(route.n[side + 1] - route.n[side])
    new_east, new_north = east + second[0] - first[0], north + second[1] - first[1]
    cross = new_east * north - new_north * east
    return np.asarray(np.arctan2(cross, new_east * east + new_north * north), dtype=np.float64)
