"""What may be missing: named effects, generic shapes and gross errors as columns on their grids.

A generic shape can only end as "unattributed: shape"; a named effect may be adopted. This module
makes columns; it does not know the observations.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.shifts import shift
from surveyapp.languages import joined, said, term
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Effect

Kind = Literal["named", "shape"]

MOST_PAIRS = 1500
"""Grid points up to which several gross errors are searched exhaustively."""
NOT_SEPARABLE = 0.02
"""Share of its norm that a candidate must keep beside the model (diagnosis.md step 3)."""
NOT_SEPARABLE_LAW = 0.004
"""The same for amplitude laws, whose tangent lies close to exponential damping."""


GROSS_WEIGHT = 3.0
"""A slip is the commonest cause, and short records show little else; the false alarms that all
candidates share stay where they are (weighted p values: Genovese, Roeder & Wasserman 2006)."""
SHAPE_WEIGHT = 0.5
"""A generic shape ends in no name."""
SHAPE_ODDS = 4.0
"""BIC that a generic shape is charged beforehand against a named effect, prior odds of e^2: of
channels side by side and of runs. A step of all channels at once is the nearest imitation of an
even drift, a bend that of a warm-up: without this half of them end beside one."""
PULSES_FROM, SMOOTH_FROM = 12, 16
"""Observations from which pulses and bent decays are looked for."""
SINGLE_SHARE = 0.75
"""Share of what the model leaves of a shift above which one reading alone shows it."""
PULSE_PHASES = (0.0, 0.25, 0.5, 0.75)
SHORTEST_PULSE, LONGEST_PULSE = 2, 6
"""Places for which a pulse lasts; a quarter of the record at most."""
SLOWEST_CYCLES = 1.5
"""Cycles over the record of the slowest wave."""
AMPLITUDE_SHAPES = frozenset({"amplitude_step", "amplitude_smooth"})
"""Generic shapes of the amplitude of a swing."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """One effect or shape with all its grid points.

    Parameters
    ----------
    id : str
    kind : str
        named | shape.
    points : tuple of mapping
        Grid points.
    columns : ndarray, shape (g, n, q)
        Weighted columns; of an amplitude law the tangent at coefficient 0.
    charge : ndarray, shape (g,)
        Parameters that are paid for: coefficients and searched positions.
    effect : Effect or None
    midpoint : ndarray, shape (g, n, q), or None
        What north itself does where the columns hold a kick of the amplitude too, unweighted.
    count : int
        Number of gross errors in one candidate, else 1.
    missing : str
        Why it is not applicable, or empty.
    odds : float
        BIC that it is charged beforehand: twice the logarithm of prior odds against it.
    """

    id: str
    kind: Kind
    points: tuple[Mapping[str, float], ...]
    columns: Floats
    charge: Floats
    effect: Effect | None = None
    midpoint: Floats | None = None
    count: int = 1
    missing: str = ""
    odds: float = 0.0

    @property
    def is_law(self) -> bool:
        """Whether it changes the amplitude law."""
        return self.effect is not None and self.effect.law is not None

    @property
    def is_slip(self) -> bool:
        """Whether it is a single gross error."""
        effect = self.effect
        return effect is not None and effect.acts_on == "observation" and self.count == 1

    @property
    def describes_amplitude(self) -> bool:
        """Whether it is a description of the amplitude, named or generic; a model has one."""
        return self.is_law or self.id in AMPLITUDE_SHAPES

    @property
    def weight(self) -> float:
        """Share of the false alarms that it may spend, a named effect taking one."""
        if self.kind == "shape":
            return SHAPE_WEIGHT
        return GROSS_WEIGHT if self.is_slip else 1.0

    @property
    def one_sided(self) -> bool:
        """Whether only a positive coefficient is possible."""
        return self.effect is not None and self.effect.one_sided

    @property
    def size(self) -> int:
        """Coefficients."""
        return int(self.columns.shape[2])

    @property
    def separable_share(self) -> float:
        """Share of the norm below which it is not separable from the model."""
        return NOT_SEPARABLE_LAW if self.is_law else NOT_SEPARABLE


def swing_columns(problem: Case, theta: Floats | None) -> dict[str, Floats]:
    """Columns of a problem with those of its swing as it is fitted now."""
    columns = dict(problem.columns)
    if problem.side is not None and problem.half_swing is not None and theta is not None:
        n = problem.size
        columns["half_swing"] = problem.half_swing
        columns["side"] = problem.side
        columns["first_amplitude"] = np.full(n, theta[0])
        columns["decay"] = np.full(n, theta[1])
        columns["relative_amplitude"] = np.exp(-theta[1] * problem.half_swing)
    return columns


def missing_columns(effect: Effect, columns: Mapping[str, Floats]) -> str:
    """Say what an effect lacks, or an empty text."""
    lacking = []
    for need in effect.needs:
        values = columns.get(need.name)
        if values is None:
            lacking.append(said("no {name} [{unit}]", name=need.name, unit=term(need.unit)))
        elif not np.isfinite(values).all():
            gone = int((~np.isfinite(values)).sum())
            lacking.append(
                said(
                    "{name} missing at {gone} of {size} observations",
                    name=need.name,
                    gone=gone,
                    size=values.size,
                )
            )
        elif values.size > 1 and np.ptp(values) == 0.0 and need.name not in CONSTANT_COLUMNS:
            lacking.append(said("{name} has one value only", name=need.name))
    return joined("; ", lacking)


CONSTANT_COLUMNS = frozenset(
    {"first_amplitude", "decay", "side", "relative_amplitude", "own_sigma", "axis"}
)
"""Columns that may be constant."""


def all_candidates(problem: Case, theta: Floats | None) -> tuple[Candidate, ...]:
    """Every candidate of a problem at the present amplitude and damping of its swing."""
    columns = swing_columns(problem, theta)
    root = problem.root_weights
    found: list[Candidate] = []
    for effect in problem.effects:
        found += _named(effect, columns, root)
    found += _shapes(problem, columns, root)
    return tuple(found)


def single_effects(problem: Case, theta: Floats | None) -> tuple[Candidate, ...]:
    """The named effects of a problem, each by itself: no shapes, no several slips at once."""
    columns, root = swing_columns(problem, theta), problem.root_weights
    return tuple(_named(effect, columns, root)[0] for effect in problem.effects)


def _named(effect: Effect, columns: Mapping[str, Floats], root: Floats) -> list[Candidate]:
    empty = np.zeros((0, root.size, len(effect.coefficients)))
    missing = missing_columns(effect, columns)
    if missing:
        return [Candidate(effect.id, "named", (), empty, np.zeros(0), effect, missing=missing)]
    points = effect.grid_points(columns)
    if not points:
        text = said("the record is too short for it or does not vary")
        return [Candidate(effect.id, "named", (), empty, np.zeros(0), effect, missing=text)]
    stacked = np.stack([effect.basis(columns, **point) for point in points]) * root[None, :, None]
    searched = [effect.searched(p) if len(points) > 1 else 0 for p in points]
    charge = stacked.shape[2] + np.array(searched, dtype=np.float64)
    single = Candidate(effect.id, "named", points, stacked, charge, effect)
    if effect.acts_on == "observation":
        return [single, *_several(single)]
    return [single]


def _several(single: Candidate) -> list[Candidate]:
    """Two and three gross errors at once, where an exhaustive search is affordable."""
    count, n = len(single.points), single.columns.shape[1]
    result = []
    for several in (2, 3):
        if n < 4 + 3 * several or math.comb(count, several) > MOST_PAIRS:
            continue
        combinations = list(itertools.combinations(range(count), several))
        index = np.array(combinations)
        columns = np.concatenate([single.columns[index[:, i]] for i in range(several)], axis=2)
        keys = [[(k, f"{k}_{i + 1}") for k in single.points[0]] for i in range(several)]
        points = tuple(
            {name: single.points[j][k] for own, j in zip(keys, c, strict=True) for k, name in own}
            for c in combinations
        )
        charge = np.full(len(points), 2.0 * several)
        result.append(
            Candidate(single.id, "named", points, columns, charge, single.effect, count=several)
        )
    return result


def _shape(name: str, columns: list[Floats], charge: int, root: Floats) -> Candidate:
    stacked = np.stack(columns) * root[None, :, None]
    points = tuple({"index": float(i)} for i in range(len(columns)))
    return Candidate(name, "shape", points, stacked, np.full(len(columns), float(charge)))


def _shapes(problem: Case, columns: Mapping[str, Floats], root: Floats) -> list[Candidate]:
    """Generic shapes over the position; of a swing in its amplitude too."""
    position = problem.position
    if np.unique(position).size < 5:
        return []
    span = float(np.ptp(position))
    x = 2.0 * (position - position.min()) / span - 1.0
    if problem.series is not None:
        return _shapes_of_each(problem, x, root)
    shapes = [
        _shape("quadratic", [np.column_stack([x, x**2])], 2, root),
        _shape("smooth", [np.column_stack([x, x**2, x**3])], 3, root),
    ]
    taken = {effect.id for effect in problem.effects}
    if problem.size >= PULSES_FROM and not ("gyro_block" in taken and "block" in columns):
        shapes += _pulse_shape(problem, columns, root)
    if problem.has_swing:
        amplitude = columns["side"] * columns["relative_amplitude"]
        inner = np.unique(position)[2:-3]
        kicks = [((position > p) * amplitude)[:, None] for p in inner]
        if kicks:
            shapes.append(_shape("amplitude_step", kicks, 2, root))
        if problem.size >= SMOOTH_FROM:
            decayed = (x + 1.0)[:, None] ** np.array([2.0, 3.0]) * amplitude[:, None]
            shapes.append(_shape("amplitude_smooth", [decayed], 3, root))
        shapes.append(_periodic("long_oscillation", x, (0.8, 1.45), root, n=problem.size))
    else:
        if "transport_step" not in taken:
            inner = np.unique(position)[1:-2]
            steps = [(position > p).astype(np.float64)[:, None] for p in inner]
            if steps:
                shapes.append(_shape("step", steps, 2, root))
        shapes.append(
            _periodic("periodic", x, (SLOWEST_CYCLES, 0.25 * problem.size), root, n=problem.size)
        )
    if "gross_error" not in taken:
        single = [np.eye(problem.size)[:, i : i + 1] for i in range(problem.size)]
        shapes.append(_shape("outlier", single, 2, root))
    return shapes


def _shapes_of_each(problem: Case, x: Floats, root: Floats) -> list[Candidate]:
    """Generic shapes of several channels side by side: each channel has coefficients of its own."""
    series = np.zeros(problem.size) if problem.series is None else problem.series
    channels = np.unique(series[np.isfinite(series)])
    masks = (series[:, None] == channels[None, :]).astype(np.float64)
    count = masks.shape[1]

    def each(columns: Floats) -> Floats:
        return np.hstack([masks * column[:, None] for column in columns.T])

    shapes = [
        _shape("quadratic", [each(np.column_stack([x, x**2]))], 2 * count, root),
        _shape("smooth", [each(np.column_stack([x, x**2, x**3]))], 3 * count, root),
    ]
    places = np.unique(problem.position)[1:-2]
    steps = [each((problem.position > p)[:, None].astype(np.float64)) for p in places]
    if steps:
        shapes.append(_shape("step", steps, count + 1, root))
    longest = 0.25 * problem.size / count
    if longest > SLOWEST_CYCLES:
        waves = [
            each(np.column_stack([np.cos(np.pi * c * x), np.sin(np.pi * c * x)]))
            for c in np.arange(SLOWEST_CYCLES, longest, 0.25)
        ]
        shapes.append(_shape("periodic", waves, 2 * count + 1, root))
    return [replace(shape, odds=SHAPE_ODDS) for shape in shapes]


def _pulse_shape(
    problem: Case, columns: Mapping[str, Floats], root: Floats
) -> tuple[Candidate, ...]:
    """The pulses that show in more than one reading: in one alone it is a slip."""
    stacked = np.stack(_pulses(problem.position, problem.side))
    pure = np.stack(_pulses(problem.position, problem.side, kicked=False))
    base = [problem.base]
    if problem.has_swing:
        amplitude = columns["side"] * columns["relative_amplitude"]
        base.append(amplitude[:, None] * np.column_stack([np.ones(problem.size), problem.position]))
    q, _ = np.linalg.qr(np.hstack(base))
    left = (stacked - q @ (q.T @ stacked))[:, :, 0] ** 2
    spread = left.max(axis=1) < SINGLE_SHARE * left.sum(axis=1)
    charge = 3 if problem.side is None else 5
    if not spread.any():
        return ()
    shape = _shape("pulse", list(stacked[spread]), charge, root)
    return (replace(shape, midpoint=pure[spread]),)


def _pulses(position: Floats, side: Floats | None, *, kicked: bool = True) -> list[Floats]:
    """North, or the constant, off for two places or more and then back, shape (n, 1) each.

    At either end of the record only two places: what is off for longer there is a step. A shift
    inside a half swing kicks the amplitude too, by its phase, when it comes and when it goes;
    without ``kicked`` the shift alone, in the same order.
    """
    places = np.unique(position)
    count = places.size
    longest = max(SHORTEST_PULSE, min(LONGEST_PULSE, count // 4))
    shifts = {
        i: _shifts(position, side, places[i], kicked=kicked) for i in range(count - SHORTEST_PULSE)
    }
    found = list(shifts[1]) + list(shifts[count - SHORTEST_PULSE - 1])
    for first in range(count - SHORTEST_PULSE - 1):
        for last in range(first + SHORTEST_PULSE, min(first + longest, count - 3) + 1):
            found += [come - go for come in shifts[first] for go in shifts[last]]
    return [column[:, None] for column in found]


def _shifts(
    position: Floats, side: Floats | None, place: float, *, kicked: bool
) -> tuple[Floats, ...]:
    """A shift after a place, at each phase of the half swing that follows it, shape (n,) each."""
    after = (position > place).astype(np.float64)
    if side is None:
        return (after,)
    if not kicked:
        return (after,) * len(PULSE_PHASES)
    return tuple(shift(position, side, place, phase) for phase in PULSE_PHASES)


def _periodic(
    name: str, x: Floats, cycles: tuple[float, float], root: Floats, *, n: int
) -> Candidate:
    """Sine and cosine with a scanned number of cycles over the record."""
    low, high = cycles
    count = max(2, min(int(4 * (high - low)), 2 * n) + 1)
    columns = [
        np.column_stack([np.cos(np.pi * c * x), np.sin(np.pi * c * x)])
        for c in np.linspace(low, max(high, low + 0.1), count)
    ]
    return _shape(name, columns, 3, root)
