"""Rule books: named limits with clause and source, as an office files them and may edit them.

A limit is a number or a short formula of n (a count) and L (a length in kilometres). What a limit
is compared with is named by its quantity; who measures that quantity is no business of this module.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Sense = Literal["at most", "at least"]


@dataclass(frozen=True, slots=True)
class Limit:
    """One limit of a rule book.

    Parameters
    ----------
    id : str
        Unique in its book.
    quantity : str
        What is compared, an id of ``surveyapp.core.tolerance.QUANTITIES``.
    limit : float or str
        A number, or a formula of n and L.
    unit : str
        Unit of the limit; the quantity is measured in it.
    class_name : str
        The rule book's own word for the class of survey to which it applies; empty: to all.
    clause : str
    source : str
    confirmed : bool
        False: nobody here has read it in a source; it only warns.
    sense : str
        ``at most`` or ``at least``.
    when : str
        Condition on n and L, empty: always.
    note : str
    """

    id: str
    quantity: str
    limit: float | str
    unit: str
    class_name: str
    clause: str
    source: str
    confirmed: bool
    sense: Sense = "at most"
    when: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True)
class RuleBook:
    """A rule book.

    Parameters
    ----------
    id, title, source : str
    limits : tuple of Limit
    note : str
    station_sigma_m : float or None
        Standard deviation of a station's coordinates where the project states none [m].
    """

    id: str
    title: str
    source: str
    limits: tuple[Limit, ...]
    note: str = ""
    station_sigma_m: float | None = None
