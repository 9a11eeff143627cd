"""What a session says while it is observed, by its method."""

from __future__ import annotations

import numpy as np

from surveyapp.core.observing.automatic_progress import automatic_progress
from surveyapp.core.observing.clamped_progress import clamped_progress
from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.tracking_progress import tracking_progress
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession


def progress_of(
    session: OrientationSession,
    card: InstrumentCard,
    rng: np.random.Generator,
    *,
    latitude: float | None,
) -> Progress:
    """Judge a session as it stands.

    Parameters
    ----------
    session : OrientationSession
    card : InstrumentCard
    rng : numpy.random.Generator
        For the null distributions of the tests.
    latitude : float or None
        [rad].
    """
    if session.method == "automatic":
        return automatic_progress(session, card, rng)
    judge = tracking_progress if session.method == "tracking" else clamped_progress
    return judge(session, card, rng, latitude=latitude)
