"""Means of blocks of a long record: the same problem with fewer, independent observations.

Blocks are stretches of time, not counts, so that gaps and uneven sampling do no harm; a block with
fewer samples weighs less. A numbered column (a line, a set-up) is never averaged: blocks end where
it changes. Angles are averaged on the circle. How long a block must be is decided elsewhere.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.long_records.lines import judges_lines
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Effect

LEAST_BLOCKS = 50
"""Fewer block means are refused (diagnosis.md step 8)."""
LEAST_SHARE = 0.5
"""A block whose covariate is known for a smaller share of its samples has none."""
BLURRED = 0.2
"""Share of an effect's columns that may be lost by averaging its covariates instead of itself."""
HARMONICS = 20
"""Terms of the series of the rounding that averaging does not remove."""
BISECTIONS = 40


@dataclasses.dataclass(frozen=True, slots=True)
class Blocks:
    """Which samples belong together.

    Parameters
    ----------
    first : ndarray of int, shape (m,)
        First sample of each block; the samples are sorted by position.
    size : int
        Samples.
    duration : float
        Longest extent of a block [unit of the position].
    """

    first: NDArray[np.intp]
    size: int
    duration: float

    @property
    def counts(self) -> NDArray[np.intp]:
        """Samples of each block, shape (m,)."""
        return np.diff(np.append(self.first, self.size))

    def sums(self, values: Floats) -> Floats:
        """Sums over the blocks of values (n, ...), shape (m, ...)."""
        return np.asarray(np.add.reduceat(values, self.first, axis=0))


def runs_of(problem: Case) -> NDArray[np.intp]:
    """First sample of each run in which every numbered column keeps its value."""
    changed = np.zeros(max(problem.size - 1, 0), dtype=bool)
    for name in problem.grid_labels:
        values = problem.columns.get(name)
        if values is not None:
            changed |= np.diff(values) != 0.0
    return np.concatenate([[0], np.flatnonzero(changed) + 1]).astype(np.intp)


def finer_than_blocks(problem: Case, most: int) -> tuple[str, ...]:
    """Numbered columns that never come back to a value and change more often than ``most`` times.

    They count stretches of time (days, set-ups) that are shorter than a block, and say nothing
    about block means. A column that does come back (a line) cannot be passed over like that.
    """
    found = []
    for name in problem.grid_labels:
        values = problem.columns.get(name)
        if values is None:
            continue
        runs = 1 + int(np.count_nonzero(np.diff(values)))
        if runs > most and runs == np.unique(values).size:
            found.append(name)
    return tuple(found)


def split(position: Floats, runs: NDArray[np.intp], count: int) -> Blocks:
    """Cut a sorted record into about ``count`` blocks of equal extent in time.

    Parameters
    ----------
    position : ndarray, shape (n,)
        Sorted.
    runs : ndarray of int
        First sample of each run, across which no block extends.
    count : int
        Blocks wanted; gaps and runs make them a few more or less.

    Returns
    -------
    Blocks
    """
    span = float(position[-1] - position[0])
    low, high = span / position.size / 10.0, span
    best = _cut(position, runs, span / count)
    for _ in range(BISECTIONS):
        if best.first.size == count or high / low < 1.0 + 1e-6:
            break
        if best.first.size > count:
            low = best.duration
        else:
            high = best.duration
        best = _cut(position, runs, float(np.sqrt(low * high)))
    return best


def _cut(position: Floats, runs: NDArray[np.intp], duration: float) -> Blocks:
    ends = np.append(runs[1:], position.size) - 1
    extent = position[ends] - position[runs]
    parts = np.maximum(np.rint(extent / duration), 1.0)
    length = np.where(extent > 0.0, extent, 1.0) / parts
    run = np.zeros(position.size, dtype=np.intp)
    run[runs[1:]] = 1
    run = np.cumsum(run)
    inside = np.floor((position - position[runs][run]) / length[run])
    inside = np.minimum(inside, parts[run] - 1.0)
    change = (np.diff(run) != 0) | (np.diff(inside) != 0.0)
    first = np.concatenate([[0], np.flatnonzero(change) + 1]).astype(np.intp)
    return Blocks(first, position.size, duration)


