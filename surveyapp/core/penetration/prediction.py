"""From a mine to its prediction: budget, tolerance, verdict. Plans and simulations are added."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from surveyapp.core.penetration.allowed import factor_of, judge, tolerance_of
from surveyapp.core.penetration.covariance import (
    Contribution,
    contributions,
    heights_known,
    total,
)
from surveyapp.core.penetration.evaluation import evaluate_miss
from surveyapp.core.penetration.mine import Mine
from surveyapp.core.penetration.rows import RowKind
from surveyapp.core.penetration.sections import sectioned
from surveyapp.domain.penetration_result import (
    MeetingEllipse,
    MineDrawing,
    MissCause,
    MissSigma,
    Prediction,
)
from surveyapp.domain.rulebook import RuleBook
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import TWO_PI
from surveyapp_models.arrays import Floats


def budget(parts: Sequence[Contribution]) -> tuple[MissCause, ...]:
    """Rows of the budget; they add in squares to the total."""
    return tuple(MissCause(part.source, part.heading, *part.sigmas) for part in parts)


def miss_sigma(mine: Mine, parts: tuple[Contribution, ...]) -> MissSigma:
    """1 sigma of the miss by covariance."""
    plane, vertical = total(parts)
    return MissSigma(
        math.sqrt(float(plane[0, 0])),
        math.sqrt(float(plane[1, 1])),
        math.sqrt(vertical) if heights_known(mine) else None,
    )


def ellipse(mine: Mine, plane: Floats) -> MeetingEllipse:
    """Standard ellipse of the miss; its azimuth is that of the longer half axis, in [0, pi)."""
    values, vectors = np.linalg.eigh(mine.axes @ plane @ mine.axes.T)
    longer = vectors[:, 1]
    azimuth = math.atan2(float(longer[0]), float(longer[1])) % math.pi
    a, b = (math.sqrt(max(float(value), 0.0)) for value in values[::-1])
    return MeetingEllipse(a, b, azimuth % TWO_PI)


def drive_length_km(mine: Mine) -> float:
    """Length of all headings together [km]."""
    return sum(float(route.reach.sum()) for route in mine.routes) / 1000.0


def prediction(
    mine: Mine,
    book: RuleBook | None,
    *,
    project: str,
    software: str,
    digest: str,
    warnings: Sequence[ResultWarning] = (),
) -> Prediction:
    """Predict the miss by covariance and by sections, and compare it with what is allowed."""
    parts = contributions(mine)
    sigma = miss_sigma(mine, parts)
    factor, source, told = factor_of(mine.plan, book)
    tolerance, more = tolerance_of(mine.plan, book, drive_length_km(mine))
    passed, failed, open_ones = judge(sigma, factor, tolerance)
    miss = mine.plan.measured
    own = [*warnings, *told, *more, *open_ones, *_not_stated(mine)]
    return Prediction(
        project=project,
        software=software,
        input_sha256=digest,
        sigma=sigma,
        factor=factor,
        factor_source=source,
        tolerance=tolerance,
        passed=passed,
        failed_confirmed=failed,
        sectioned=sectioned(mine, parts),
        simulated=None,
        budget=budget(parts),
        ellipse=ellipse(mine, total(parts)[0]),
        measured=None if miss is None else evaluate_miss(mine, miss),
        steps=mine.plan.steps,
        warnings=tuple(own),
        drawing=drawing(mine),
    )


def drawing(mine: Mine) -> MineDrawing:
    """What a plan of the mine shows."""
    routes, gyro = [], []
    for heading in mine.headings:
        places = list(zip(heading.route.e.tolist(), heading.route.n.tolist(), strict=True))
        sides = {row.side for row in heading.rows if row.kind is RowKind.GYRO}
        gyro += [(places[side], places[side + 1]) for side in sorted(sides)]
        ahead = heading.route.carried_m * heading.route.along[-1]
        if heading.route.carried_m > 0.0:
            e, n = places[-1]
            places.append((e + float(ahead[0]), n + float(ahead[1])))
        routes.append(tuple(places))
    meeting = (mine.plan.meeting.e, mine.plan.meeting.n)
    names = tuple(heading.name for heading in mine.plan.headings)
    return MineDrawing(names, tuple(routes), tuple(gyro), meeting, mine.plan.axis_azimuth)


def _not_stated(mine: Mine) -> list[ResultWarning]:
    """What the prediction takes for free of error because nobody says otherwise."""
    found = []
    if not any(float(np.max(heading.length_sigma)) > 0.0 for heading in mine.headings):
        text = said("no sigma of distances is stated: lengths count as free of error")
        found.append(ResultWarning("sigma_distance_unknown", text))
    if not heights_known(mine):
        text = said("height = { method = ... } is not stated: the vertical error is not determined")
        found.append(ResultWarning("height_unknown", text))
    walls = any(any(heading.wall_signs()) for heading in mine.plan.headings)
    if mine.plan.refraction is not None and not walls:
        text = said("gradients are stated and no heading says along which wall: they count nothing")
        found.append(ResultWarning("walls_unknown", text))
    return found
