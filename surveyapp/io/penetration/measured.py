"""What the traverse of a heading has observed along its route, as rows of the prediction.

An observation that joins no two neighbouring sides of the route does not enter; how many there are
is told. Sigmas are those of the book and its header; a gyro side has those of its sessions.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from surveyapp.core.network.centring import angle_centring
from surveyapp.core.penetration.mine import MM, PPM, MeasuredRows
from surveyapp.core.penetration.rows import Row, RowKind
from surveyapp.domain.observations import ObservationKind as K
from surveyapp.domain.penetration import AssumedSigmas, Heading
from surveyapp.domain.project import Station
from surveyapp.domain.results import LineResult
from surveyapp.domain.traverse_book import Traverse, TraverseRow


@dataclass(slots=True)
class _Collected:
    """Rows of one heading while they are collected."""

    heading: Heading
    header: Traverse
    stations: Mapping[str, Station]
    place: dict[str, int]
    rows: list[Row] = field(default_factory=list)
    lengths: dict[int, list[tuple[float, float]]] = field(default_factory=dict)
    heights: dict[int, list[float]] = field(default_factory=dict)
    left_out: int = 0

    def side(self, at: str, to: str) -> tuple[int, bool] | None:
        """Number of a side of the route, and whether it is looked at forward."""
        a, b = self.place.get(at), self.place.get(to)
        if a is None or b is None or abs(a - b) != 1:
            return None
        return min(a, b), b > a

    def length(self, side: int) -> float:
        """Length of a side from coordinates [m]."""
        p, q = (self.stations[name] for name in self.heading.sides[side])
        return math.hypot((q.e or 0.0) - (p.e or 0.0), (q.n or 0.0) - (p.n or 0.0))

    def outside(self, name: str) -> bool:
        """Whether a station is a fixed back sight outside of the route."""
        station = self.stations.get(name)
        return (
            name not in self.place
            and station is not None
            and station.fixed
            and station.has_grid_position
        )


def header_sigmas(header: Traverse) -> AssumedSigmas:
    """Sigmas of a traverse's header, for what it has not yet observed."""
    return AssumedSigmas(
        header.sigma_angle,
        header.sigma_mm,
        header.sigma_ppm,
        None,
        header.instrument_m,
        header.target_m,
    )


def measured_rows(
    heading: Heading,
    header: Traverse,
    stations: Mapping[str, Station],
    lines: Iterable[LineResult],
    *,
    deflection_apart: bool,
) -> tuple[MeasuredRows, int]:
    """Rows of a heading from its traverse, and how many observations do not enter.

    Parameters
    ----------
    heading : Heading
        All its stations have coordinates.
    header : Traverse
        With the rows of its book.
    stations : mapping
    lines : iterable of LineResult
        What the sessions have oriented.
    deflection_apart : bool
        Whether the project states a field of deflections: then their share of the sigma of a
        gyro side is taken out of it.
    """
    rows = header.rows
    place = {name: i for i, name in enumerate(heading.route)}
    found = _Collected(heading, header, stations, place)
    for row in rows:
        if row.kind is K.ANGLE:
            _angle(found, row)
        elif row.kind in (K.DISTANCE, K.SLOPE_DISTANCE):
            _distance(found, row)
        elif row.kind in (K.HEIGHT_DIFFERENCE, K.ZENITH):
            _height(found, row)
        elif row.kind is K.AZIMUTH:
            _azimuth(found, row)
        elif row.kind is K.GYRO:
            _gyro(found, row, lines, deflection_apart=deflection_apart)
    _directions(found, [row for row in rows if row.kind is K.DIRECTION])
    lengths = {side: _mean_pair(values) for side, values in found.lengths.items()}
    heights = {side: _weighted(values) for side, values in found.heights.items()}
    measured = MeasuredRows(tuple(found.rows), lengths, heights, header_sigmas(header))
    return measured, found.left_out


def _weighted(sigmas: Sequence[float]) -> float:
    """Sigma of the weighted mean."""
    return 1.0 / math.sqrt(sum(1.0 / sigma**2 for sigma in sigmas))


