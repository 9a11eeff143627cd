"""Independent orientations of one side: what they are, how far apart, how good their mean.

Two orientations of a side are independent where another instrument, another date or the other end
of the side was used; rounds of one occupation are not. The unknown deflection of the vertical is
left out of the mean square error: the regulations mean the measurement.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from itertools import combinations

from surveyapp.core.orientation.lines import OrientedLine
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.statistics.repeated import weighted_mean
from surveyapp.core.tolerance.evaluate import Measured
from surveyapp.core.tolerance.quantities import quantity
from surveyapp.core.uncertain import Uncertain, aligned, combine
from surveyapp.domain.subject import Subject
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC, wrap_pi


@dataclass(frozen=True, slots=True)
class SideOrientation:
    """One independent orientation of a side.

    Parameters
    ----------
    station, target, instrument : str
    day : date or None
    azimuth : Uncertain
        Grid azimuth, else astronomic, else gyro, of the side seen from ``station`` [rad].
    kind : str
        grid | true | gyro.
    """

    station: str
    target: str
    instrument: str
    day: date | None
    azimuth: Uncertain
    kind: str


def side_orientations(orientation: Orientation) -> dict[frozenset[str], list[SideOrientation]]:
    """Independent orientations of every surveyed side, by its two ends."""
    lines = {
        (line.result.station, line.result.target, line.result.instrument): line
        for line in orientation.lines
    }
    groups: dict[tuple[str, str, str, date | None], list[Uncertain]] = {}
    for item in orientation.sessions:
        session = item.session
        if session.purpose != "survey":
            continue
        for target in item.targets:
            if target.gyro_azimuth is not None:
                key = (session.station, target.target, session.instrument, session.day)
                groups.setdefault(key, []).append(target.gyro_azimuth)
    sides: dict[frozenset[str], list[SideOrientation]] = {}
    for (station, target_name, instrument, day), values in groups.items():
        line = lines.get((station, target_name, instrument))
        if line is None:
            continue
        azimuth, kind = _carried(weighted_mean(aligned(values)), line)
        sides.setdefault(frozenset((station, target_name)), []).append(
            SideOrientation(station, target_name, instrument, day, azimuth, kind)
        )
    return sides


def _carried(gyro: Uncertain, line: OrientedLine) -> tuple[Uncertain, str]:
    """Carry the mean of one occupation to where the whole line was carried."""
    for kind, whole in (("grid", line.grid), ("true", line.true)):
        if whole is not None:
            return gyro + (whole - line.gyro), kind
    return gyro, "gyro"


def _comparable(first: SideOrientation, second: SideOrientation) -> bool:
    same_end = first.station == second.station
    if same_end and first.instrument == second.instrument:
        return first.kind == second.kind
    if same_end:
        return first.kind == second.kind != "gyro"
    return first.kind == second.kind == "grid"


def _pairs(
    orientation: Orientation,
) -> Mapping[Subject, list[tuple[SideOrientation, SideOrientation]]]:
    """Comparable pairs of each side; an empty list where there is none."""
    result = {}
    for members in side_orientations(orientation).values():
        side = Subject.side(members[0].station, members[0].target)
        result[side] = [pair for pair in combinations(members, 2) if _comparable(*pair)]
    return result


def _turned(item: SideOrientation, first: SideOrientation) -> Uncertain:
    """The azimuth seen from the first one's end, near the first one's value."""
    turned = item.azimuth if item.station == first.station else item.azimuth.shifted(math.pi)
    base = first.azimuth.value
    return turned.shifted(base + wrap_pi(turned.value - base) - turned.value)


def independent_difference(orientation: Orientation) -> list[Measured]:
    """Largest difference of two independent orientations of one side."""
    name = "independent_difference"
    found = []
    for side, pairs in _pairs(orientation).items():
        if not pairs:
            found.append(_nothing(name, side))
            continue
        value, text = max(
            (
                abs(_turned(b, a).value - a.azimuth.value),
                said("{a} and {b}", a=_label(a), b=_label(b)),
            )
            for a, b in pairs
        )
        found.append(Measured(name, value * RHO_ARCSEC, side.text, text, subject=side))
    return found


def independent_mean_sigma(orientation: Orientation) -> list[Measured]:
    """Mean square error of the mean of two independent orientations, from their budgets."""
    name = "independent_mean_sigma"
    found = []
    for side, pairs in _pairs(orientation).items():
        sigmas = [
            combine([(0.5, a.azimuth), (0.5, _turned(b, a))]).without("deflection").sigma
            for a, b in pairs
        ]
        finite = [sigma for sigma in sigmas if math.isfinite(sigma)]
        if not finite:
            found.append(_nothing(name, side))
        else:
            text = said("from the error budgets, without the deflection of the vertical")
            value = max(finite) * RHO_ARCSEC
            found.append(Measured(name, value, side.text, text, subject=side))
    return found


def _nothing(name: str, side: Subject) -> Measured:
    return Measured(
        name, None, side.text, said("missing: {needs}", needs=quantity(name).needs), subject=side
    )


def _label(item: SideOrientation) -> str:
    day = f" {item.day.isoformat()}" if item.day is not None else ""
    return f"{item.station} {item.instrument}{day}"
