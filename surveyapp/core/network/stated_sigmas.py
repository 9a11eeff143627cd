"""Standard deviations of the rows of a traverse book: of the row, of its header, with centring.

A sigma in a row is the surveyor's statement about that observation and is taken as it stands;
centring is added to the header's sigmas only.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from surveyapp.core.network.centring import angle_centring, direction_centring
from surveyapp.core.network.setups import Lengths
from surveyapp.domain.observations import EstimatedSigma, ObservationKind
from surveyapp.domain.project import Station
from surveyapp.domain.traverse_book import Traverse, TraverseRow

K = ObservationKind
MM: Final = 1e-3
_LENGTHS = frozenset({K.DISTANCE, K.SLOPE_DISTANCE})


def side_lengths(
    rows: Sequence[TraverseRow], stations: Mapping[str, Station]
) -> dict[tuple[str, str], float]:
    """Horizontal side lengths by two stations, from distances and, failing those, coordinates."""
    zeniths = {(row.at, row.to): row.value for row in rows if row.kind is K.ZENITH}
    found: dict[tuple[str, str], float] = {}
    for row in rows:
        if row.kind not in _LENGTHS or row.value is None or row.value <= 0.0:
            continue
        steep = zeniths.get((row.at, row.to)) if row.kind is K.SLOPE_DISTANCE else None
        length = row.value * (1.0 if steep is None else math.sin(steep))
        found[row.at, row.to] = found[row.to, row.at] = length
    for row in rows:
        for name in (row.to, row.back):
            a, b = stations.get(row.at), stations.get(name)
            if a is None or b is None or (row.at, name) in found:
                continue
            if a.e is None or a.n is None or b.e is None or b.n is None:
                continue
            if (length := math.hypot(b.e - a.e, b.n - a.n)) > 0.0:
                found[row.at, name] = length
    return found


def row_sigma(row: TraverseRow, header: Traverse, lengths: Lengths) -> float | None:
    """Standard deviation of a row [rad] or [m], None where nothing states one."""
    if row.sigma is not None:
        return row.sigma
    both = {"instrument_m": header.instrument_m, "target_m": header.target_m}
    if row.kind in _LENGTHS:
        if header.sigma_mm is None or header.sigma_ppm is None:
            return None
        own = math.hypot(header.sigma_mm * MM, header.sigma_ppm * 1e-6 * (row.value or 0.0))
        return math.sqrt(own**2 + header.instrument_m**2 + header.target_m**2)
    if row.kind is K.ZENITH and header.sigma_zenith is not None:
        return header.sigma_zenith
    if row.kind in (K.HEIGHT_DIFFERENCE, K.GYRO) or header.sigma_angle is None:
        return None
    fore = lengths.get((row.at, row.to))
    if row.kind is K.ANGLE:
        back = lengths.get((row.at, row.back))
        extra = (
            0.0
            if back is None or fore is None
            else angle_centring(back, fore, row.value or 0.0, **both)
        )
        return math.sqrt(header.sigma_angle**2 + extra)
    own = header.sigma_angle / math.sqrt(2.0)  # an angle is the difference of two directions
    if row.kind is K.ZENITH:
        return header.sigma_angle
    extra = 0.0 if fore is None else direction_centring(fore, **both)
    return math.sqrt(own**2 + extra)


def estimated_part(row: TraverseRow, header: Traverse) -> EstimatedSigma | None:
    """What of a row's variance the header's sigma brings, where that one was estimated."""
    if row.sigma is not None or not (header.sigma_dof or header.centring_assumed):
        return None
    known = dict(header.sigma_dof)
    if row.kind in _LENGTHS:
        name, sigma = "distance", header.sigma_mm
        ppm = (header.sigma_ppm or 0.0) * 1e-6 * (row.value or 0.0)
        sigma = None if sigma is None else math.hypot(sigma * MM, ppm)
    elif row.kind is K.ZENITH and header.sigma_zenith is not None:
        name, sigma = "zenith", header.sigma_zenith
    else:
        name, sigma = "angle", header.sigma_angle
        if row.kind is K.DIRECTION and sigma is not None:
            sigma /= math.sqrt(2.0)
    if name not in known and name != "distance":
        name = "circles"
    if not sigma or not (name in known or header.centring_assumed):
        return None
    dof = known.get(name, math.inf)
    return EstimatedSigma(f"{header.name}: {name}", sigma**2, dof, header.centring_assumed)
