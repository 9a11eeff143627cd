"""What a run may hide, carried on to what is observed next: members of the average of its actions.

What the instrument does recurs with the same coefficient, what happened once does not; north stays
where a step left it until the instrument is set up anew; what an observer does is his own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.action import Linear
from surveyapp.diagnosis.candidates import Candidate, swing_columns
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.linear_outlook import Rival, joined_rivals
from surveyapp.diagnosis.run_average import (
    BASE_PRIOR,
    CORRELATIONS,
    GROSS_SIZES,
    MOST_UNNAMED,
    OTHER_SHARE,
    SHARES,
    SIZES,
    correlated_roots,
)
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Columns, Effect

MOST_FOR_PAIRS = 16
"""Points up to which two slips and two shifts are members: their number grows with the square."""
MOST_POINTS = 80
"""Grid points of an effect that are members; of a longer grid every second or third."""
GAP_HALF_SWINGS = 6.0
"""Between two runs that follow each other: clamping, sights, a new start."""
OF_OBSERVER = frozenset({"dry_friction"})
"""Laws of the amplitude that the following of an observer makes too."""
SLIPS = frozenset({"gross_error", "two gross errors"})
Places = NDArray[np.intp]
Moves = tuple[str, Floats, Floats]
"""Unit, columns (m, n + k, r), and what north itself does in each row (same shape)."""


@dataclass(frozen=True, slots=True)
class RunAction:
    """Something that can be observed next.

    Parameters
    ----------
    id, text : str
    anew : bool
        A new run; else two more points of this one.
    reversed : bool
        It starts on the other side.
    later : bool
        The instrument was set up anew and has rested: what depends on time begins again.
    other_observer : bool
    """

    id: str
    text: str
    anew: bool = True
    reversed: bool = False
    later: bool = False
    other_observer: bool = False


@dataclass(frozen=True, slots=True)
class Design:
    """Rows of the run and of an action: flat columns (n + k, p), columns of the effects."""

    flat: Floats
    laws: Columns
    others: Columns
    first: int

    @property
    def rows(self) -> Linear:
        """The rows; north is the coefficient of the first column."""
        return Linear(self.flat, self.first, np.eye(self.flat.shape[1])[0])


def design_of(case: Case, base: Fit, action: RunAction) -> Design:
    """Rows of a run and of an action; a new run has an amplitude and a damping of its own."""
    assert case.half_swing is not None
    assert case.side is not None
    assert base.theta is not None
    n, time, side = case.size, case.half_swing, case.side
    own = swing_columns(case, base.theta)
    if action.anew:
        again, clock = time, time if action.later else time + time[-1] + GAP_HALF_SWINGS
        sides = -side if action.reversed else side
        source = np.arange(n) if action.later else np.full(n, n - 1)
    else:
        again = clock = time[-1] + np.array([1.0, 2.0])
        sides, source = np.array([-side[-1], side[-1]]), np.full(2, n - 1)
    decay = float(base.theta[1])
    shared = {name: np.concatenate([v, v[source]]) for name, v in own.items()}
    shared["side"] = np.concatenate([side, sides])
    shared["relative_amplitude"] = np.exp(-decay * np.concatenate([time, again]))
    laws = {**shared, "half_swing": np.concatenate([time, again])}
    others = {**shared, "half_swing": np.concatenate([time, clock])}
    swing = shared["side"] * shared["relative_amplitude"]
    tangent = np.column_stack([swing, laws["half_swing"] * swing])
    flat = [np.ones((swing.size, 1)), tangent]
    if action.anew:
        first = (np.arange(swing.size) < n)[:, None]
        flat = [np.ones((swing.size, 1)), tangent * first, tangent * ~first]
    return Design(np.hstack(flat), laws, others, n)


def rivals_of(
    case: Case,
    candidates: Sequence[Candidate],
    ahead: tuple[Design, RunAction],
    *,
    only: Mapping[str, Places] | None = None,
) -> list[Rival]:
    """Members of the average over a run and an action.

    Parameters
    ----------
    case : Case
    candidates : sequence of Candidate
    ahead : tuple
        Rows of the run and of the action, and the action.
    only : mapping, optional
        Places of the members of each unit that are wanted; absent: all.
    """
    design, action = ahead
    size, n = design.flat.shape[0], case.size
    counts = _counts(case, candidates)
    wanted = {
        unit: np.arange(count) if only is None else only.get(unit, np.zeros(0, dtype=np.intp))
        for unit, count in counts.items()
    }
    found: list[Moves] = [
        _of_effect(candidate, design, action, wanted[candidate.id])
        for candidate in candidates
        if candidate.points and not candidate.is_slip and wanted[candidate.id].size
    ]
    for unit, made in _others(case, size, action).items():
        if unit in wanted and wanted[unit].size:
            columns, north = made()
            found.append((unit, columns[wanted[unit]], north[wanted[unit]]))
    total = sum(SHARES.get(unit, OTHER_SHARE) for unit in counts)
    nothing, first = np.zeros((1, 1)), np.zeros(1, dtype=np.intp)
    base = np.full(1, math.log(BASE_PRIOR))
    rivals = [Rival(("base",), first, base, np.zeros((1, size, 1)), nothing, nothing)]
    for unit, columns, north in found:
        sizes = GROSS_SIZES if unit in SLIPS else SIZES
        share = (1.0 - BASE_PRIOR) * SHARES.get(unit, OTHER_SHARE) / total
        prior = np.full(len(columns), math.log(share / len(sizes) / counts[unit]))
        run, both = north[:, :n].mean(axis=1), north.mean(axis=1)
        names = (unit,) * len(columns)
        rivals += [Rival(names, wanted[unit], prior, s * columns, s * run, s * both) for s in sizes]
    return joined_rivals(rivals)


def _counts(case: Case, candidates: Sequence[Candidate]) -> dict[str, int]:
    """Members of each unit in one size."""
    n = case.size
    found: dict[str, int] = {}
    pairs = n <= MOST_FOR_PAIRS
    for candidate in candidates:
        if candidate.points and candidate.is_slip:
            found["gross_error"] = n
            if pairs:
                found["two gross errors"] = n * (n - 1) // 2
        elif candidate.points:
            found[candidate.id] = len(_points_of(candidate))
    if pairs:
        found["two shifts"] = (n - 1) * (n - 2) // 2
    found["wandering"] = 1
    if n <= MOST_UNNAMED:
        found["correlated"] = len(CORRELATIONS)
    return found


def _others(
    case: Case, size: int, action: RunAction
) -> dict[str, Callable[[], tuple[Floats, Floats]]]:
    """What makes the members that are no effect of the catalogue."""
    n = case.size
    return {
        "gross_error": lambda: _slips(n, size),
        "two gross errors": lambda: _two_slips(n, size),
        "two shifts": lambda: _shifts(case, size, action),
        "wandering": lambda: _wandering(case, size, action),
        "correlated": lambda: _correlated(case, size, action),
    }


def _points_of(candidate: Candidate) -> tuple[Mapping[str, float], ...]:
    """Grid points of an effect that are members."""
    return candidate.points[:: 1 + (len(candidate.points) - 1) // MOST_POINTS]


def _of_effect(candidate: Candidate, design: Design, action: RunAction, places: Places) -> Moves:
    """Columns of an effect of the catalogue at some of its grid points, 1 at its largest."""
    effect = candidate.effect
    assert effect is not None
    n = design.first
    columns, north = [], []
    points = _points_of(candidate)
    for place in places.tolist():
        x, mid = _both(effect, design, action, dict(points[place]))
        scale = max(float(np.max(np.abs(x[:n]))), 1e-300)
        if action.other_observer and candidate.id in OF_OBSERVER:
            x = _apart(x, n)
            mid = _apart(mid, n)
        columns.append(x / scale)
        north.append(mid / scale)
    return candidate.id, np.stack(columns), np.stack(north)


def _both(
    effect: Effect, design: Design, action: RunAction, point: dict[str, float]
) -> tuple[Floats, Floats]:
    """Columns of a run and an action together, and what north itself does in them."""
    n = design.first
    table = design.laws if effect.law is not None else design.others
    begins_again = action.anew and (action.later or effect.law is not None)
    parts = (
        [table] if not begins_again else [_rows(table, slice(0, n)), _rows(table, slice(n, None))]
    )
    x = np.concatenate([effect.basis(part, **point) for part in parts])
    if effect.law is not None or effect.acts_on != "midpoint":
        mid = np.zeros_like(x)
    elif effect.midpoint is None:
        mid = x
    else:
        moved = effect.midpoint
        mid = np.concatenate([moved(part, **point) for part in parts])
    if effect.event and begins_again:
        x, mid = x.copy(), mid.copy()
        x[n:], mid[n:] = 0.0, 0.0
    return np.asarray(x), np.asarray(mid)


def _rows(columns: Columns, rows: slice) -> dict[str, Floats]:
    return {name: values[rows] for name, values in columns.items()}


def _apart(x: Floats, n: int) -> Floats:
    """The same columns with a coefficient of its own after row n."""
    first = (np.arange(len(x)) < n)[:, None]
    return np.hstack([x * first, x * ~first])


def _slips(n: int, size: int) -> tuple[Floats, Floats]:
    """Slips among the points that are there: none of them recurs."""
    one = np.zeros((n, size, 1))
    one[np.arange(n), np.arange(n), 0] = 1.0
    return one, np.zeros_like(one)


def _two_slips(n: int, size: int) -> tuple[Floats, Floats]:
    i, j = np.triu_indices(n, 1)
    two = np.zeros((i.size, size, 2))
    two[np.arange(i.size), i, 0] = two[np.arange(i.size), j, 1] = 1.0
    return two, np.zeros_like(two)


def _shifts(case: Case, size: int, action: RunAction) -> tuple[Floats, Floats]:
    """Two shifts of north; it stays where they left it until the instrument is set up anew."""
    n = case.size
    steps = (np.arange(n)[None, :] >= np.arange(1, n)[:, None]).astype(np.float64)
    after = np.zeros if action.anew and action.later else np.ones
    steps = np.hstack([steps, after((n - 1, size - n))])
    i, j = np.triu_indices(n - 1, 1)
    columns = np.stack([steps[i], steps[j]], axis=2)
    return columns, columns


def _wandering(case: Case, size: int, action: RunAction) -> tuple[Floats, Floats]:
    """A walk of north, 1 at the end of the run; it goes on unless the instrument is set up anew."""
    n = case.size
    own = np.arange(n, dtype=np.float64) / (n - 1)
    if action.anew and action.later:
        one = np.minimum(own[:, None], own[None, :])
        walk = np.zeros((size, size))
        walk[:n, :n] = walk[n:, n:] = one
    else:
        gap = GAP_HALF_SWINGS if action.anew else 0.0
        u = np.concatenate([own, 1.0 + (gap + np.arange(1.0, size - n + 1.0)) / (n - 1)])
        walk = np.minimum(u[:, None], u[None, :])
    values, vectors = np.linalg.eigh(walk)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    root = root[:, values > 1e-9 * values[-1]]
    return root[None], root[None]


def _correlated(case: Case, size: int, action: RunAction) -> tuple[Floats, Floats]:
    """Readings that err alike from one to the next; those of a new run know nothing of the first.

    Two more points go on where the run ended; north does not move.
    """
    n = case.size
    spacing = float(np.median(np.diff(np.sort(case.position))))
    more = case.position[-1] + spacing * np.arange(1.0, size - n + 1.0)
    if not action.anew:
        roots = correlated_roots(np.concatenate([case.position, more]))
    else:
        own, other = correlated_roots(case.position), correlated_roots(more)
        roots = np.zeros((len(own), size, size))
        roots[:, :n, :n], roots[:, n:, n:] = own, other
    return roots, np.zeros_like(roots)