def _mean_pair(values: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Sigmas by reading and by centring of the weighted mean of several determinations."""
    weights = [1.0 / (own**2 + centring**2) for own, centring in values]
    total = sum(weights)
    pairs = list(zip(weights, values, strict=True))
    own = math.sqrt(sum((w * v[0]) ** 2 for w, v in pairs)) / total
    return own, math.sqrt(sum((w * v[1]) ** 2 for w, v in pairs)) / total


def _angle(found: _Collected, row: TraverseRow) -> None:
    station = found.place.get(row.at)
    if station is None:
        found.left_out += 1
        return
    back, fore = found.place.get(row.back), found.place.get(row.to)
    if {back, fore} == {station - 1, station + 1}:
        _add_angle(found, station, row.sigma, row.value)
    elif station == 0 and 1 in (back, fore):
        other = row.back if fore == 1 else row.to
        if found.outside(other) and found.heading.start.azimuth_sigma is None:
            _add_start(found, row, other)
    else:
        found.left_out += 1


def _add_angle(found: _Collected, station: int, stated: float | None, value: float | None) -> None:
    if stated is not None:
        found.rows.append(Row(RowKind.ANGLE, station, stated))
        return
    if found.header.sigma_angle is None:
        found.left_out += 1
        return
    variance = angle_centring(
        found.length(station - 1),
        found.length(station),
        value or 0.0,
        instrument_m=found.header.instrument_m,
        target_m=found.header.target_m,
    )
    found.rows.append(Row(RowKind.ANGLE, station, found.header.sigma_angle, math.sqrt(variance)))


def _add_start(found: _Collected, row: TraverseRow, other: str) -> None:
    """First side oriented by an angle from a fixed back sight."""
    own = row.sigma if row.sigma is not None else found.header.sigma_angle
    if own is None:
        found.left_out += 1
        return
    start, back = found.stations[row.at], found.stations[other]
    distance = math.hypot((back.e or 0.0) - (start.e or 0.0), (back.n or 0.0) - (start.n or 0.0))
    extra = 0.0
    if row.sigma is None and distance > 0.0:
        extra = angle_centring(
            distance,
            found.length(0),
            row.value or 0.0,
            instrument_m=found.header.instrument_m,
            target_m=found.header.target_m,
        )
    found.rows.append(Row(RowKind.AZIMUTH, 0, own, math.sqrt(extra)))


def _distance(found: _Collected, row: TraverseRow) -> None:
    side = found.side(row.at, row.to)
    header = found.header
    if side is None or (row.sigma is None and header.sigma_mm is None):
        found.left_out += 1
        return
    if row.sigma is not None:
        pair = (row.sigma, 0.0)
    else:
        own = math.hypot(
            (header.sigma_mm or 0.0) * MM, (header.sigma_ppm or 0.0) * PPM * found.length(side[0])
        )
        pair = (own, math.hypot(header.instrument_m, header.target_m))
    if math.hypot(*pair) > 0.0:
        found.lengths.setdefault(side[0], []).append(pair)


def _height(found: _Collected, row: TraverseRow) -> None:
    side = found.side(row.at, row.to)
    if side is None:
        found.left_out += 1
        return
    sigma = row.sigma
    if row.kind is K.ZENITH:
        angle = row.sigma if row.sigma is not None else found.header.sigma_angle
        sigma = None if angle is None else angle * found.length(side[0])
    if sigma is None or sigma <= 0.0:
        found.left_out += 1
        return
    found.heights.setdefault(side[0], []).append(sigma)


def _azimuth(found: _Collected, row: TraverseRow) -> None:
    side = found.side(row.at, row.to)
    sigma = row.sigma if row.sigma is not None else found.header.sigma_angle
    if side is None or sigma is None:
        found.left_out += 1
        return
    found.rows.append(Row(RowKind.AZIMUTH, side[0], sigma))


def _gyro(
    found: _Collected, row: TraverseRow, lines: Iterable[LineResult], *, deflection_apart: bool
) -> None:
    side = found.side(row.at, row.to)
    if side is None:
        found.left_out += 1
        return
    for line in lines:
        if (line.station, line.target) == (row.at, row.to):
            sigma = own_sigma(line, deflection_apart=deflection_apart)
            if 0.0 < sigma < math.inf:
                found.rows.append(Row(RowKind.GYRO, side[0], sigma, 0.0, side[1], line.instrument))


def own_sigma(line: LineResult, *, deflection_apart: bool) -> float:
    """Sigma of an oriented line without the constant that it shares [rad]."""
    total = line.grid_azimuth or line.true_azimuth
    own = line.gyro_azimuth.sigma
    if total is None or line.constant_sigma is None:
        return own
    variance = total.sigma**2 - line.constant_sigma**2
    if deflection_apart:
        variance -= sum(part.sigma**2 for part in line.budget if part.source == "deflection")
    return math.sqrt(max(variance, own**2))


def _directions(found: _Collected, rows: Sequence[TraverseRow]) -> None:
    """Directions of one set to both neighbours make an angle."""
    sets: dict[tuple[str, str], dict[str, TraverseRow]] = {}
    for row in rows:
        sets.setdefault((row.at, row.set), {})[row.to] = row
    own = found.header.sigma_angle
    for (at, _), targets in sets.items():
        station = found.place.get(at)
        if station is None or not 0 < station < len(found.heading.route) - 1:
            found.left_out += len(targets)
            continue
        ends = [found.heading.route[station - 1], found.heading.route[station + 1]]
        if not all(name in targets for name in ends):
            found.left_out += len(targets)
            continue
        stated = [targets[name].sigma for name in ends]
        if all(sigma is not None for sigma in stated):
            _add_angle(found, station, math.hypot(*(sigma or 0.0 for sigma in stated)), None)
        elif own is not None:
            turn = (targets[ends[1]].value or 0.0) - (targets[ends[0]].value or 0.0)
            _add_angle(found, station, None, turn)
