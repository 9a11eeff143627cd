"""Rough north before the observation: two turning points, or the quarter of a period.

Good for setting the alidade, never for an azimuth: damping and follow-up stay in it. What is
enough: within 60' before tracking, within 10' before the transit method (coal-mine surveying
regulation, article 63).

Source: physics.md 2.6.
"""

from __future__ import annotations

import math

from surveyapp.core.swing.reduction import Reduction
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import ReadingKind
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi

TYPICAL_LOSS = 0.02
"""Share of the amplitude lost in one half swing that is reckoned with (physics.md 2.3: q = .98)."""


def two_turning_points(
    first: float, second: float, *, session: str, reading_sigma: float = 0.0
) -> Uncertain:
    """North from the mean of two turning points [rad].

    The mean is off by A (1 - q) / 2 towards the first point; with q unknown that is not corrected
    but stands in the sigma, at the typical loss.

    Parameters
    ----------
    first, second : float
        Turning points on the two sides [rad], unwrapped.
    session : str
    reading_sigma : float
        Of one turning point [rad].
    """
    amplitude = 0.5 * abs(second - first)
    return Uncertain(
        0.5 * (first + second),
        {
            Source("unknown damping", session): 0.5 * TYPICAL_LOSS * amplitude,
            Source("turning points", session): reading_sigma / math.sqrt(2.0),
        },
    )


def pre_orientation(session: OrientationSession, card: InstrumentCard) -> Reduction:
    """Reduce a session of two turning points: good for setting the alidade, and labelled so."""
    rows = session.book.of_kind(ReadingKind.REVERSAL)
    first, second = (row.value or 0.0 for row in rows)
    second = first + wrap_pi(second - first)
    sigma = card.sigma.reversal or 0.0
    north = two_turning_points(first, second, session=session.id, reading_sigma=sigma)
    text = said(
        "session {id}: two turning points give a pre-orientation, no azimuth: the "
        "damping of the swing stays in it",
        id=session.id,
    )
    return Reduction(
        estimator=said("two turning points"),
        north=north,
        points_used=2,
        sigma_source="card",
        amplitude=0.5 * abs(second - first),
        warnings=(ResultWarning("pre_orientation", text),),
    )
