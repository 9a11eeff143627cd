"""Whether north of short runs lies in its interval where the diagnosis saw something.

For 6 to 12 turning points: how often the gate fires, how often the averaged north of those runs
holds the true mean over the run, and its interval against that of the base model. Asked: at least
.93 of all that fired. SURVEYAPP_BENCH_RUNS is the number of runs a line (four times as many clean
ones: they seldom fire); SURVEYAPP_BENCH_STORE a folder in which finished lines are kept.
"""

from __future__ import annotations

import os

import numpy as np

from bench._records import Truth, problems
from bench._stored import stored
from surveyapp.diagnosis import diagnose
from surveyapp_models.angles import wrap_pi

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "60"))
SIZES = (6, 8, 10, 12)
TRUTHS: dict[str, dict[str, object]] = {
    "clean": {},
    "drift 3": {"drift": 3.0},
    "step 25": {"step": 25.0},
    "warm-up 40": {"warm_up": 40.0},
    "dry friction 30": {"friction": 30.0},
    "gross error 60": {"gross": (60.0,)},
    "two gross errors 60": {"gross": (60.0, 60.0)},
    "pulse 30": {"pulse": 30.0},
    "random walk 9": {"walk": 9.0},
    "AR(1) rho .6": {"ar1": 0.6},
}


def kept(name: str, sizes: dict[str, object], n: int) -> tuple[int, int, int, list[float]]:
    """One line, read again where it was finished before."""
    return tuple(stored(f"short {name} {n}", (sizes, RUNS), lambda: line(name, sizes, n)))


def line(name: str, sizes: dict[str, object], n: int) -> tuple[int, int, int, list[float]]:
    """Runs, fired ones, of these the ones that hold, and widths over the base's."""
    runs = RUNS * (4 if name == "clean" else 1)
    made, north = problems(Truth(name, n, **sizes), runs, 9000 + n)  # type: ignore[arg-type]
    fired = inside = 0
    widths = []
    for case, truth in zip(made, north.tolist(), strict=True):
        found = diagnose(case, draws=500, advise=False)
        if found.verdict == "adequate" or found.averaged.interval95 is None:
            continue
        fired += 1
        inside += abs(wrap_pi(found.averaged.value - truth)) <= found.averaged.interval95
        widths.append(found.averaged.interval95 / (found.before.value.interval95 or np.inf))
    return runs, fired, inside, widths


def run() -> list[str]:
    """Evaluate every line."""
    text = [
        "| truth | fired of runs | covered where fired | width over the base |",
        "|---|---|---|---|",
    ]
    every = []
    for name, sizes in TRUTHS.items():
        parts = [kept(name, sizes, n) for n in SIZES]
        every += parts
        runs = sum(p[0] for p in parts)
        fired, inside = sum(p[1] for p in parts), sum(p[2] for p in parts)
        widths = np.concatenate([p[3] for p in parts])
        wide = f"{np.median(widths):.2f}" if widths.size else "-"
        text.append(f"| {name} | {fired}/{runs} | {inside / max(fired, 1):.3f} | {wide} |")
    runs, fired, inside = (sum(column) for column in list(zip(*every, strict=True))[:3])
    text.append(f"| all together (asked: .93) | {fired}/{runs} | {inside / fired:.3f} | |")
    return text
