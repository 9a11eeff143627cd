"""Gauss-Newton iteration of a compiled network, with control of its convergence.

Whatever does not converge is an error with the point that still moves, never a result.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surveyapp.core.leastsquares.equations import ElementGroup
from surveyapp.core.leastsquares.solution import DENSE_UNKNOWNS, Solved, solve
from surveyapp.core.leastsquares.symbolic import Plan, make_plan
from surveyapp.core.network.angle_pairs import with_orientations
from surveyapp.core.network.model import Model
from surveyapp.core.network.observation_equations import equations, linearised, misclosures
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

MOST_ITERATIONS = 60
STEP_TOLERANCE = 1e-5
"""Converged when the step is below this in sigmas of any function of the unknowns."""
ROUNDING = 1e-6
"""Rounding of one whitened observation; grows with the root of the number of unknowns."""
NOISE = 0.1
"""Growth of the sum of squares per observation that does not stop a step: far below its own
expectation of 1. In long loops the curvature of a first step costs as much, and the next repays."""
HALVINGS = 12
"""Step halvings before an iteration gives up: 2**-12 of a step is no step."""


class NotConverged(Exception):  # noqa: N818  (an outcome that the caller may answer with new starts)
    """The iteration did not settle; carries what moved last."""

    def __init__(self, model: Model, step: Floats) -> None:
        super().__init__()
        self.model = model
        self.step = step


@dataclass(frozen=True, slots=True)
class Converged:
    """State after the last iteration.

    Parameters
    ----------
    model : Model
        The network as it was solved: large ones have their angles as pairs of directions.
    values : float array
        All slots of the network (first) and of auxiliary orientations.
    groups : tuple of ElementGroup
        Equations of ``model`` at ``values``; their misclosures are minus the whitened residuals.
    solved : Solved
        Of the last step; cofactors belong to the last linearisation.
    misclosure : float array
        Observed minus adjusted of the network's own observations, shape (rows,).
    sum_of_squares : float
        Of the whitened residuals.
    iterations : int
    """

    model: Model
    values: Floats
    groups: tuple[ElementGroup, ...]
    solved: Solved
    misclosure: Floats
    sum_of_squares: float
    iterations: int


def _whitened(model: Model, values: Floats) -> tuple[tuple[ElementGroup, ...], int, float]:
    """Equations, number of rows and sum of squares."""
    computed, partials = linearised(model, values)
    misclosure = misclosures(model, computed)
    groups = equations(model, partials, misclosure)
    total = sum(float(np.einsum("nk,nk->", g.misclosure, g.misclosure)) for g in groups)
    return groups, sum(g.rows.size for g in groups), total


def _moved(model: Model, values: Floats, step: Floats, factor: float) -> Floats:
    moved = values.copy()
    moved[model.slot_of] += factor * step
    return moved


def iterate(model: Model, start: Floats, *, plan: Plan | None = None) -> Converged:
    """Iterate to the least-squares solution.

    Parameters
    ----------
    model : Model
    start : float array
        Starting values of all slots.
    plan : Plan, optional
        Symbolic factorisation of an earlier iteration of the same network.

    Returns
    -------
    Converged
        ``solved.undetermined`` may name unknowns: then nothing was iterated.

    Raises
    ------
    NotConverged
    """
    small = model.structure.count <= DENSE_UNKNOWNS
    work, values = (model, start) if small else with_orientations(model, start)
    origin = values
    groups, _, total = _whitened(work, values)
    if plan is None and not small:
        plan = make_plan(groups, work.structure)
    step = np.zeros(work.structure.count)
    for iteration in range(1, MOST_ITERATIONS + 1):
        offset = (values - origin)[work.slot_of]
        solved = solve(groups, work.structure, work.datum_unknowns, offset=offset, plan=plan)
        step = solved.correction
        if len(solved.undetermined):
            return _state(model, work, values, (solved, iteration))
        if not np.isfinite(step).all():
            break
        values, groups, total, factor = _search(work, values, step, total)
        limit = STEP_TOLERANCE + ROUNDING * math.sqrt(work.structure.count)
        if factor == 1.0 and math.sqrt(max(solved.decrease, 0.0)) <= limit:
            return _state(model, work, values, (solved, iteration))
        if factor == 0.0:
            break
    raise NotConverged(work, step)


def _state(model: Model, work: Model, values: Floats, outcome: tuple[Solved, int]) -> Converged:
    """Equations at the solution, and misclosures of the network's own observations."""
    solved, iterations = outcome
    computed, _ = linearised(model, values[: len(model.unknown_of) - 1])
    groups, _, total = _whitened(work, values)
    return Converged(work, values, groups, solved, misclosures(model, computed), total, iterations)


def _search(
    model: Model, values: Floats, step: Floats, total: float
) -> tuple[Floats, tuple[ElementGroup, ...], float, float]:
    """Take the step, halved until the sum of squares does not grow."""
    factor = 1.0
    for _ in range(HALVINGS):
        moved = _moved(model, values, step, factor)
        groups, rows, new = _whitened(model, moved)
        if math.isfinite(new) and new <= total + NOISE * rows:
            return moved, groups, new, factor
        factor /= 2.0
    return moved, groups, new, 0.0


class UnsettledError(SurveyError):
    """An adjustment that does not converge: often one observation is grossly wrong."""


def refuse(network_points: tuple[str, ...], failure: NotConverged) -> UnsettledError:
    """Error for an iteration that did not settle, naming what moved most."""
    model = failure.model
    coordinates = model.slot_of < model.coordinate_slots
    step = np.where(coordinates & np.isfinite(failure.step), np.abs(failure.step), 0.0)
    worst = int(np.argmax(step))
    name = network_points[model.slot_of[worst] // 3] if coordinates[worst] else "-"
    return UnsettledError(
        Problem(
            "The adjustment does not converge",
            said("point {name}", name=name),
            said("a last step of {step:.3g} m", step=step[worst]),
            "steps that shrink",
            "Look for a gross error or a mistyped point near this point, in coordinates or "
            "observations; an ill-determined point behaves so too.",
        )
    )
