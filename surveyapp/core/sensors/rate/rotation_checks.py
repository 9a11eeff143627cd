"""Whether a rotation can be carried: gyros within their range, and gravity that turns with them."""

from __future__ import annotations

import itertools
import math
from typing import Final

import numpy as np

from surveyapp.core.sensors.rate.carried import Rest, Run, tilt_at_start
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem
from surveyapp.languages import either, said
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import attitude_matrix

DENIED: Final = math.radians(15.0)
"""Where gravity lies so far from where the gyros have turned it, columns are exchanged [rad]."""
NOTICED: Final = math.radians(3.0)
"""From here on the difference is told [rad]."""
SCALE: Final = 0.02
"""Of the angle turned: what a nominal scale factor and crooked axes may leave."""
BLOCK_S: Final = 1.0
MOST_TOLD: Final = 3
LONGEST_STEP: Final = 2.5
"""Median intervals: a longer one is a gap."""


def gap_sigma(run: Run) -> float:
    """What the gaps of a run leave open of the angle turned, as a standard deviation [rad].

    A gap is bridged by the mean of the rates about it; how wrong that is, the same bridge over
    all stretches of the run of that length tells. Zero without a gap.
    """
    usual = float(np.median(run.intervals))
    missing = run.intervals[:-1][run.intervals[:-1] > LONGEST_STEP * usual]
    total = np.vstack([np.zeros(3), np.cumsum(run.rates * usual, axis=0)])
    variance = 0.0
    for seconds in missing.tolist():
        steps = min(round(seconds / usual), run.rates.shape[0] - 1)
        whole = total[steps:-1] - total[: -1 - steps]
        bridge = 0.5 * (run.rates[steps:] + run.rates[: run.rates.shape[0] - steps])
        rest = np.linalg.norm(whole - bridge * usual * steps, axis=1)
        variance += float(np.mean(rest**2)) * (seconds / (usual * steps)) ** 2
    return math.sqrt(variance)


def gravity_problems(run: Run, rest: Rest, where: str) -> tuple[list[Problem], list[ResultWarning]]:
    """Gravity as it was felt in the run against where the gyros turn it.

    Returns
    -------
    problems : list of Problem
        Where columns are exchanged, or a sign is wrong.
    warnings : list of ResultWarning
        Where the two differ by less.
    """
    turned = run.rates - rest.mean
    off = _apart(turned, run, rest)
    swept = float(np.sum(np.linalg.norm(turned, axis=1) * run.intervals))
    if off <= NOTICED + SCALE * swept:
        return [], []
    if off <= DENIED + SCALE * swept:
        text = said(
            "gravity lies {off:.1f} degrees from where the gyros have turned it: are scale factor, "
            "axes and zeros right?",
            off=math.degrees(off),
        )
        return [], [ResultWarning("tilt_differs", text)]
    fits = _arrangements(turned, run, rest, limit=NOTICED + SCALE * swept)
    expected = "gravity that turns with the unit"
    if fits:
        expected = said("as with gyr {fits} for (x, y, z)", fits=either(fits))
    return [
        Problem(
            "gravity does not turn as the gyros say",
            where,
            said("{off:.0f} degrees apart in the run", off=math.degrees(off)),
            expected,
            "are columns exchanged or reversed, or rates not in rad/s?",
        )
    ], []


def _apart(turned: Floats, run: Run, rest: Rest) -> float:
    """Between felt and carried gravity, not exceeded in nine tenths of the seconds [rad]."""
    pitch, roll = tilt_at_start(run, rest)
    start = quaternions.from_matrix(attitude_matrix(heading=0.0, pitch=pitch, roll=roll))
    q = quaternions.integrate(turned * run.intervals[:, None], interval_s=1.0, start=start)[:-1]
    size = max(round(BLOCK_S / float(np.median(run.intervals))), 1)
    middle = np.arange(0, q.shape[0], size)
    counts = np.diff(np.append(middle, q.shape[0]))[:, None]
    felt = np.add.reduceat(run.forces, middle, axis=0) / counts
    up = np.add.reduceat(quaternions.rotate_back(q, np.array([0.0, 0.0, 1.0])), middle, axis=0)
    sine = np.linalg.norm(np.cross(felt, up), axis=1)
    angles = np.arctan2(sine, np.sum(felt * up, axis=1))
    return float(np.quantile(angles, 0.9))


def _arrangements(turned: Floats, run: Run, rest: Rest, *, limit: float) -> list[str]:
    """Orders and signs of the gyros by which gravity turns, the simplest first."""
    signs = sorted(itertools.product((1.0, -1.0), repeat=3), key=lambda s: s.count(-1.0))
    orders = sorted(
        itertools.permutations(range(3)), key=lambda p: sum(i != k for i, k in enumerate(p))
    )
    found = []
    for sign in signs:
        for order in orders:
            if _apart(turned[:, list(order)] * np.array(sign), run, rest) <= limit:
                parts = zip(order, sign, strict=True)
                found.append(
                    "(" + ", ".join(f"{'-' if s < 0.0 else ''}{'xyz'[i]}" for i, s in parts) + ")"
                )
            if len(found) == MOST_TOLD:
                return found
    return found
