"""Whether the interval of a later azimuth holds, clean and with every cause.

Prints, for each cause, the error, the interval and the coverage of the constant at four later
visits and of a later azimuth (its own standard deviation 2.6 arc-seconds beside it), next to the
mean of the campaign with its Student interval, which is what was used before. Writes
docs/reference/later-azimuths.md. Declared simulation (``bench/_campaigns.py``); causes of the group
"absent" are in no prior and recorded nowhere.
"""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from bench._campaigns import ABSENT, CATALOGUE, CLEAN, LATER, LINE_SIGMA, WANDERING, draw
from surveyapp.core.prediction.average import predict
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.domain.priors import DEFAULT_PRIORS
from surveyapp_models.arrays import Floats

PAGE = Path(__file__).resolve().parent.parent / "docs/reference/later-azimuths.md"
SIZES = (8, 12, 20, 45)
RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "200"))
STRENGTH = (0.7, 5.0)
"""Sizes of a cause, log-uniform, in standard deviations of a determination."""
GROUPS = {"clean": CLEAN, "catalogue": CATALOGUE, "walk-like": WANDERING, "absent": ABSENT}

HEAD = """# Later azimuths

*Written by `python -m bench later_azimuths`; do not edit it.*

Declared simulation: campaigns of some months, one to three determinations a day of 4 to 7
arc-seconds, four later visits at other lines, days and temperatures, most of them after the
campaign; sizes of the causes log-uniform from {low} to {high} standard deviations of a
determination; {runs} campaigns a line. rms and interval (median half-width, 95 %) of the
constant in arc-seconds; coverage of the constant, and of a later azimuth whose own standard
deviation is 2.6. Mean: the mean of the campaign with its Student interval, which was used before.
Ratio: interval of the azimuth over that with the mean.

"""


def one_line(task: tuple[str, str, int, int]) -> tuple[str, str, int, Floats]:
    """Rows (error, half, holds, azimuth holds, error, half, holds of the mean, ratio)."""
    group, name, n, place = task
    rows = []
    for i in range(RUNS):
        g = np.random.default_rng([20261128, place, n, i])
        made = draw(GROUPS[group][name], n, g, sizes=STRENGTH)
        found = predict(made.data, DEFAULT_PRIORS)
        assert made.data.sigmas is not None
        w = made.data.sigmas**-2
        mean = float(w @ made.data.values / w.sum())
        factor = float(w @ (made.data.values - mean) ** 2) / (n - 1)
        own = student_quantile(0.975, n - 1) * float(np.sqrt(factor / w.sum()))
        wide = float(np.hypot(own, 1.96 * LINE_SIGMA))
        for t in range(LATER):
            error, half = float(found.values[t] - made.truth[t]), found.half_width(t)
            azimuth = found.half_width(t, LINE_SIGMA**2)
            old = mean - float(made.truth[t])
            holds = abs(error + made.errors[t]) <= azimuth
            rows.append(
                (error, half, abs(error) <= half, holds, old, own, abs(old) <= own, azimuth / wide)
            )
    return group, name, n, np.array(rows, dtype=np.float64)


def row(name: str, n: int, a: Floats) -> str:
    """One line of the table."""
    rms, old = (float(np.sqrt(np.mean(a[:, k] ** 2))) for k in (0, 4))
    return (
        f"| {name} | {n} | {rms:.1f} / {np.median(a[:, 1]):.1f} / {a[:, 2].mean():.2f} "
        f"| {a[:, 3].mean():.2f} | {old:.1f} / {np.median(a[:, 5]):.1f} / {a[:, 6].mean():.2f} "
        f"| {np.median(a[:, 7]):.2f} |"
    )


def run() -> list[str]:
    """Evaluate every line, write the page, return what is printed."""
    tasks = [
        (group, name, n, place)
        for group, causes in GROUPS.items()
        for place, name in enumerate(causes)
        for n in SIZES
    ]
    with ProcessPoolExecutor() as pool:
        found = list(pool.map(one_line, tasks))
    head = ["| cause | N | average: rms / interval / coverage | azimuth | mean | ratio |"]
    head.append("|---|---|---|---|---|---|")
    groups = [
        row(group, n, np.concatenate([a for g, _, m, a in found if (g, m) == (group, n)]))
        for group in GROUPS
        for n in SIZES
    ]
    each = [row(name, n, a) for group, name, n, a in found if group != "clean"]
    text = ["Groups:", "", *head, *groups, "", "Causes:", "", *head, *each]
    low, high = STRENGTH
    PAGE.write_text(
        HEAD.format(low=low, high=high, runs=RUNS) + "\n".join(text) + "\n", encoding="utf-8"
    )
    return text
