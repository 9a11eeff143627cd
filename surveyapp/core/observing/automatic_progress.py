"""An automatic session while it is observed: interval now and later, and a round that stands out.

Nothing swings on the screen of an automatic gyro: there is no forecast and no countdown.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from surveyapp.core.observing.progress import Point, Progress
from surveyapp.core.observing.run_alert import Alert, Trouble, search
from surveyapp.core.orientation.unfinished import lacking
from surveyapp.core.swing.automatic import reduce_automatic, stated_rounds, stated_sigma
from surveyapp.core.swing.reduction import Reduction
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.errors import SurveyError
from surveyapp_models.angles import wrap_pi, wrap_two_pi
from surveyapp_models.arrays import Floats

MIN_ROUNDS: Final = 4
"""A mean and one round that is left out leave two degrees of freedom."""
SOURCE: Final = "rounds"


def automatic_progress(
    session: OrientationSession, card: InstrumentCard, rng: np.random.Generator
) -> Progress:
    """Judge the rounds of an automatic gyro as they stand.

    Parameters
    ----------
    session : OrientationSession
    card : InstrumentCard
    rng : numpy.random.Generator
        For the null distribution of the alarm.
    """
    try:
        reduction = reduce_automatic(session, card)
    except SurveyError as error:
        return Progress(missing="" if lacking(session) else error.problems[0].what)
    value = reduction.azimuth if reduction.azimuth is not None else reduction.north
    if value is None:
        return Progress()
    origin = reduction.points[0].observed
    residuals = np.array([point.residual or 0.0 for point in reduction.points])
    return Progress(
        points=tuple(
            Point(
                point.seq,
                point.index,
                "",
                point.observed,
                wrap_pi(point.observed - origin),
                point.residual if len(residuals) > 1 else None,
            )
            for point in reduction.points
        ),
        origin=origin,
        north=wrap_two_pi(value.value),
        delivered=reduction.azimuth is not None,
        interval95=value.interval95 if math.isfinite(value.sigma) else None,
        interval95_two_more=_two_more(session, reduction, value),
        sigma_source=reduction.sigma_source,
        alert=_alert(reduction, residuals, rng),
    )


def _two_more(session: OrientationSession, reduction: Reduction, value: Uncertain) -> float | None:
    """95 % half-width after two more rounds, if their scatter stays as it is."""
    if reduction.reading_sigma is None or stated_sigma(session) is not None:
        return None
    rounds = (stated_rounds(session) or len(reduction.points)) + 2
    judged = reduction.sigma_source == "residuals"
    dof = float(len(reduction.points) + 1) if judged else math.inf
    sigma = reduction.reading_sigma / math.sqrt(rounds)
    found = value.without(SOURCE).with_part(Source(SOURCE, session.id, dof), sigma).interval95
    return min(found, value.interval95)  # as for tracked points: more rounds do no harm


def _alert(reduction: Reduction, residuals: Floats, rng: np.random.Generator) -> Alert | None:
    """The round that stands out most, if chance does not explain it."""
    if residuals.size < MIN_ROUNDS:
        return None
    names = [(Trouble.GROSS_ERROR, place) for place in range(residuals.size)]
    basis = np.ones((residuals.size, 1))
    found = search(residuals, basis, (np.eye(residuals.size), names))
    if found is None:
        return None
    trouble, place, p, share = found
    return Alert(trouble, reduction.points[place].seq, place, p, share)
