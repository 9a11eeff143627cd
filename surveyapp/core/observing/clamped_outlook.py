"""Gyro north of a clamped session now, and what two more points would make of its interval."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from surveyapp.core.observing.passage_forecast import PassageFit, first_side
from surveyapp.core.orientation.unfinished import lacking
from surveyapp.core.swing.card_physics import card_at
from surveyapp.core.swing.clamped_middle import MIN_FULL_FIT
from surveyapp.core.swing.clamped_north import reduce_nontracking
from surveyapp.core.swing.goodness import Judge
from surveyapp.core.swing.gyrofit import DampedFit, expected_weight_norm
from surveyapp.core.swing.swingfit import PARAMETERS, ClampedSwing, modelled, whitened_jacobian
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.errors import SurveyError

SWING_SOURCES = ("scale readings", "passages", "scale readings and passages")
"""Error sources of the swing itself; what remains is clamp, torsion ratio, tape zero."""


def north_now(
    session: OrientationSession,
    card: InstrumentCard,
    rng: np.random.Generator,
    latitude: float | None,
) -> tuple[Uncertain | None, str, str | None]:
    """Gyro north exactly as the reduction gives it; else why there is none; its sigma's source.

    The reason is empty where there are simply too few readings yet.

    ``latitude`` [rad].
    """
    try:
        reduction = reduce_nontracking(session, card, Judge(rng), latitude=latitude, estimator=None)
    except SurveyError as error:
        missing = "" if lacking(session) else error.problems[0].what
        return None, missing, None
    return reduction.north, "", reduction.sigma_source


def two_more(
    session: OrientationSession,
    card: InstrumentCard,
    *,
    latitude: float | None,
    north: Uncertain | None,
    swing: ClampedSwing,
    fit: DampedFit | None,
    passing: PassageFit | None,
    coming: tuple[int, int],
) -> float | None:
    """95 % half-width of north after two more points, if the readings stay as they are [rad].

    ``coming`` are the numbers of the next turning point and of the one before the next passage.

    Two more turning points (amplitude), or two more passages with the turning points between them
    (transit). The variance of unit weight is the one in force now; what the residuals told it with
    gains the new degrees of freedom.
    """
    ratio = card_at(card, latitude).torsion_ratio
    if north is None or ratio is None or card.scale_value is None:
        return None
    factor = (1.0 + ratio.value) * card.scale_value
    own = north.only(*SWING_SOURCES)
    if not math.isfinite(own.sigma):
        return None
    judged = math.isfinite(own.dof)
    if session.method == "transit":
        found = (
            None if passing is None else _after_passages(swing, passing, coming[1], judged=judged)
        )
    else:
        found = None if fit is None else _after_readings(swing, fit, card, coming[0], judged=judged)
    if found is None:
        return None
    sigma, dof = found
    part = Source(SWING_SOURCES[0], session.id, dof)
    wide = north.without(*SWING_SOURCES).with_part(part, factor * sigma).interval95
    return min(wide, north.interval95)  # as for tracked points: two more do no harm


def _after_readings(
    swing: ClampedSwing, fit: DampedFit, card: InstrumentCard, coming: int, *, judged: bool
) -> tuple[float, float] | None:
    """Sigma of the middle [div] and degrees of freedom with two more turning points."""
    sigma = math.sqrt(fit.variance) if judged and fit.variance else card.sigma.scale_div
    if sigma is None:
        return None
    start = first_side(swing)
    more = [float(coming), coming + 1.0]
    index = np.concatenate([swing.index, more])
    sides = np.concatenate([swing.sides, [_side(start, k) for k in more]])
    norm = expected_weight_norm(fit, index=index, sides=sides)
    if norm == 0.0:
        return None
    return norm * sigma, float(index.size - 3) if judged else math.inf


def _after_passages(
    swing: ClampedSwing, passing: PassageFit, coming: int, *, judged: bool
) -> tuple[float, float] | None:
    """The same with two more passages and the turning points that lie between them."""
    more = [float(coming), coming + 1.0]
    known = set(swing.index.tolist())
    turns = [k for k in more if k not in known]
    start = first_side(swing)
    longer = replace(
        swing,
        readings=np.zeros(swing.readings.size + len(turns)),
        index=np.concatenate([swing.index, turns]),
        sides=np.concatenate([swing.sides, [_side(start, k) for k in turns]]),
        passages_s=np.zeros(swing.passages_s.size + 2),
        divisions=np.concatenate([swing.divisions, [swing.divisions[-1]] * 2]),
        after=np.concatenate([swing.after, more]),
        first_side=start,
    )
    if longer.count < MIN_FULL_FIT or np.unique(longer.sides).size < 2:
        return None
    readings, times = modelled(longer, passing.parameters)
    longer = replace(longer, readings=readings, passages_s=times)
    inverse = np.linalg.pinv(whitened_jacobian(longer, passing.parameters))
    sigma = passing.unit * float(np.linalg.norm(inverse[0]))
    return sigma, float(longer.count - PARAMETERS) if judged else math.inf


def _side(start: float, index: float) -> float:
    return start * (1.0 if int(index) % 2 == 0 else -1.0)
