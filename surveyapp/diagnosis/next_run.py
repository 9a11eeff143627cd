"""What to observe next at a run: two more points, the other side, a run later, another observer.

The members of the average of a short run, weighed by the points that are there, say what each
action would read: what the instrument does recurs with the same coefficient, what happened once
does not recur (north stays where a step left it until the instrument is set up anew), what an
observer does is his own. Every such reading moves the weights and narrows north.

Source: prediction.md D with the members of B; Lindley, D. V. (1956), Ann. Math. Statist. 27, 986.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.candidates import single_effects
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.linear_outlook import State, counting, worth
from surveyapp.diagnosis.outlook import Outlook
from surveyapp.diagnosis.run_average import reading_noise
from surveyapp.diagnosis.run_rivals import SLIPS, RunAction, design_of, rivals_of
from surveyapp.languages import said

LEAST, MOST = 6, 60
"""Turning points of a run for which advice is given."""

RUN_ACTIONS = (
    RunAction("two_points", said("read two more turning points"), anew=False),
    RunAction(
        "reversed_start", said("observe a second run now, begun on the other side"), reversed=True
    ),
    RunAction("second_run", said("observe a second run in four hours, set up anew"), later=True),
    RunAction(
        "other_observer", said("let another observer do a second run now"), other_observer=True
    ),
)


def run_advice(case: Case, base: Fit, rng: np.random.Generator) -> Outlook | None:
    """What each action after a run would tell; None where there are too few points to say.

    Parameters
    ----------
    case : Case
        A swing.
    base : Fit
        Its base model.
    rng : numpy.random.Generator
    """
    if not case.has_swing or not LEAST <= case.size <= MOST or base.theta is None:
        return None
    noise, candidates = reading_noise(case, base), single_effects(case, base.theta)
    now: tuple[float, float] | None = None
    only: dict[str, NDArray[np.intp]] | None = None
    results = []
    for action in RUN_ACTIONS:
        design = design_of(case, base, action)
        # the run weighs the members before any action: later actions need those that count only
        groups = rivals_of(case, candidates, (design, action), only=only)
        y = base.residual / noise[0]
        state = State.of(y, design.rows, groups, noise[1], quiet=SLIPS, stands=now)
        now, only = state.stands, only or counting(state)
        results.append(worth(state, (action.id, action.text), rng, sigma=noise[0]))
    results.sort(key=lambda item: (-item.information, item.interval95))
    assert now is not None
    return Outlook(now[0], now[1] * noise[0], tuple(results), said("north at"))


__all__ = ["RUN_ACTIONS", "RunAction", "run_advice"]
