"""The formula of the textbooks: gyro sides held fixed, angles counted section by section.

It replaces the rows of angles and gyro sides of the budget and keeps every other. Where it is
conservative by more than a few per cent, or does not apply, it says so.

Source: physics.md section 5; validity penetration.md section 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from surveyapp.core.penetration.covariance import Contribution
from surveyapp.core.penetration.mine import Mine
from surveyapp.core.penetration.rows import HeadingRows, RowKind
from surveyapp.domain.penetration_result import SectionedSigma
from surveyapp.languages import joined, said
from surveyapp_models.arrays import Floats

LEAST_QUOTIENT = 1.0
"""q = k m_b^2/m_g^2 of a section below which the formula is conservative by more than 9 %."""
BENT = 1.02
"""Route longer than its lever by this ratio: bent."""
REFRACTION_SHARE = 0.01
"""Share of the lateral variance from which refraction counts."""


def sectioned(mine: Mine, parts: Sequence[Contribution]) -> SectionedSigma:
    """Lateral 1 sigma by the sectioned formula."""
    if any(not _azimuths(heading) for heading in mine.headings):
        return SectionedSigma(
            None, False, said("a heading is oriented by neither a start nor a gyro side")
        )
    variance = sum(_heading_variance(mine, heading) for heading in mine.headings)
    variance /= mine.plan.independent_surveys
    others = sum(
        float(part.plane[0, 0]) for part in parts if part.source not in ("angles", "gyro_sides")
    )
    reasons = _reasons(mine, parts)
    return SectionedSigma(math.sqrt(variance + others), not reasons, joined("; ", reasons))


def _azimuths(heading: HeadingRows) -> dict[int, float]:
    """Sigma of each oriented side by its number [rad]: gyro sides, else the start azimuth."""
    found: dict[int, list[float]] = {}
    for row in heading.rows:
        if row.kind is RowKind.GYRO:
            found.setdefault(row.side, []).append(row.reading)
    if not found:
        return {row.side: 0.0 for row in heading.rows if row.kind is RowKind.AZIMUTH}
    return {side: _combined(sigmas) for side, sigmas in found.items()}


def _combined(sigmas: Sequence[float]) -> float:
    """Sigma of the weighted mean of several determinations of one side."""
    if min(sigmas) <= 0.0:
        return 0.0
    return 1.0 / math.sqrt(sum(1.0 / sigma**2 for sigma in sigmas))


def _angle_sigmas(heading: HeadingRows) -> Floats:
    """Sigma of the angle at each station; the first and the last have none [rad]."""
    found: dict[int, list[float]] = {}
    for row in heading.rows:
        if row.kind is RowKind.ANGLE:
            found.setdefault(row.side, []).append(row.reading)
    sigma = np.zeros(heading.route.sides + 1)
    for side, values in found.items():
        sigma[side] = _combined(values)
    return sigma


def _heading_variance(mine: Mine, heading: HeadingRows) -> float:
    """Variance of angles and gyro sides of one heading [m^2]."""
    route = heading.route
    along = route.to_right @ mine.axes[:, 0]  # y' of each side
    y = np.concatenate(([0.0], np.cumsum(along)))  # from the start; the meeting point is the last
    azimuths = sorted(_azimuths(heading).items())
    sigma_b = _angle_sigmas(heading)
    first, last = azimuths[0][0], azimuths[-1][0]
    variance = float(np.sum((sigma_b[1 : first + 1] * y[1 : first + 1]) ** 2))
    ahead = slice(last + 1, route.sides)
    variance += float(np.sum((sigma_b[ahead] * (y[-1] - y[ahead])) ** 2))
    centres = [0.0]
    for (a, _), (b, _) in pairwise(azimuths):
        stations = slice(a + 1, b + 1)
        centre = float(y[stations].mean())
        variance += float(np.sum((sigma_b[stations] * (y[stations] - centre)) ** 2))
        centres.append(centre)
    centres.append(float(y[-1]))
    for (_, sigma), start, end in zip(azimuths, centres[:-1], centres[1:], strict=True):
        variance += (sigma * (end - start)) ** 2
    return variance


def _reasons(mine: Mine, parts: Sequence[Contribution]) -> list[str]:
    reasons = []
    for heading in mine.headings:
        name = heading.route.heading.name
        quotient = _least_quotient(heading)
        if quotient is not None and quotient < LEAST_QUOTIENT:
            reasons.append(
                said(
                    "heading {name}: q = k m_b^2/m_g^2 of a section is {quotient:.2f}, below "
                    "{least_quotient:g}: conservative by up to 16 %",
                    name=name,
                    quotient=quotient,
                    least_quotient=LEAST_QUOTIENT,
                )
            )
        lever = abs(float(np.sum(heading.route.to_right @ mine.axes[:, 0])))
        length = float(heading.route.reach.sum())
        if length > BENT * lever:
            reasons.append(
                said(
                    "heading {name} is bent: {length:.0f} m long, the formula's lever "
                    "{lever:.0f} m",
                    name=name,
                    length=length,
                    lever=lever,
                )
            )
        kinds = {row.kind for row in heading.rows}
        if {RowKind.GYRO, RowKind.AZIMUTH} <= kinds:
            reasons.append(said("heading {name} has a start azimuth and gyro sides", name=name))
    lateral = sum(float(part.plane[0, 0]) for part in parts)
    bent_rays = sum(
        float(part.plane[0, 0]) for part in parts if part.source == "lateral_refraction"
    )
    if lateral > 0.0 and bent_rays > REFRACTION_SHARE * lateral:
        reasons.append(
            said(
                "lateral refraction is {bent_rays:.0%} of the variance",
                bent_rays=bent_rays / lateral,
            )
        )
    return reasons


def _least_quotient(heading: HeadingRows) -> float | None:
    """Smallest q of the sections between gyro sides, None without a section."""
    sigmas = _azimuths(heading)
    sides = sorted(sigmas)
    sigma_b = _angle_sigmas(heading)
    found = []
    for a, b in pairwise(sides):
        squared = float(np.sum(sigma_b[a + 1 : b + 1] ** 2))
        gyro = 0.5 * (sigmas[a] ** 2 + sigmas[b] ** 2)
        found.append(math.inf if gyro <= 0.0 else squared / gyro)
    return min(found) if found else None
