"""What to observe next at a record of any subject, and at a traverse: actions as further rows.

The base model and every named effect at each of its grid points, in three sizes, are weighed by the
record as it stands. An action adds rows: what the base model and each effect do there follows from
the columns of these rows. A slip does not recur.

Source: prediction.md D with the prior of B.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.diagnosis.action import (
    POSITION,
    Action,
    Kept,
    Linear,
    Plan,
    Planner,
    Point,
    completed,
)
from surveyapp.diagnosis.candidates import Candidate, single_effects
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.linear_outlook import (
    LEAST_WEIGHT,
    Rival,
    State,
    joined_rivals,
    weighed,
    worth,
)
from surveyapp.diagnosis.outlook import ActionResult, Outlook
from surveyapp.diagnosis.run_average import BASE_PRIOR, GROSS_SIZES, OTHER_SHARE, SHARES, SIZES
from surveyapp.domain.priors import NU0
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Effect

MOST_ROWS = 400
"""Observations up to which actions are weighed."""
SAME_INFORMATION = 0.05
"""[nat]"""


def rows_advice(case: Case, rng: np.random.Generator) -> Outlook | None:
    """What each action at a record would tell; None where nothing can be said.

    Parameters
    ----------
    case : Case
        With a ``planner``, or with ``actions`` and the base design of other rows.
    rng : numpy.random.Generator
    """
    if case.size > MOST_ROWS:
        return None
    planner = case.planner() if case.planner is not None else _by_columns(case)
    if planner is None:
        return None
    nu0 = 0.0 if case.sigma is None else NU0
    kept = weighed_members(case, planner, nu0)
    seed = int(rng.integers(2**31))
    stands: tuple[float, float] | None = None
    best: dict[str, ActionResult] = {}
    for plan in planner.plans(kept):
        state = State.of(plan.y, plan.rows, _rivals(plan, kept), nu0, stands=stands)
        stands = state.stands
        # the same draws for all, so that chance does not rank them
        found = worth(state, (plan.id, plan.text), np.random.default_rng(seed), sigma=planner.sigma)
        if plan.id not in best or _order(found) < _order(best[plan.id]):
            best[plan.id] = found
    if stands is None:
        return None
    results = tuple(
        replace(item, unit=planner.unit, own_scale=planner.scale)
        for item in sorted(best.values(), key=_order)
    )
    return Outlook(
        stands[0],
        stands[1] * planner.sigma,
        results,
        planner.wanted_name,
        unit=planner.unit,
        scale=planner.scale,
    )


def _order(item: ActionResult) -> tuple[float, float]:
    """Most information first; where it is the same within the draws, the narrowest interval."""
    return -int(item.information / SAME_INFORMATION), item.interval95


def weighed_members(case: Case, planner: Planner, nu0: float) -> list[Kept]:
    """The members that count after the record, each with its weight."""
    names: list[tuple[str, Effect, Point, Floats, float]] = []
    columns: list[Floats] = []
    candidates = [c for c in single_effects(case, None) if c.points and c.effect is not None]
    total = sum(SHARES.get(c.id, OTHER_SHARE) for c in candidates)
    for candidate in candidates:
        effect = candidate.effect
        assert effect is not None
        share = (1.0 - BASE_PRIOR) * SHARES.get(candidate.id, OTHER_SHARE) / total
        sizes = GROSS_SIZES if candidate.is_slip else SIZES
        prior = math.log(share / len(sizes) / len(candidate.points))
        for point in candidate.points:
            x = planner.columns(effect, point)
            largest = planner.largest(effect, point)
            if not largest > 0.0:
                continue
            for size in sizes:
                scale = np.full(x.shape[1], size / largest)
                names.append((_unit(case, candidate, point), effect, point, scale, prior))
                columns.append(x * scale)
    found = [Kept("base", None, {}, np.zeros(1), math.log(BASE_PRIOR), 1.0, np.zeros(1))]
    base = np.zeros((planner.y.size, 1))
    for width in sorted({x.shape[1] for x in columns}):
        own = [i for i, x in enumerate(columns) if x.shape[1] == width]
        # the base beside them, so that weights of all widths compare
        stack = np.stack([np.tile(base, width), *(columns[i] for i in own)])
        prior_of = np.array([math.log(BASE_PRIOR), *(names[i][4] for i in own)])
        nothing = np.zeros((len(stack), width))
        group = Rival(("",) * len(stack), np.arange(len(stack)), prior_of, stack, nothing, nothing)
        weights, means = weighed(planner.y, planner.flat, group, nu0)
        relative = weights / max(float(weights[0]), 1e-300)
        for place, i in enumerate(own, start=1):
            unit, effect, point, scale, prior = names[i]
            found.append(
                Kept(unit, effect, point, scale, prior, float(relative[place]), means[place])
            )
    top = max(item.weight for item in found)
    return [item for item in found if item.weight > LEAST_WEIGHT * top]


def _unit(case: Case, candidate: Candidate, point: Point) -> str:
    """Cause of a member: which observation slipped and which station stood off are causes apart."""
    named = [str(value) for name, value in point.items() if name in case.grid_labels]
    apart = candidate.effect is not None and candidate.effect.event and named
    return f"{candidate.id} {' '.join(named)}" if apart else candidate.id


def _rivals(plan: Plan, kept: Sequence[Kept]) -> list[Rival]:
    found = []
    for item, columns, adds in zip(kept, plan.columns, plan.adds, strict=True):
        own = (adds * item.scale)[None]
        x = (columns * item.scale)[None]
        prior = np.array([item.log_prior])
        found.append(Rival((item.unit,), np.zeros(1, dtype=np.intp), prior, x, own, own))
    return joined_rivals(found)


@dataclass(frozen=True, slots=True)
class _Columns:
    """A planner of a record whose actions are columns of further rows."""

    case: Case
    actions: tuple[tuple[Action, Mapping[str, Floats]], ...]
    y: Floats
    flat: Floats
    root: Floats
    wanted_name: str
    unit: str
    scale: float
    sigma: float

    def columns(self, effect: Effect, point: Point, /) -> Floats:
        """Columns of an effect in the record."""
        return np.asarray(self.root[:, None] * effect.basis(self.case.columns, **point))

    def largest(self, effect: Effect, point: Point, /) -> float:
        """The largest entry of its columns."""
        return float(np.abs(self.columns(effect, point)).max())

    def plans(self, kept: Sequence[Kept], /) -> list[Plan]:
        """Every feasible action."""
        return [self._plan(action, rows, kept) for action, rows in self.actions]

    def _plan(self, action: Action, rows: Mapping[str, Floats], kept: Sequence[Kept]) -> Plan:
        case, n = self.case, self.case.size
        more = {name: np.concatenate([values, rows[name]]) for name, values in case.columns.items()}
        count = next(iter(rows.values())).size
        root = np.concatenate([self.root, np.full(count, self.root[-1])])
        assert case.base_of is not None
        flat = root[:, None] * case.base_of(more)
        columns, adds = [], []
        for item in kept:
            if item.effect is None:
                x = np.zeros((n + count, 1))
            else:
                x = root[:, None] * item.effect.basis(more, **item.point)
                if item.effect.acts_on == "observation":
                    x[n:] = 0.0
            columns.append(x)
            raw = x[:n] / self.root[:, None]
            adds.append(case.value_weights @ raw)
        wanted = case.value_base / self.sigma
        scaled = tuple(value / self.sigma for value in adds)
        return Plan(action.id, action.text, self.y, Linear(flat, n, wanted), tuple(columns), scaled)


def _by_columns(case: Case) -> _Columns | None:
    if not case.actions or case.base_of is None or not case.columns:
        return None
    here = {name: np.asarray(values) for name, values in case.columns.items()}
    here[POSITION] = case.position
    found = [(a, completed(here, rows)) for a in case.actions if (rows := a.rows(here)) is not None]
    base = case.base
    free = case.size - base.shape[1]
    if not found or free < 1 or np.linalg.matrix_rank(base) < base.shape[1]:
        return None
    solution = np.linalg.lstsq(base, case.observations, rcond=None)[0]
    residual = case.observations - base @ solution
    if case.sigma is None:
        scatter = float(np.sqrt(residual @ residual / free))
        sigma = np.full(case.size, max(scatter, case.noise_floor, 1e-300))
    else:
        sigma = case.sigma
    unit = float(np.median(sigma))
    return _Columns(
        case=case,
        actions=tuple(found),
        y=residual / sigma,
        flat=base / sigma[:, None],
        root=1.0 / sigma,
        wanted_name=said("{value_name} at", value_name=case.value_name),
        unit="",
        scale=case.scale,
        sigma=unit,
    )
