"""What the session screen tells the application."""

from __future__ import annotations

from textual.message import Message

from surveyapp.tui.entry_desk import Pending


class SessionLeft(Message):
    """A session is left; what was half typed goes with it."""

    def __init__(self, session: str, draft: Pending | None) -> None:
        super().__init__()
        self.session = session
        self.draft = draft


class ResultWanted(Message):
    """The result of a session is to be shown."""

    def __init__(self, session: str) -> None:
        super().__init__()
        self.session = session
