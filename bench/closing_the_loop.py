"""The alarm at the instrument over whole runs, and what advice saves against random choice.

Alarm: shares of runs of 20 points, 5 arc-seconds of noise, that ring at any of their points, with
the median point. Advice: twelve determinations are there and a cause is at work; the proposed
observation that is expected to tell most is made, or one drawn at random, until the true cause
holds 90 % of the weight (pairs of causes left out: most of them contain it), eight at most. The
same at a traverse of nine sides (``bench/_advice.py``).
SURVEYAPP_BENCH_RUNS is the number of campaigns a line (clean runs: 1000), SURVEYAPP_BENCH_STORE a
folder in which finished lines are kept.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from bench._advice import TRAVERSES, traverse_visits
from bench._records import Truth, simulate
from bench._stored import stored
from surveyapp.core.observing.run_alert import find_trouble
from surveyapp.core.prediction.average import predict
from surveyapp.core.swing.gyrofit import fit_damped_swing
from surveyapp.diagnosis.action import POSITION, completed
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.later_visits import campaign_data
from surveyapp.diagnosis.next_observation import advice
from surveyapp.diagnosis.subjects.campaign import CampaignDetermination, campaign
from surveyapp.domain.priors import DEFAULT_PRIORS
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "60"))
CLEAN_RUNS = 1000
POINTS, FIRST = 20, 6
SIGMA = 5.0
MOST, SURE = 8, 0.9
ALARMS: dict[str, dict[str, float]] = {
    "clean": {},
    "drift 3": {"drift": 3.0},
    "warm-up 40": {"warm_up": 40.0},
    "step 25": {"step": 25.0},
    "damping .002": {"damping_change": 0.002},
    "walk 9": {"walk": 9.0},
}
Truths = Callable[[Floats, Floats], Any]
"""Days and temperatures to the constant [arcsec]."""
CAUSES: dict[str, tuple[frozenset[str], bool, Truths]] = {
    "drift": (frozenset({"drift", "bend"}), False, lambda d, t: 0.8 * (d - 20.0)),
    "temperature": (frozenset({"temperature", "curve"}), False, lambda d, t: 2.0 * (t - 12.0)),
    "collinear temperature": (
        frozenset({"temperature", "curve"}),
        True,
        lambda d, t: 2.0 * (t - 12.0),
    ),
    "collinear drift": (frozenset({"drift", "bend"}), True, lambda d, t: d - 12.0),
    "step": (frozenset({"step"}), False, lambda d, t: np.where(d > 20.0, 20.0, 0.0)),
}
"""Units that are the true cause, whether the temperature ran with the time, the truth."""


def alarm_line(name: str, sizes: dict[str, float]) -> str:
    """Share of runs that ring, and the median point."""
    runs = CLEAN_RUNS if name == "clean" else max(RUNS, 60)
    made = simulate(Truth(name, POINTS, noise=5.0, **sizes), runs, 4100)  # type: ignore[arg-type]
    index = np.arange(float(POINTS))
    points = []
    for readings in made.readings:
        values = readings - readings.mean()
        sides = np.where(index % 2 == 0, 1.0, -1.0) * (1.0 if values[0] > values[1] else -1.0)
        for n in range(FIRST, POINTS + 1):
            fit = fit_damped_swing(values[:n], index[:n], sides[:n])
            if find_trouble(fit, index[:n], sides[:n]) is not None:
                points.append(n)
                break
    middle = f"{np.median(points):.0f}" if points else "-"
    return f"| {name} | {runs} | {len(points) / runs:.3f} | {middle} |"


def _case(rows: list[dict[str, float]], truth: Truths) -> Case:
    days = np.array([r["elapsed_days"] for r in rows])
    theta = np.array([r["temperature_c"] for r in rows])
    y = np.asarray(truth(days, theta)) + np.array([r["error"] for r in rows])
    items = [
        CampaignDetermination.at(
            float(v) * ARCSEC,
            sigma=SIGMA * ARCSEC,
            elapsed_days=20000.0 + r["elapsed_days"],
            temperature_c=r["temperature_c"],
            line=f"L{r['line']:.0f}",
        )
        for v, r in zip(y, rows, strict=True)
    ]
    return campaign(items, instrument="G")


def _begin(collinear: bool, g: np.random.Generator) -> list[dict[str, float]]:
    rows = []
    for k in range(12):
        day = 8.0 * (k // 2) + 0.1 * (k % 2)
        theta = 4.0 + 16.0 * day / 40.0 if collinear else float(g.uniform(4.0, 20.0))
        rows.append(
            {
                "elapsed_days": day,
                "temperature_c": theta + float(g.normal(0.0, 0.5)),
                "line": float(k % 2),
                "error": float(g.normal(0.0, SIGMA)),
            }
        )
    return rows


def visits(name: str, i: int, *, advised: bool) -> int:
    """Observations until the true cause is sure; ``MOST`` + 1 if it never is."""
    units, collinear, truth = CAUSES[name]
    g = np.random.default_rng([5, i, len(name)])
    rows = _begin(collinear, g)
    for count in range(MOST + 1):
        case = _case(rows, truth)
        n = case.size
        found = predict(campaign_data(case, np.arange(n), np.eye(n)[:1]), DEFAULT_PRIORS)
        weight = sum(found.weights.get(unit, 0.0) for unit in units)
        left_out = sum(found.weights.get(unit, 0.0) for unit in ("gross_error", "pairs"))
        if weight / (1.0 - left_out) >= SURE:
            return count
        columns = {k: np.asarray(v) for k, v in case.columns.items()}
        columns[POSITION] = case.position
        feasible = {a.id: r for a in case.actions if (r := a.rows(columns)) is not None}
        if advised:
            outlook = advice(case, g)
            assert outlook is not None
            chosen = outlook.actions[0].action
        else:
            chosen = str(g.choice(list(feasible)))
        row = completed(columns, feasible[chosen])
        line = case.grid_labels["line"].get(float(row["line"][0]), "L9")
        rows.append(
            {
                "elapsed_days": float(row["elapsed_days"][0]) - 20000.0,
                "temperature_c": float(row["temperature_c"][0]),
                "line": float(line[1:]),
                "error": float(g.normal(0.0, SIGMA)),
            }
        )
    return MOST + 1


def _counts(name: str, advised: bool) -> list[int]:
    return [visits(name, i, advised=advised) for i in range(RUNS)]


def _traverse_counts(name: str, advised: bool) -> list[int]:
    return [
        traverse_visits(name.removeprefix("traverse: "), i, advised=advised) for i in range(RUNS)
    ]


def compared(name: str, counting: Callable[[str, bool], list[int]]) -> str:
    """Observations and share that were separated, by advice and at random."""
    cells = []
    for advised in (True, False):
        how = "advised" if advised else "random"
        counts = np.array(stored(f"{how} {name}", RUNS, partial(counting, name, advised)))
        cells.append(f"{np.minimum(counts, MOST).mean():.2f} ({(counts <= MOST).mean():.2f})")
    return f"| {name} | {' | '.join(cells)} |"


def run() -> list[str]:
    """The tables."""
    text = ["| run | runs | alarm | median point |", "|---|---|---|---|"]
    text += [
        str(stored(f"alarm {name}", (sizes, RUNS), partial(alarm_line, name, sizes)))
        for name, sizes in ALARMS.items()
    ]
    text[2] += " (asked: .03 at most)"
    text += ["", "| cause | by advice (separated) | at random (separated) |", "|---|---|---|"]
    text += [compared(name, _counts) for name in CAUSES]
    text += [compared(f"traverse: {name}", _traverse_counts) for name in TRAVERSES]
    return text
