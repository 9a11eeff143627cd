"""A mine made ready for prediction: headings with their rows, gyros, and the shared causes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from surveyapp.core.penetration.route import Route, axes, route_of
from surveyapp.core.penetration.rows import (
    HeadingRows,
    Row,
    RowArrays,
    RowKind,
    angle_centring_sigma,
    row_arrays,
    side_centring_sigma,
)
from surveyapp.domain.penetration import AssumedSigmas, GyroSide, Heading, Penetration
from surveyapp.domain.project import Station
from surveyapp_models.arrays import Floats
from surveyapp_models.sight_refraction import curvature_per_gradient

MM, PPM = 1e-3, 1e-6


@dataclass(frozen=True, slots=True)
class MeasuredRows:
    """What the traverse of a heading has observed along its route.

    Parameters
    ----------
    rows : tuple of Row
        Angles, gyro sides and azimuths.
    lengths : mapping of int to (float, float)
        Sigma of a side by reading and by centring [m].
    heights : mapping of int to float
        Sigma of the height difference of a side [m].
    sigmas : AssumedSigmas
        Those of the traverse's header, for what is not yet observed.
    """

    rows: tuple[Row, ...]
    lengths: Mapping[int, tuple[float, float]]
    heights: Mapping[int, float]
    sigmas: AssumedSigmas


@dataclass(frozen=True, slots=True)
class Mine:
    """Everything that the prediction needs.

    Parameters
    ----------
    plan : Penetration
    headings : tuple of HeadingRows
    instruments : tuple of str
        Gyros, in the order of their unknowns.
    constant_sigma : ndarray, shape (instruments,)
        1 sigma of each constant: the shared part [rad].
    calibrated : tuple of float or None
        East and north of the station at which the constants were formed [m].
    arrays : RowArrays
    """

    plan: Penetration
    headings: tuple[HeadingRows, ...]
    instruments: tuple[str, ...]
    constant_sigma: Floats
    calibrated: tuple[float, float] | None
    arrays: RowArrays

    @property
    def routes(self) -> tuple[Route, ...]:
        """Geometry of the headings."""
        return tuple(heading.route for heading in self.headings)

    @property
    def axes(self) -> Floats:
        """Unit vectors right of the axis and along it as columns, shape (2, 2)."""
        return axes(self.plan.axis_azimuth)

    @property
    def first_side(self) -> tuple[int, ...]:
        """Number of the first side of each heading among all."""
        return tuple(np.cumsum([0, *(route.sides for route in self.routes)])[:-1].tolist())

    def levers(self) -> Floats:
        """Lateral and longitudinal movement of the miss per unknown [m/rad], (unknowns, 2)."""
        moved = np.vstack([route.sign * route.to_right for route in self.routes]) @ self.axes
        return np.vstack([moved, np.zeros((len(self.instruments), 2))])

    def with_rows(self, extra: Sequence[tuple[int, Row]]) -> Mine:
        """The mine with further rows, each in the heading of the given number."""
        headings = list(self.headings)
        for number, row in extra:
            headings[number] = replace(headings[number], rows=(*headings[number].rows, row))
        return assemble(self.plan, headings, self.gyros(), self.calibrated)

    def gyros(self) -> dict[str, float]:
        """Shared sigma of every gyro by its id [rad]."""
        return dict(zip(self.instruments, self.constant_sigma.tolist(), strict=True))


def assemble(
    plan: Penetration,
    headings: Sequence[HeadingRows],
    constants: Mapping[str, float],
    calibrated: tuple[float, float] | None,
) -> Mine:
    """Put headings and gyros together."""
    instruments = tuple(constants)
    refraction = plan.refraction
    curvature = (
        0.0
        if refraction is None
        else curvature_per_gradient(
            pressure_hpa=refraction.pressure_hpa, temperature_c=refraction.temperature_c
        )
    )
    sigma = np.array([constants[name] for name in instruments], dtype=np.float64)
    arrays = row_arrays(headings, instruments, curvature=curvature)
    return Mine(plan, tuple(headings), instruments, sigma, calibrated, arrays)


def build_mine(
    plan: Penetration,
    stations: Mapping[str, Station],
    constants: Mapping[str, float],
    measured: Mapping[str, MeasuredRows] | None = None,
) -> Mine:
    """Make a mine ready for prediction.

    Parameters
    ----------
    plan : Penetration
        Checked before.
    stations : mapping
        All stations by name.
    constants : mapping of str to float
        Sigma of the constant of every gyro that is or may be used [rad].
    measured : mapping of heading name to MeasuredRows or None
        What traverses have observed; it replaces what would be assumed.
    """
    headings = []
    for number, heading in enumerate(plan.headings):
        sign = 1.0 if number == 0 else -1.0
        route = route_of(heading, stations, sign=sign, meeting=plan.meeting)
        headings.append(_heading_rows(plan, route, (measured or {}).get(heading.name)))
    calibrated = None
    if plan.deflection is not None:
        place = stations[plan.deflection.calibrated_at]
        calibrated = (float(place.e or 0.0), float(place.n or 0.0))
    return assemble(plan, headings, constants, calibrated)


def _heading_rows(plan: Penetration, route: Route, found: MeasuredRows | None) -> HeadingRows:
    sigmas = merged(plan.sigmas, None if found is None else found.sigmas)
    both = {
        "instrument_m": sigmas.centring_instrument_m or 0.0,
        "target_m": sigmas.centring_target_m or 0.0,
    }
    rows = [] if found is None else list(found.rows)
    done = {(row.kind, row.side) for row in rows}
    for side in range(1, route.sides):
        if (RowKind.ANGLE, side) not in done:
            centring = angle_centring_sigma(route, side, **both)
            rows.append(Row(RowKind.ANGLE, side, sigmas.angle or 0.0, centring))
    start = route.heading.start.azimuth_sigma
    if start is not None and (RowKind.AZIMUTH, 0) not in done:
        rows.append(Row(RowKind.AZIMUTH, 0, start))
    rows += _gyro_rows(plan.gyro, route, done, both)
    length = np.hypot(
        (sigmas.distance_mm or 0.0) * MM, (sigmas.distance_ppm or 0.0) * PPM * route.length
    )
    centring_m = np.full(route.sides, math.hypot(both["instrument_m"], both["target_m"]))
    for side, (own, centring) in ({} if found is None else found.lengths).items():
        length[side], centring_m[side] = own, centring
    heights = np.full(route.sides, np.nan)
    for side, sigma in ({} if found is None else found.heights).items():
        heights[side] = sigma
    marks = (both["instrument_m"], both["target_m"])
    return HeadingRows(route, tuple(rows), length, centring_m, heights, marks)


def _gyro_rows(
    gyro: Sequence[GyroSide],
    route: Route,
    done: set[tuple[RowKind, int]],
    centring: Mapping[str, float],
) -> list[Row]:
    """Rows of the gyro sides that lie in a route and are not observed yet."""
    rows = []
    for item in gyro:
        found = route.side_of(item.at, item.to)
        if found is None or (RowKind.GYRO, found[0]) in done:
            continue
        side, forward = found
        beside = side_centring_sigma(
            route, side, instrument_m=centring["instrument_m"], target_m=centring["target_m"]
        )
        rows += [
            Row(RowKind.GYRO, side, item.sigma, beside, ahead, item.instrument)
            for ahead in ((forward, not forward) if item.reciprocal else (forward,))
        ]
    return rows


def merged(stated: AssumedSigmas, header: AssumedSigmas | None) -> AssumedSigmas:
    """Sigmas of the project, where it is silent those of the traverse's header."""
    if header is None:
        return stated
    silent = {
        field.name: getattr(header, field.name)
        for field in fields(stated)
        if getattr(stated, field.name) is None
    }
    return replace(stated, **silent)


def heading_of_side(headings: Sequence[Heading], at: str, to: str) -> Heading | None:
    """Heading in whose route a side lies, in either direction."""
    for heading in headings:
        if (at, to) in heading.sides or (to, at) in heading.sides:
            return heading
    return None
