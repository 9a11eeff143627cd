"""Campaigns of one or two days, and lines a day, a month and a season later: declared simulation.

What acts on the instrument has its pace in days, not in spans of the campaign, and goes on whether
it is determined or not. Sizes are in standard deviations of a determination (5 arc-seconds) over
that pace, log-uniform as in ``bench/_campaigns.py``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bench._campaigns import LINE_SIGMA, SIGMAS, Drawn
from surveyapp.core.prediction.average import Determinations
from surveyapp_models.arrays import Floats

PACES_DAYS = (13.0, 220.0)
"""What a cause does in a season it does in so many days, log-uniform: the spans of nineteen in
twenty campaigns of the archive."""
LATER_DAYS = (1.0, 30.0, 120.0)
Path = Callable[[Floats, Floats, np.random.Generator], Floats]
"""From paces and blocks to the constant in sizes."""


def _clean(time: Floats, block: Floats, g: np.random.Generator) -> Floats:
    return np.zeros(time.size)


def _drift(time: Floats, block: Floats, g: np.random.Generator) -> Floats:
    return np.asarray(2.0 * time * g.choice([-1.0, 1.0]))


def _walk(time: Floats, block: Floats, g: np.random.Generator) -> Floats:
    gaps = np.diff(np.concatenate([[0.0], time]))
    return np.asarray(1.5 * np.cumsum(np.sqrt(gaps) * g.standard_normal(time.size)))


def _ageing(time: Floats, block: Floats, g: np.random.Generator) -> Floats:
    tau = g.uniform(0.2, 1.0)
    return np.asarray(2.5 * np.exp(-(time + g.uniform(0.0, 0.5)) / tau) * g.choice([-1.0, 1.0]))


def _offsets(time: Floats, block: Floats, g: np.random.Generator) -> Floats:
    return np.asarray(g.standard_normal(int(block.max()) + 1)[block.astype(int)])


def _step(time: Floats, block: Floats, g: np.random.Generator) -> Floats:
    return np.asarray(1.5 * (time > g.uniform(0.0, 1.0)) * g.choice([-1.0, 1.0]))


def _season(time: Floats, block: Floats, g: np.random.Generator) -> Floats:
    return np.asarray(1.3 * np.sin(2.0 * np.pi * time / 3.0 + g.uniform(0.0, 6.28)))


CAUSES: dict[str, Path] = {
    "clean": _clean,
    "drift": _drift,
    "walk": _walk,
    "ageing": _ageing,
    "day offsets": _offsets,
    "step": _step,
    "season": _season,
}


def draw_short(cause: str, n: int, spread: int, g: np.random.Generator) -> Drawn:
    """A campaign of n determinations on ``spread`` days that follow each other."""
    own = np.sort(np.floor(np.arange(n) * spread / n))
    hours = np.concatenate(
        [np.sort(g.uniform(7.0, 16.0, int((own == day).sum()))) for day in range(spread)]
    )
    days = np.concatenate([own + hours / 24.0, spread - 1.0 + np.array(LATER_DAYS) + 0.4])
    block = np.concatenate([own, spread + np.arange(len(LATER_DAYS))])
    size = float(np.exp(g.uniform(*np.log((0.7, 5.0)))))
    pace = float(np.exp(g.uniform(*np.log(PACES_DAYS))))
    sigma = g.choice(SIGMAS, n)
    line = np.concatenate([g.integers(0, 2, n), g.integers(2, 5, len(LATER_DAYS))])
    theta = 12.0 + 3.0 * g.standard_normal(spread + len(LATER_DAYS))[block.astype(int)]
    theta += np.sin((days - np.floor(days)) * 2.0 * np.pi) + 0.5 * g.standard_normal(days.size)
    truth = -12.0 + size * 5.0 * CAUSES[cause](days / pace, block, g)
    values = truth[:n] + sigma * g.standard_normal(n)
    targets = np.zeros((len(LATER_DAYS), days.size))
    targets[np.arange(len(LATER_DAYS)), n + np.arange(len(LATER_DAYS))] = 1.0
    columns = {
        "elapsed_days": days - days[0],
        "block": block,
        "line": line.astype(np.float64),
        "temperature_c": theta,
        "running_s": g.uniform(200.0, 3000.0, days.size),
    }
    data = Determinations(values, sigma, columns, targets, np.zeros((n, 0)))
    return Drawn(data, truth[n:], LINE_SIGMA * g.standard_normal(len(LATER_DAYS)))