def block_means(problem: Case, blocks: Blocks) -> Case:
    """The problem of the block means.

    Parameters
    ----------
    problem : Case
        Sorted by position, finite observations, no swing.
    blocks : Blocks

    Returns
    -------
    Case
        Observations, base and covariates averaged with the weights of the samples; each block has
        the summed weight of its samples and their share of the value, so that the value stays the
        mean over the record. Effects that an average of covariates would blur are left out.

    Raises
    ------
    SurveyError
        If the problem has a swing or there are fewer than 50 blocks.
    """
    _check(problem, blocks)
    weight = np.ones(problem.size)
    if problem.weighted and problem.sigma is not None:
        weight = problem.sigma**-2
    total = blocks.sums(weight)

    def mean(values: Floats) -> Floats:
        parts = blocks.sums((values.T * weight).T)
        return np.asarray((parts.T / total).T)

    uneven = problem.weighted or float(np.ptp(total)) > 0.0
    unit = 1.0 if problem.weighted else problem.scale
    observations = mean(problem.observations)
    columns = averaged_columns(problem, blocks, weight)
    position = mean(problem.position)
    return dataclasses.replace(
        problem,
        observations=observations,
        base=mean(problem.base),
        value_weights=blocks.sums(problem.value_weights),
        position=position,
        columns=columns,
        effects=tuple(
            e
            for e in problem.effects
            if not judges_lines(e) and not blurred(e, problem, blocks, columns)
        ),
        sigma=unit / np.sqrt(total) if uneven else None,
        weighted=uneven,
        resolution=_resolution(problem, blocks),
        labels=tuple(f"block {i + 1} at {t:g}" for i, t in enumerate(position)),
    )


def _check(problem: Case, blocks: Blocks) -> None:
    if problem.has_swing:
        raise SurveyError(
            Problem(
                "a swing cannot be averaged over blocks",
                problem.identity,
                said("{size} turning points", size=problem.size),
                "a record without a swing",
            )
        )
    if blocks.first.size < LEAST_BLOCKS:
        raise SurveyError(
            Problem(
                "too few blocks to diagnose a long record",
                problem.identity,
                said(
                    "{size} blocks from {size2} samples", size=blocks.first.size, size2=problem.size
                ),
                said("at least {least_blocks}", least_blocks=LEAST_BLOCKS),
                "Record longer, and at more different times.",
            )
        )


def averaged_columns(problem: Case, blocks: Blocks, weight: Floats) -> dict[str, Floats]:
    """Covariates of the blocks: numbered ones as they are, angles on the circle, others averaged.

    Missing samples are left out; a block with fewer than half has no value (NaN).
    """
    angles = {n.name for e in problem.effects for n in e.needs if n.unit == "rad"}
    found = {}
    for name, values in problem.columns.items():
        if name in problem.grid_labels:
            found[name] = values[blocks.first]
            continue
        finite = np.isfinite(values)
        w = np.where(finite, weight, 0.0)
        known = np.where(finite, values, 0.0)
        total = blocks.sums(w)
        safe = np.where(total > 0.0, total, 1.0)
        if name in angles:
            sine, cosine = blocks.sums(w * np.sin(known)), blocks.sums(w * np.cos(known))
            mean = np.arctan2(sine, cosine) % (2.0 * np.pi)
        else:
            mean = blocks.sums(w * known) / safe
        share = blocks.sums(finite.astype(np.float64)) / blocks.counts
        found[name] = np.where(share >= LEAST_SHARE, mean, np.nan)
    return found


def blurred(effect: Effect, problem: Case, blocks: Blocks, columns: Mapping[str, Floats]) -> bool:
    """Whether an effect of averaged covariates is not the average of the effect.

    Judged at the middle of its grid. An effect whose columns are missing is not: that is said
    elsewhere.
    """
    needed = [need.name for need in effect.needs]
    for name in needed:
        raw, mean = problem.columns.get(name), columns.get(name)
        if raw is None or mean is None or not np.isfinite(raw).all() or np.ptp(mean) == 0.0:
            return False
    points = effect.grid_points(columns)
    if not points:
        return False
    point = points[len(points) // 2]
    exact = blocks.sums(effect.basis(problem.columns, **point)) / blocks.counts[:, None]
    lost = effect.basis(columns, **point) - exact
    size = np.sqrt((exact**2).sum(axis=0))
    return bool(np.any(np.sqrt((lost**2).sum(axis=0)) > BLURRED * size))


def _resolution(problem: Case, blocks: Blocks) -> float:
    """Resolution of which the rounding error of a block mean is that of a single reading [SI].

    Of noise with standard deviation s = r q, rounding to q leaves errors that averaging does not
    remove, of variance sum over k of q^2 exp(-4 pi^2 k^2 r^2) / (2 pi^2 k^2) (Widrow and Kollar
    2008, Gaussian input): q^2 / 12 without noise, nothing from r = 1/2 on. The rest averages out.
    """
    if problem.resolution <= 0.0:
        return 0.0
    counts = blocks.counts.astype(np.float64)
    mean = blocks.sums(problem.observations) / counts
    inside = blocks.sums((problem.observations - np.repeat(mean, blocks.counts)) ** 2)
    variance = float(np.median(inside / np.maximum(counts - 1.0, 1.0)))
    r2 = max(variance / problem.resolution**2 - 1.0 / 12.0, 0.0)
    k2 = np.arange(1.0, HARMONICS + 1.0) ** 2
    stays = min(
        12.0 * float(np.sum(np.exp(-4.0 * np.pi**2 * k2 * r2) / k2)) / (2.0 * np.pi**2), 1.0
    )
    return problem.resolution * float(np.sqrt(stays + (1.0 - stays) / np.median(counts)))
