"""The stops of a log of index positions: means of what lay still, and what was left out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from surveyapp.core.sensors.rate.indexing_checks import saturated, turning_problems
from surveyapp.core.sensors.rate.indexing_values import Setting, Stop
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import counted, said
from surveyapp_models.arrays import Floats

GYROS = ("gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s")
ACCELEROMETERS = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")
NEEDED = (*GYROS, *ACCELEROMETERS, "index_angle_deg")
OPTIONAL = ("temperature_c", "set", "round", "pass")
CYCLE = "power_cycle"
MOVING_SIGMAS = 8.0
"""Samples farther from the median of their stop were taken while something moved."""
MOVING_SHARE = 0.2
"""A stop with more of them is not used."""
BUMPED_SHARE = 0.01
"""A stop with more of them is told."""
FLICKER_ROWS, FLICKER_SHARE, FLICKER_SIGMAS = 8, 0.5, 8.0
"""Rows over which an index that rests comes back; the share of its way that may be left, and of
the rows that must rest; and standard deviations of what is left that are still rest."""
FLICKER_LEAST = 0.2
"""Share of the stretches with a changing angle that must come back: else every change is a turn."""
SHAKEN = 4.0
"""A stop whose samples scatter so many times as much as those of the middle stop is not used."""
LEAST_COMPARED, LEAST_SAMPLED = 3, 8
"""Stops, and samples in each, from which their scatter is compared."""


def stops_of(log: SensorLog) -> tuple[list[Stop], list[int], list[ResultWarning]]:
    """Mean outputs of each index position, the rows at which each begins, and what was left out.

    Raises
    ------
    SurveyError
        Without any stop, or of a saturated gyro.
    """
    unnumbered = _unnumbered(log)
    if unnumbered:
        raise SurveyError(unnumbered)
    steady = steadied(log.columns["index_angle_deg"])
    log = replace(log, columns={**log.columns, "index_angle_deg": steady})
    edges = _edges(log)
    lengths = np.diff(edges).tolist()
    problems = [*saturated(log, GYROS), *turning_problems(log, lengths)]
    if problems:
        raise SurveyError(problems)
    least = max(int(0.05 * max(lengths)), 1)
    rates, forces = (np.column_stack([log.columns[c] for c in n]) for n in (GYROS, ACCELEROMETERS))
    stops: list[Stop] = []
    rows: list[tuple[int, int]] = []
    dropped, bumped = 0, 0
    for first, last in pairwise(edges):
        if last - first < least:
            continue  # the index was still turning
        keep = calm(rates[first:last]) & calm(forces[first:last])
        if float(np.mean(~keep)) > MOVING_SHARE:
            dropped += 1
            continue
        bumped += float(np.mean(~keep)) > BUMPED_SHARE
        angle = math.radians(log.columns["index_angle_deg"][first])
        stops.append(_stop(angle, rates[first:last][keep], forces[first:last][keep]))
        rows.append((first, last - first))
    quiet = _quiet(stops, [count for _, count in rows])
    dropped += len(stops) - int(np.count_nonzero(quiet))
    stops = [stop for stop, kept in zip(stops, quiet, strict=True) if kept]
    rows = [row for row, kept in zip(rows, quiet, strict=True) if kept]
    if not stops:
        raise SurveyError(
            Problem(
                "no index position at rest was found",
                log.path,
                "the index turns or the unit moves throughout",
                "stretches of constant index_angle_deg",
            )
        )
    return stops, [first for first, _ in rows], _told_of_motion(dropped, bumped)


def _unnumbered(log: SensorLog) -> list[Problem]:
    """Rows of which it is not known to which set or power cycle they belong."""
    found = []
    for name in (*OPTIONAL[1:], CYCLE):
        missing = 0 if name not in log.columns else int(np.isnan(log.columns[name]).sum())
        if missing:
            what = said("{name} has rows without a number", name=name)
            rows = said("{rows} rows", rows=missing)
            found.append(Problem(what, log.path, rows, "a number in each row"))
    return found


def steadied(angles: Floats) -> Floats:
    """Index angles of which each rest has one value, its median; those of a turn stay [deg].

    An encoder's last digits flicker. They do so about one value, where an index that turns goes
    on: over a few rows the way back and forth is longer than what is left of it.

    Parameters
    ----------
    angles : ndarray, shape (n,)
        Without flicker they are returned as they are.
    """
    if angles.size <= 2 * FLICKER_ROWS:
        return angles
    given, angles = angles, np.unwrap(angles, period=360.0)
    path = np.convolve(np.abs(np.diff(angles)), np.ones(FLICKER_ROWS), "valid")
    net = np.abs(angles[FLICKER_ROWS:] - angles[:-FLICKER_ROWS])
    moved = path > 1e-9
    flickers = moved & (net < FLICKER_SHARE * path)
    rests = float(np.mean(flickers | ~moved))
    least = FLICKER_LEAST * float(np.count_nonzero(moved))
    if not flickers.any() or rests < FLICKER_SHARE or np.count_nonzero(flickers) < least:
        return given
    usual, largest = np.quantile(net[flickers], [0.5, 0.95])
    limit = max(FLICKER_SIGMAS * 1.4826 * float(usual), 2.0 * float(largest))
    resting = np.concatenate(
        [np.full(FLICKER_ROWS // 2, net[0] <= limit), net <= limit,
         np.full(FLICKER_ROWS - FLICKER_ROWS // 2, net[-1] <= limit)]
    )  # fmt: skip
    found = np.array(angles, dtype=np.float64)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], resting.astype(np.int8), [0]])))
    begin, before, near = 0, math.nan, FLICKER_ROWS
    for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        own = float(np.median(angles[first:last]))
        if not abs(own - before) <= limit:  # else the same rest, after a larger flicker
            ahead = np.abs(angles[max(first - near, 0) : first] - own) <= limit
            begin, before = first - int(np.cumprod(ahead[::-1]).sum()), own
        behind = np.abs(angles[last : last + near] - before) <= limit
        found[begin : last + int(np.cumprod(behind).sum())] = before
    return found


def _edges(log: SensorLog) -> list[int]:
    """Rows at which an index position or a set begins, and one behind the last."""
    change = np.concatenate([[True], np.abs(np.diff(log.columns["index_angle_deg"])) > 1e-6])
    for name in (*OPTIONAL[1:], CYCLE):
        if name in log.columns:
            change[1:] |= np.diff(log.columns[name]) != 0.0
    return [*np.flatnonzero(change).tolist(), log.size]


def _told_of_motion(dropped: int, bumped: int) -> list[ResultWarning]:
    """Positions that were not used, and those that were used in part."""
    warnings = []
    if dropped:
        text = counted(
            "an index position was not used: the unit was moving",
            "{count} index positions were not used: the unit was moving",
            count=dropped,
        )
        warnings.append(ResultWarning("motion_in_stop", text))
    if bumped:
        text = counted(
            "in one index position the unit was bumped for a moment",
            "in {count} index positions the unit was bumped for a moment",
            count=bumped,
        )
        warnings.append(ResultWarning("bumped", text))
    return warnings


def _quiet(stops: Sequence[Stop], counts: Sequence[int]) -> np.ndarray:
    """Stops in which no channel shakes several times as much as in the middle one of all."""
    if len(stops) < LEAST_COMPARED or min(counts) < LEAST_SAMPLED:
        return np.ones(len(stops), dtype=bool)
    sigma = np.array([np.concatenate([s.rate_sigma, s.force_sigma]) for s in stops])
    sample = sigma * np.sqrt(np.array(counts))[:, None]
    return np.asarray(np.all(sample <= SHAKEN * np.median(sample, axis=0), axis=1))


def calm(values: Floats) -> np.ndarray:
    """Rows near the median of all in every channel, shape (n,)."""
    if values.shape[0] < 8:
        return np.ones(values.shape[0], dtype=bool)
    off = np.abs(values - np.median(values, axis=0))
    spread = 1.4826 * np.median(off, axis=0)
    # of coarse digits the middle one may be most of them: then half a digit is the noise
    digit = np.where(off > 0.0, off, np.inf).min(axis=0)
    spread = np.where(spread > 0.0, spread, np.where(np.isfinite(digit), 0.5 * digit, 0.0))
    return np.asarray(np.all(off <= MOVING_SIGMAS * spread + 1e-12, axis=1))


def _stop(angle: float, rates: Floats, forces: Floats) -> Stop:
    count = rates.shape[0]
    if count < 2:
        unknown = np.full(3, math.nan)
        return Stop(angle, rates[0], unknown, forces[0], unknown)
    root = math.sqrt(count)
    return Stop(
        angle,
        rates.mean(axis=0),
        np.maximum(rates.std(axis=0, ddof=1) / root, 1e-12),
        forces.mean(axis=0),
        np.maximum(forces.std(axis=0, ddof=1) / root, 1e-9),
    )


def with_sigmas(stops: list[Stop], setting: Setting) -> tuple[list[Stop], float]:
    """Stops of one row each get the scatter about the turned means as their sigma.

    Returns
    -------
    stops : list of Stop
    dof : float
        Degrees of freedom of that scatter; infinite where the samples of the stops tell.
    """
    if all(np.all(np.isfinite(s.rate_sigma)) for s in stops):
        return stops, math.inf
    known, dof = [], 1
    for name, floor in (("rate", 1e-9), ("force", 1e-5)):
        values = np.array([getattr(s, name) for s in stops])
        if name == "rate":
            values = np.linalg.solve(setting.matrix, values.T).T
        scatter, dof = _residual_sd(values, [s.angle for s in stops], setting.axis)
        known.append(max(scatter, floor))
    filled = [
        replace(s, rate_sigma=np.full(3, known[0]), force_sigma=np.full(3, known[1])) for s in stops
    ]
    return filled, float(dof)


def _residual_sd(values: Floats, angles: Sequence[float], axis: int) -> tuple[float, int]:
    """Scatter about a vector that turns with the index and a constant one, and its freedom."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rows, target = [], []
    for value, angle in zip(values, angles, strict=True):
        c, s = math.cos(angle), math.sin(angle)
        rows += [[c, -s, 1.0, 0.0, 0.0], [s, c, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0]]
        target += [value[i], value[j], value[axis]]
    design = np.array(rows)
    solution, *_ = np.linalg.lstsq(design, np.array(target), rcond=None)
    rest = np.array(target) - design @ solution
    dof = max(len(target) - int(np.linalg.matrix_rank(design)), 1)
    return math.sqrt(float(rest @ rest) / dof), dof
