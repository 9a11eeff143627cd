"""When a miss may be named after all: the residuals name an effect, and something separates it.

The diagnosis of a heading's traverse names an effect from its residuals. It explains the miss only
where the survey holds what separates it from its rivals (reciprocal gyro sides or sights in zigzag
for a wall, a second gyro for a constant), and where what it does to the meeting point takes the
miss back within the declared errors. Everything else stays not separable.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.penetration.covariance import estimator, heights_known
from surveyapp.core.penetration.evaluation import closure_test, covariance3, one_wall
from surveyapp.core.penetration.mine import PPM, Mine
from surveyapp.core.penetration.rows import HeadingRows, Row, RowKind
from surveyapp.domain.observations import Observation
from surveyapp.domain.penetration import MeasuredMiss
from surveyapp.domain.penetration_result import MissTest, ResidualVerdict
from surveyapp.languages import joined, said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.sight_refraction import curvature_per_gradient


@dataclass(frozen=True, slots=True)
class NamedEffect:
    """An effect that a diagnosis has named, with its first coefficient in its own unit.

    Parameters
    ----------
    effect : str
        gyro_constant_shift [arcsec], lateral_refraction [arcsec/100 m], distance_scale [ppm].
    value : float
    sides : tuple of (at, to, instrument) or None
        Gyro sides that a shift of the constant has turned; None: all of the heading.
    """

    effect: str
    value: float
    sides: tuple[tuple[str, str, str], ...] | None = None


@dataclass(frozen=True, slots=True)
class HeadingResiduals:
    """What the residuals of one heading's traverse say.

    Parameters
    ----------
    heading : int
    traverse, verdict : str
    named : tuple of NamedEffect
    """

    heading: int
    traverse: str
    verdict: str
    named: tuple[NamedEffect, ...]


def explain(
    mine: Mine, miss: MeasuredMiss, test: MissTest, found: Sequence[HeadingResiduals]
) -> MissTest:
    """The test of a miss with what the residuals say; explained only where that is proved."""
    told = tuple(
        ResidualVerdict(item.traverse, item.verdict, tuple(e.effect for e in item.named))
        for item in found
    )
    test = replace(test, residuals=told)
    if test.consistent:
        return test
    taken = np.zeros(2)
    names = []
    for item in found:
        for effect in item.named:
            if separated(mine.headings[item.heading], effect.effect):
                taken = taken + movement(mine, item.heading, effect)
                names.append(
                    said(
                        "{replace} in traverse {traverse}",
                        replace=effect.effect.replace("_", " "),
                        traverse=item.traverse,
                    )
                )
    if not names:
        return test
    lateral = None if miss.lateral_m is None else miss.lateral_m - float(taken[0])
    along = None if miss.longitudinal_m is None else miss.longitudinal_m - float(taken[1])
    left = closure_test(
        (lateral, along, miss.vertical_m), covariance3(mine), heights=heights_known(mine)
    )
    if not left.consistent:
        return test
    text = said(
        "The residuals name {names}, the survey holds what separates it, and "
        "without it the miss is what the declared errors make (chi-square "
        "{chi2:.2f}).",
        names=joined(", ", names),
        chi2=left.chi2,
    )
    return replace(test, verdict="explained", text=text)


def separated(heading: HeadingRows, effect: str) -> bool:
    """Whether a heading holds what tells an effect from its rivals."""
    gyro = [row for row in heading.rows if row.kind is RowKind.GYRO]
    if effect == "distance_scale":
        return True  # only lengths show it
    if effect == "gyro_constant_shift":
        return len({row.instrument for row in gyro}) > 1
    if effect == "lateral_refraction":
        ends = {(row.side, row.forward) for row in gyro}
        both = any((side, not forward) in ends for side, forward in ends)
        walls = set(heading.route.heading.wall_signs())
        return both or {1.0, -1.0} <= walls
    return False


def shifted_sides(
    effect: str, grid: Mapping[str, float], observed: Sequence[Observation]
) -> tuple[tuple[str, str, str], ...] | None:
    """Gyro sides from the first shifted one of its instrument on; None where none is named.

    The diagnosis numbers gyro sides instrument by instrument, in the order of the book.

    Parameters
    ----------
    effect : str
    grid : mapping
        What the diagnosis has scanned, with its ``first_side``.
    observed : sequence of Observation
        Gyro sides of the network, in its order.
    """
    first = grid.get("first_side")
    if effect != "gyro_constant_shift" or first is None:
        return None
    names = dict.fromkeys(row.constant for row in observed)
    ordered = [row for name in names for row in observed if row.constant == name]
    place = round(first) - 1
    if not 0 <= place < len(ordered):
        return None
    instrument = ordered[place].constant
    return tuple(
        (row.at, row.to, row.constant) for row in ordered[place:] if row.constant == instrument
    )


def _turned(heading: HeadingRows, effect: NamedEffect) -> Floats:
    """1 for each row of a heading that a shift of the constant has turned, else 0."""
    ends = heading.route.heading.sides

    def turned(row: Row) -> bool:
        if row.kind is not RowKind.GYRO or effect.sides is None:
            return row.kind is RowKind.GYRO
        at, to = ends[row.side] if row.forward else ends[row.side][::-1]
        return (at, to, row.instrument) in effect.sides

    return np.array([turned(row) for row in heading.rows], dtype=np.float64)


def movement(mine: Mine, number: int, effect: NamedEffect) -> Floats:
    """What an effect in one heading does to the miss: right and along [m]."""
    if effect.effect == "distance_scale":
        route = mine.routes[number]
        along = (route.length[:, None] * route.along).sum(axis=0) @ mine.axes
        return np.asarray(route.sign * effect.value * PPM * along, dtype=np.float64)
    rows, gain = mine.arrays, estimator(mine).gain
    own = rows.heading == number
    if effect.effect == "gyro_constant_shift":
        moved = _turned(mine.headings[number], effect) @ gain[own]
        return np.asarray(effect.value * ARCSEC * moved, dtype=np.float64)
    if effect.effect == "lateral_refraction":
        walled = mine if any(mine.plan.headings[number].wall_signs()) else one_wall(mine)
        refraction = walled.plan.refraction
        if refraction is None:
            return np.zeros(2)
        per_gradient = curvature_per_gradient(
            pressure_hpa=refraction.pressure_hpa, temperature_c=refraction.temperature_c
        )
        # a sight of 100 m leaves its chord by half the curvature times its length
        gradient = 2.0 * effect.value * ARCSEC / 100.0 / per_gradient
        bent = (gain * walled.arrays.refraction[:, None])[own].sum(axis=0)
        return np.asarray(gradient * bent, dtype=np.float64)
    return np.zeros(2)
