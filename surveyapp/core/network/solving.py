"""From a compiled network to its least-squares solution, where there are two to the right one.

Starting values come from the given coordinates or, failing those, are found afresh. A resection or
an intersection of distances may have a mirror image that serves as well as a start: each is
adjusted, the smaller v'Pv is taken, and where the observations do not decide both are told.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from surveyapp.core.network.approximate import approximate, approximations
from surveyapp.core.network.gaussnewton import Converged, NotConverged, iterate, refuse
from surveyapp.core.network.model import Model
from surveyapp.core.network.undetermined import refuse_undetermined
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.traverse import Network, Status
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import joined, said
from surveyapp_models.arrays import Floats

_IN_THE_PLANE = frozenset(
    {
        ObservationKind.DIRECTION,
        ObservationKind.ANGLE,
        ObservationKind.AZIMUTH,
        ObservationKind.GYRO,
        ObservationKind.DISTANCE,
    }
)
DECIDED = 10.83
"""Difference of v'Pv from which the worse of two solutions is refuted (chi-square, 0.1 %)."""
MOST_TRIALS = 16
SAME_M = 1e-3
"""Solutions nearer than this are one."""
MOST_POINTS = 400
"""In larger networks a second solution is a matter of given coordinates, not of trials."""


@dataclass(frozen=True, slots=True)
class Solution:
    """The solution taken and another one that the observations do not refute."""

    state: Converged
    other: Converged | None = None


def solve_network(network: Network, model: Model) -> Converged:
    """Iterate from the given, then if need be from freshly found approximate coordinates.

    Raises
    ------
    SurveyError
        No approximate coordinates, no convergence, undetermined points (named).
    """
    return solutions(network, model).state


def solutions(network: Network, model: Model) -> Solution:
    """The best solution of a network, and its mirror image if nothing decides against it."""
    refuse_coincident(network, model)
    names = tuple(point.name for point in network.points)
    starts = approximations(network, model)
    first = next(starts)
    try:
        states = [iterate(model, first)]
    except NotConverged as failure:
        states = _converged(model, _few(network, starts))
        if not states:
            try:
                states = [iterate(model, approximate(network, model, fresh=True))]
            except (NotConverged, SurveyError):
                raise refuse(names, failure) from None
    else:
        states += _converged(model, _few(network, starts))
    undetermined = [state for state in states if len(state.solved.undetermined)]
    if len(undetermined) == len(states):
        raise refuse_undetermined(network, states[0])
    states = [state for state in states if not len(state.solved.undetermined)]
    best = min(states, key=lambda state: state.sum_of_squares)
    return Solution(best, _rival(network, best, states))


def refuse_coincident(network: Network, model: Model) -> None:
    """Refuse sights in the plane between two fixed points at one place: they have no direction.

    Raises
    ------
    SurveyError
        Naming every such pair.
    """
    fixed = {
        p.name: (p.e, p.n)
        for p in network.points
        if p.status_e is Status.FIXED and p.status_n is Status.FIXED
    }
    found: dict[frozenset[str], str] = {}
    for obs in model.observations:
        if obs.kind not in _IN_THE_PLANE:
            continue
        for name in (obs.to, obs.back):
            here, there = fixed.get(obs.at), fixed.get(name)
            if here is None or there is None or None in (*here, *there):
                continue
            gap = abs(complex(*there) - complex(*here))  # type: ignore[arg-type]
            if gap < SAME_M:
                found.setdefault(frozenset((obs.at, name)), obs.where)
    if found:
        raise SurveyError(
            [
                Problem(
                    "Two stations at one place are sighted from each other",
                    where,
                    " and ".join(sorted(pair)),
                    "points that lie apart",
                    "Is one of them mistyped, or the same point under two names?",
                )
                for pair, where in found.items()
            ]
        )


def _few(network: Network, starts: Iterable[Floats]) -> list[Floats]:
    """Further starts, if the network is small enough to try them."""
    if len(network.points) > MOST_POINTS:
        return []
    found = []
    try:
        for start in starts:
            found.append(start)
            if len(found) >= MOST_TRIALS:
                break
    except SurveyError:  # a further way that leads nowhere
        return found
    return found


def _converged(model: Model, starts: Iterable[Floats]) -> list[Converged]:
    states = []
    for start in starts:
        try:
            states.append(iterate(model, start))
        except NotConverged:
            continue
    return states


def _coordinates(network: Network, state: Converged) -> Floats:
    return state.values[: 3 * len(network.points)].reshape(-1, 3)


def _rival(network: Network, best: Converged, states: list[Converged]) -> Converged | None:
    here = _coordinates(network, best)
    rivals = [
        state
        for state in states
        if float(np.nanmax(np.abs(_coordinates(network, state) - here))) > SAME_M
        and state.sum_of_squares - best.sum_of_squares < DECIDED
    ]
    return min(rivals, key=lambda state: state.sum_of_squares) if rivals else None


def mirror_warning(network: Network, found: Solution) -> list[ResultWarning]:
    """What is told where two solutions serve alike."""
    if found.other is None:
        return []
    here, there = (_coordinates(network, state) for state in (found.state, found.other))
    moved = np.flatnonzero(np.nan_to_num(np.abs(there - here)).max(axis=1) > SAME_M)
    places = []
    for i in moved[:6].tolist():
        e, n, h = there[i].tolist()
        height = "" if np.isnan(h) or abs(h - here[i, 2]) < SAME_M else f", h {h:.3f}"
        places.append(f"{network.points[i].name} at e {e:.3f}, n {n:.3f}{height}")
    more = said(" and {number} more points", number=len(moved) - 6) if len(moved) > 6 else ""
    text = said(
        "a second solution serves as well (v'Pv {sum_of_squares:.4g} against "
        "{sum_of_squares2:.4g}): {places}{more}. Give approximate coordinates, or "
        "another observation, to decide",
        sum_of_squares=found.other.sum_of_squares,
        sum_of_squares2=found.state.sum_of_squares,
        places=joined("; ", places),
        more=more,
    )
    return [ResultWarning("mirror_solution", text)]
