"""How good gyro north of one session must be: the wanted interval, from the session or a rule book.

A session's own ``wanted_interval_arcsec`` wins. Else the rule book tells, as far as it limits what
one determination enters: no rule book names the interval itself, so it is derived here, and what
it was derived from stays with it. No rule book, or one without such a limit: there is no target.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.tolerance import limits_for
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.rulebook import Limit, RuleBook
from surveyapp_models.angles import ARCSEC

WANTED_KEY: Final = "wanted_interval_arcsec"
"""Key of an [[orientation]] table: half-width of the 95 % interval of gyro north to stop at."""
SIGMA_SHARE: Final[tuple[tuple[str, float], ...]] = (
    ("rounds_difference", 1.0 / (2.0 * math.sqrt(2.0))),
    ("independent_mean_sigma", math.sqrt(2.0)),
)
"""Quantities that limit one determination, the nearest to it first, and its sigma as a share of
the limit: two rounds may differ by 2 sqrt(2) m, twice the sigma of a difference (physics.md 3.2;
Coal Mine Surveying Regulations 1989, Art. 62); the mean of two has m / sqrt(2)."""


@dataclass(frozen=True, slots=True)
class Target:
    """Half-width of the 95 % interval at which one determination is good enough.

    Parameters
    ----------
    interval95 : float
        [rad].
    origin : str
        ``session`` (its own wanted interval) or ``rule_book``.
    sigma : float or None
        Sigma of one determination that the rule book asks for [rad]; None from a session.
    book, rule, clause, quantity : str
        The limit that it is derived from: id of the rule book, id of the limit, its clause, its
        quantity; empty from a session.
    limit : float or None
        That limit [rad].
    confirmed : bool
        False: nobody has read the limit in a source.
    """

    interval95: float
    origin: Literal["session", "rule_book"]
    sigma: float | None = None
    book: str = ""
    rule: str = ""
    clause: str = ""
    quantity: str = ""
    limit: float | None = None
    confirmed: bool = True


def target_of(session: OrientationSession, book: RuleBook | None) -> Target | None:
    """The target of a session, None where neither it nor a rule book sets one.

    Parameters
    ----------
    session : OrientationSession
    book : RuleBook or None
        The project's.
    """
    value = dict(session.override).get(WANTED_KEY)
    if isinstance(value, int | float) and not isinstance(value, bool) and value > 0.0:
        return Target(float(value) * ARCSEC, "session")
    return None if book is None else _from_book(book)


def _from_book(book: RuleBook) -> Target | None:
    """The tightest limit of the first quantity that the book names."""
    for quantity, share in SIGMA_SHARE:
        limits = [
            (bound, limit)
            for limit, bound in limits_for(book, quantity, variables={"n": 2.0})
            if limit.sense == "at most" and bound > 0.0
        ]
        if limits:
            bound, limit = min(limits, key=lambda item: item[0])
            return _derived(book, limit, bound * ARCSEC, share)
    return None


def _derived(book: RuleBook, limit: Limit, bound: float, share: float) -> Target:
    sigma = bound * share
    return Target(
        interval95=student_quantile(0.975, math.inf) * sigma,
        origin="rule_book",
        sigma=sigma,
        book=book.id,
        rule=limit.id,
        clause=limit.clause,
        quantity=limit.quantity,
        limit=bound,
        confirmed=limit.confirmed,
    )
