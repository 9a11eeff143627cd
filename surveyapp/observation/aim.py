"""What a session is observed for."""

from __future__ import annotations

from dataclasses import dataclass

from surveyapp.core.observing.target import Target


@dataclass(frozen=True, slots=True)
class Aim:
    """What a session is observed for.

    Parameters
    ----------
    target : Target or None
    book : str
        Id of the project's rule book, empty without one: tells why there is no target.
    problem : str
        Why the rule book cannot be used, empty if it can.
    """

    target: Target | None
    book: str = ""
    problem: str = ""
