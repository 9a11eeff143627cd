"""After the breakthrough: the measured miss against its prediction, and what it can say.

One lateral miss is one number and many causes can make it: each is told with the size it would
need, in declared sigmas, and none is named.

Source: penetration.md section 3.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.penetration.covariance import (
    Estimator,
    contributions,
    estimator,
    heights_known,
    refraction_columns,
    scale_column,
    total,
)
from surveyapp.core.penetration.mine import PPM, Mine, assemble
from surveyapp.core.penetration.rows import RowKind
from surveyapp.core.statistics.distributions import chi_square_tail
from surveyapp.domain.penetration import MeasuredMiss, Wall, WallRefraction
from surveyapp.domain.penetration_result import HeadingShare, MissCandidate, MissTest
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

CRITICAL_T = 2.576
"""Two-sided 1 % of the normal distribution."""
LEVEL = 0.01
LEAST_LEVER = 1e-9


@dataclass(frozen=True, slots=True)
class Closure:
    """The test of a miss without its candidates.

    Parameters
    ----------
    t : tuple of float or None
    chi2, p : float
    consistent : bool
    """

    t: tuple[float | None, float | None, float | None]
    chi2: float
    p: float

    @property
    def consistent(self) -> bool:
        """Every |t| below 2.576 and chi-square passes 1 %."""
        return self.p >= LEVEL and all(abs(t) < CRITICAL_T for t in self.t if t is not None)


def covariance3(mine: Mine) -> Floats:
    """Covariance of (lateral, longitudinal, vertical) [m^2], shape (3, 3)."""
    plane, vertical = total(contributions(mine))
    matrix = np.zeros((3, 3))
    matrix[:2, :2], matrix[2, 2] = plane, vertical
    return matrix


def closure_test(miss: Sequence[float | None], covariance: Floats, *, heights: bool) -> Closure:
    """T of each component and chi-square of those that were measured and predicted."""
    used = [
        i
        for i, value in enumerate(miss)
        if value is not None and covariance[i, i] > 0.0 and (heights or i < 2)
    ]
    t: list[float | None] = [None, None, None]
    values = np.array([float(miss[i] or 0.0) for i in used])
    for i, value in zip(used, values, strict=True):
        t[i] = float(value) / math.sqrt(float(covariance[i, i]))
    if not used:
        return Closure((None, None, None), 0.0, 1.0)
    part = covariance[np.ix_(used, used)]
    chi2 = float(values @ np.linalg.solve(part, values))
    return Closure((t[0], t[1], t[2]), chi2, chi_square_tail(chi2, len(used)))


def evaluate_miss(mine: Mine, miss: MeasuredMiss) -> MissTest:
    """Test the measured miss, distribute it, and list what single causes would need."""
    covariance = covariance3(mine)
    values = (miss.lateral_m, miss.longitudinal_m, miss.vertical_m)
    test = closure_test(values, covariance, heights=heights_known(mine))
    consistent = test.consistent
    return MissTest(
        t=test.t,
        chi2=test.chi2,
        p=test.p,
        consistent=consistent,
        verdict="consistent" if consistent else "not_separable",
        candidates=tuple(_candidates(mine, miss)),
        distribution=distribution(mine, values),
        text=_text(test),
    )


def _text(test: Closure) -> str:
    if test.consistent:
        return said("The miss is what the declared errors make; it accuses nothing.")
    lateral, along = (abs(t or 0.0) for t in test.t[:2])
    text = said(
        "The miss is larger than the declared errors make. One number does not "
        "name its cause: every line of the list would make it alone."
    )
    if along >= CRITICAL_T > lateral:
        text += said(
            " A longitudinal miss without a lateral one points to the scale of the lengths."
        )
    return text + (
        said(
            " Gyro sides from both ends, sights in zigzag or a second gyro separate what is listed."
        )
    )


def _candidates(mine: Mine, miss: MeasuredMiss) -> list[MissCandidate]:
    """What each cause alone would have to be."""
    found: list[MissCandidate] = []
    solved = estimator(mine)
    if miss.lateral_m is not None:
        found += _lateral(mine, solved, miss.lateral_m)
    if miss.longitudinal_m is not None:
        column = float(scale_column(mine)[1]) * PPM
        if abs(column) > LEAST_LEVER:
            needed = miss.longitudinal_m / column
            sigma = mine.plan.sigmas.scale_ppm
            found.append(
                _candidate("distance_scale", needed, "ppm", sigma, component="longitudinal")
            )
    return found


def _candidate(
    effect: str, needed: float, unit: str, sigma: float | None, *, component: str
) -> MissCandidate:
    return MissCandidate(effect, needed, unit, abs(needed) / sigma if sigma else None, component)


def _lateral(mine: Mine, solved: Estimator, miss: float) -> list[MissCandidate]:
    rows, gain = mine.arrays, solved.gain[:, 0]
    found = []
    for i, sigma in enumerate(mine.constant_sigma):
        lever = float(gain[rows.instrument == i].sum())
        if abs(lever) > LEAST_LEVER:
            needed = miss / lever / ARCSEC
            item = _candidate(
                "gyro_constant", needed, "arcsec", float(sigma) / ARCSEC, component="lateral"
            )
            found.append(replace(item, subject=mine.instruments[i]))
    for number, heading in enumerate(mine.plan.headings):
        start = (rows.kind == RowKind.AZIMUTH) & (rows.heading == number)
        lever = float(gain[start].sum())
        if abs(lever) > LEAST_LEVER:
            needed = miss / lever / ARCSEC
            declared = float(np.sqrt(np.mean(rows.reading[start] ** 2))) / ARCSEC
            item = _candidate("start_azimuth", needed, "arcsec", declared, component="lateral")
            found.append(replace(item, subject=heading.name))
    found += [
        _candidate("lateral_refraction", miss / column, "K/m", declared, component="lateral")
        for column, declared in _walls(mine, solved)
        if abs(column) > LEAST_LEVER
    ]
    return found


def _walls(mine: Mine, solved: Estimator) -> list[tuple[float, float | None]]:
    """Lateral movement per gradient, and the declared sigma.

    Where no heading says along which wall it runs, one wall all along is supposed.
    """
    refraction = mine.plan.refraction
    if refraction is not None and any(any(h.wall_signs()) for h in mine.plan.headings):
        sigma = refraction.gradient_sigma
        return [(float(c[0]), sigma) for _, c in refraction_columns(mine, solved)]
    supposed = one_wall(mine)
    return [(float(c[0]), None) for _, c in refraction_columns(supposed, solved)]


def one_wall(mine: Mine) -> Mine:
    """The mine with all stations along one wall: right in heading 1, the same one in heading 2."""
    headings = []
    for heading in mine.headings:
        named = heading.route.heading
        if any(named.wall_signs()):
            headings.append(heading)
            continue
        facing = float(np.sum(heading.route.along @ mine.axes[:, 1]))
        along: Wall = "right" if facing >= 0.0 else "left"
        own = replace(named, wall=(along,) * len(named.route))
        headings.append(replace(heading, route=replace(heading.route, heading=own)))
    refraction = mine.plan.refraction or WallRefraction(1.0)
    plan = replace(
        mine.plan,
        refraction=refraction,
        headings=tuple(heading.route.heading for heading in headings),
    )
    return assemble(plan, headings, mine.gyros(), mine.calibrated)


def distribution(mine: Mine, miss: Sequence[float | None]) -> tuple[HeadingShare, ...]:
    """How the miss is taken up by the ends of the headings: least squares with one condition.

    The end of heading h moves by -cov(K_h, m) C^-1 m, so that what is left is zero.
    """
    used = [i for i, value in enumerate(miss) if value is not None]
    covariance = covariance3(mine)
    used = [i for i in used if covariance[i, i] > 0.0]
    if not used:
        return ()
    values = np.array([float(miss[i] or 0.0) for i in used])
    weighted = np.linalg.solve(covariance[np.ix_(used, used)], values)
    shares = []
    for number, heading in enumerate(mine.headings):
        cross = _cross(mine, number)[np.ix_(used, used)]
        # cross is the covariance of the heading's signed part with the miss
        moved = -heading.route.sign * (cross @ weighted)
        found: list[float | None] = [None, None, None]
        for i, value in zip(used, moved, strict=True):
            found[i] = float(value)
        shares.append(HeadingShare(heading.route.heading.name, found[0], found[1], found[2]))
    return tuple(shares)


def _cross(mine: Mine, number: int) -> Floats:
    """cov(x, m) for the part x of one heading in the miss m: (var(x + m) - var(x - m)) / 4."""

    def weighted(factors: Sequence[float]) -> Floats:
        headings = [
            replace(h, route=replace(h.route, sign=h.route.sign * factor))
            for h, factor in zip(mine.headings, factors, strict=True)
        ]
        return covariance3(replace(mine, headings=tuple(headings)))

    more = [2.0 if i == number else 1.0 for i in range(len(mine.headings))]
    less = [0.0 if i == number else -1.0 for i in range(len(mine.headings))]
    return (weighted(more) - weighted(less)) / 4.0
