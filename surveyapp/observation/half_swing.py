"""What the card tells of the swing at a station, for doubts about the moments that are typed."""

from __future__ import annotations

from surveyapp.domain.project import OrientationSession, Project
from surveyapp.errors import SurveyError


def half_swing_of(project: Project, session: OrientationSession) -> float | None:
    """Half swing of a session's instrument at its station [s], None where its card tells none."""
    from surveyapp.core.geodesy import grid_of, position_of
    from surveyapp.core.swing.card_physics import card_at

    try:
        latitude = position_of(project.station(session.station), grid_of(project)).latitude
    except SurveyError:
        latitude = None
    here = card_at(project.instrument(session.instrument).card, latitude)
    period = here.tracking_s if session.method == "tracking" else here.clamped_s
    return None if period is None else 0.5 * period.value
