"""What another margin would do to names: the lines at N = 20 in which most names are lost.

For each margin the shares of records that would be rightly and wrongly named, and for the margin
that is used how often the right cause is named or among those that are not separable. Names of one
cause in these records; what else a name must pass (proof by left-out observations, removal) is left
out, so that the shares are upper bounds. SURVEYAPP_BENCH_RUNS is the number of records a line.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from bench._records import Truth, problems
from bench.operating_characteristics import REFERENCE
from surveyapp.diagnosis import Diagnosis, diagnose
from surveyapp.diagnosis.compare import MARGIN
from surveyapp.diagnosis.loop import NOISE_MARGIN

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "48"))
MARGINS = (2.0, 3.0, MARGIN, 5.0, 6.0)
LINES = (
    "drift 1",
    "step 12",
    "warm-up 40",
    "warm-up 70",
    "dry friction 14",
    "quadratic drag .2",
    "quadratic drag .4",
    "damping change .002",
)
CONTAIN_A_LINE = frozenset({"quadratic", "smooth", "long_oscillation"})
"""Shapes that contain a straight line: no rivals of a drift."""
NOISES = frozenset({"random_walk", "amplitude_walk", "ar1"})


@dataclass(frozen=True)
class Judged:
    """One record: its best named cause, how much worse causes and noise are, whether it is told."""

    right: bool
    apart: float
    from_noise: float
    told: bool


def judged(result: Diagnosis, effect: str) -> Judged:
    """What a record says of its cause."""
    worse = {c.effect: c.delta_bic for c in result.candidates if c.delta_bic is not None}
    names = {c.effect for c in result.candidates if c.kind == "named"}
    told = any(item.effect == effect for item in result.adopted) or any(
        effect in item.any_of for item in result.ambiguous
    )
    best = min((name for name in worse if name in names), key=lambda n: worse[n], default="")
    if result.verdict == "adequate" or not best or worse[best] > 0.0:
        return Judged(right=False, apart=-1.0, from_noise=-1.0, told=told)
    spanning = CONTAIN_A_LINE if best == "midpoint_drift" else frozenset()
    rivals = [v for k, v in worse.items() if k != best and k not in spanning | NOISES]
    noises = [v for k, v in worse.items() if k in ("random_walk", "ar1")]
    return Judged(best == effect, min(rivals, default=np.inf), min(noises, default=np.inf), told)


def line_of(name: str) -> Truth:
    """The line at N = 20."""
    return next(t for t in REFERENCE if t.name == name and t.size == 20)


def run() -> list[str]:
    """Evaluate every line, return what is printed."""
    found = {}
    for place, name in enumerate(LINES):
        truth = line_of(name)
        made, _ = problems(truth, RUNS, 20261129 + place)
        results = [diagnose(problem, draws=1000, advise=False) for problem in made]
        found[name] = [judged(result, truth.effect) for result in results]
    head = ["right / wrong at " + f"{margin:.0f}" for margin in MARGINS]
    lines = ["| truth, N = 20 | told | " + " | ".join(head) + " |"]
    lines.append("|---" * (2 + len(MARGINS)) + "|")
    every = [item for items in found.values() for item in items]
    for name, items in (*found.items(), ("all together", every)):
        cells = []
        for margin in MARGINS:
            named = [
                item.right
                for item in items
                if item.apart >= margin and item.from_noise >= NOISE_MARGIN
            ]
            right = sum(named)
            cells.append(f"{right / len(items):.2f} / {(len(named) - right) / len(items):.2f}")
        share = float(np.mean([item.told for item in items]))
        lines.append(f"| {name} | {share:.2f} | " + " | ".join(cells) + " |")
    return lines
