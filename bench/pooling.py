"""What pooling the runs of one instrument is worth, and how fast an archive is pooled.

For 1, 2, 4 and 8 runs of 8 points: how often clean runs alarm, how often an effect of the
instrument is named rightly, how often a wandering north gets a name. Then an archive of projects
is written, read and pooled through two processes. SURVEYAPP_BENCH_RUNS is the number of sets a
cell, SURVEYAPP_BENCH_STORE a folder in which finished cells are kept.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from bench._records import Truth, problems
from bench._stored import stored
from surveyapp import api
from surveyapp.diagnosis.pooling import pool
from surveyapp.domain.project import Project

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "100"))
SETS = (1, 2, 4, 8)
POINTS = 8
ARCHIVE_PROJECTS = int(os.environ.get("SURVEYAPP_BENCH_PROJECTS", "250"))
"""Of four sessions each."""
LINES: tuple[tuple[str, str, dict[str, float]], ...] = (
    ("clean", "", {}),
    ("drift 3", "midpoint_drift", {"drift": 3.0}),
    ("warm-up 40", "warm_up", {"warm_up": 40.0}),
    ("damping .002", "damping_break", {"damping_change": 0.002}),
    ("walk 9", "", {"walk": 9.0}),
)


def kept(name: str, effect: str, sizes: dict[str, float], count: int) -> list[float]:
    """One cell, read again where it was finished before."""
    return list(
        stored(f"pool {name} {count}", (sizes, RUNS), lambda: cell(name, effect, sizes, count))
    )


def cell(name: str, effect: str, sizes: dict[str, float], count: int) -> tuple[float, float, float]:
    """Shares of sets that alarm, that are rightly and that are wrongly named.

    A set is of one instrument: sign and time of warming up are those of its runs.
    """
    truth = Truth(name, POINTS, effect, one_sign=True, **sizes)  # type: ignore[arg-type]
    sets = [problems(truth, count, 1000 * count + i)[0] for i in range(RUNS)]
    found = [pool(cases, np.random.default_rng(i)) for i, cases in enumerate(sets)]
    names = [item.named.effect if item.named is not None else "" for item in found]
    return (
        float(np.mean([item.fired for item in found])),
        float(np.mean([bool(effect) and n == effect for n in names])),
        float(np.mean([bool(n) and n != effect for n in names])),
    )


def archive_time() -> tuple[int, float, float]:
    """Sessions of an archive, and the seconds in which two processes read and pool them.

    Elapsed, and of the processors: on a machine that does other work only these tell.
    """
    with tempfile.TemporaryDirectory() as place:
        root = Path(place)
        first = root / "p0"
        api.simulate("reversal-run", first, effects=["midpoint_drift=3"], seed=1)
        for i in range(1, ARCHIVE_PROJECTS):
            shutil.copytree(first, root / f"p{i}")
        project: Project = api.open_project(first)
        sessions = ARCHIVE_PROJECTS * len(project.sessions)
        before = sum(os.times()[:4])
        with ProcessPoolExecutor(2) as executor:
            list(executor.map(abs, range(2)))  # the workers are there
            start = time.perf_counter()
            api.diagnose_instrument(first, "G1", archive=[root], executor=executor)
            elapsed = time.perf_counter() - start
        used = sum(os.times()[:4]) - before
        return sessions, elapsed, used


def run() -> list[str]:
    """The table and the time of an archive."""
    text = [f"| runs of {POINTS} points | alarm | right | wrong |", "|---|---|---|---|"]
    for name, effect, sizes in LINES:
        cells = [kept(name, effect, sizes, count) for count in SETS]
        columns = [" / ".join(f"{c[k]:.2f}" for c in cells) for k in range(3)]
        text.append(f"| {name}, {' / '.join(map(str, SETS))} | {' | '.join(columns)} |")
    sessions, seconds, used = archive_time()
    text.append(
        f"archive of {sessions} sessions read and pooled in {seconds:.1f} s, two processes "
        f"({used:.1f} s of the processors; asked: 60 s on two)"
    )
    return text
