"""A session that is being observed: its title, and what must be said when it is opened."""

from __future__ import annotations

from surveyapp.languages import translated
from surveyapp.observation.session import SessionDesk
from surveyapp.tui import texts


def session_title(observation: SessionDesk) -> str:
    """Project, session, method and line."""
    session = observation.session
    return texts.SESSION_TITLE.format(
        project=observation.project.name,
        session=session.id,
        method=translated(session.method),
        line=f"{session.station}-{session.target}" if session.target else session.station,
    )


def opening_warning(observation: SessionDesk) -> str:
    """A torn line, or a clock that went back; empty where all is well."""
    if observation.torn is not None:
        return texts.TORN.format(file=observation.torn)
    back = observation.clock.set_back_s
    return texts.CLOCK_BACK.format(seconds=back) if back else ""


def session_state(observation: SessionDesk) -> str:
    """Whether readings are written, or why not."""
    if observation.writable:
        return texts.WRITING
    return texts.CLOSED_SESSION if observation.closed else texts.READING_ONLY
