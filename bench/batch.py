"""Many projects through ``batch``: two processes against one, memory, broken ones named.

Every run is a process of its own, so that its memory is its own; the projects are simulated runs
(four sessions each), ten of a thousand are broken in different ways.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from surveyapp.core.simulate.project import project_files, simulate_reversal_project
from surveyapp.core.simulate.specification import SessionSpec

COUNT = 1000
BROKEN = 10
KINDS = 20
TURNS = 4
ROOT = Path(__file__).resolve().parent.parent

WORKER = """
import json, resource, sys, time
from pathlib import Path
from surveyapp import api
from surveyapp.api.batch import batch_row
folder, jobs, output = sys.argv[1], int(sys.argv[2]), sys.argv[3]
first, last = int(sys.argv[4]), int(sys.argv[5])
paths = sorted(str(path) for path in Path(folder).iterdir())[first:last]
batch_row(paths[0])
before = sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
begin = time.perf_counter()
result = api.batch(paths, output, jobs=jobs)
elapsed = time.perf_counter() - begin
cpu = sum(sum(resource.getrusage(who)[:2]) for who in (
    resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)) - before
peak = max(resource.getrusage(who).ru_maxrss for who in (
    resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)) / 1024.0
print(json.dumps([elapsed, cpu, peak, result.good + result.limit, list(result.failures)]))
"""


def make_projects(folder: Path, count: int) -> list[str]:
    """Write simulated projects, and return the names of those that were broken on purpose."""
    rng = np.random.default_rng(1966)
    spec = SessionSpec(latitude=math.radians(47.0))
    kinds = [project_files(simulate_reversal_project(spec, rng)) for _ in range(KINDS)]
    for index in range(count):
        for name, text in kinds[index % KINDS].items():
            path = folder / f"p{index:04d}" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
    step = max(1, count // BROKEN)
    names = [f"p{index:04d}" for index in range(step // 2, count, step)]
    for number, name in enumerate(names):
        BREAKS[number % len(BREAKS)](folder / name)
    return names


def _truncate(folder: Path) -> None:
    path = folder / "project.toml"
    path.write_text(path.read_text(encoding="utf-8")[:300] + "\nname = [", encoding="utf-8")


def _without_book(folder: Path) -> None:
    shutil.rmtree(folder / "observations")


def _binary_book(folder: Path) -> None:
    next((folder / "observations").iterdir()).write_bytes(b"\x89PNG\r\n\x1a\n\x00\x00")


def _typing_error(folder: Path) -> None:
    path = next((folder / "observations").iterdir())
    path.write_text(path.read_text(encoding="utf-8").replace("dms", "gom"), encoding="utf-8")


def _newer(folder: Path) -> None:
    path = folder / "project.toml"
    text = path.read_text(encoding="utf-8").replace("format = 1", "format = 2")
    path.write_text(text, encoding="utf-8")


BREAKS: tuple[Callable[[Path], None], ...] = (
    _truncate,
    _without_book,
    _binary_book,
    _typing_error,
    _newer,
)


@dataclass(frozen=True, slots=True)
class Measured:
    """One run: wall and processor seconds, peak memory [MB], projects computed, failures."""

    elapsed_s: float
    cpu_s: float
    peak_mb: float
    computed: int
    failures: tuple[str, ...]


def measure(folder: Path, jobs: int, first: int, last: int) -> Measured:
    """Run one batch in a process of its own."""
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "models"))),
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
    }
    with tempfile.TemporaryDirectory() as output:
        table = str(Path(output) / "batch.csv")
        arguments = [str(folder), str(jobs), table, str(first), str(last)]
        command = [sys.executable, "-c", WORKER, *arguments]
        done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    elapsed, cpu, peak, computed, failures = json.loads(done.stdout)
    return Measured(elapsed, cpu, peak, computed, tuple(Path(path).name for path, _ in failures))


def side_by_side(folder: Path, first: int, last: int) -> float:
    """Seconds of two programs of one process each, started at once: what the machine has free."""
    middle = (first + last) // 2
    with ThreadPoolExecutor(2) as pool:
        begin = time.perf_counter()
        list(pool.map(lambda part: measure(folder, 1, *part), ((first, middle), (middle, last))))
        return time.perf_counter() - begin


def run(count: int = COUNT) -> list[str]:
    """Lines of the benchmark; one and two processes take turns, so that both see one machine."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        broken = make_projects(folder, count)
        whole = measure(folder, 1, 0, count)
        tenth = measure(folder, 1, 0, count // 10)
        edges = [count * turn // TURNS for turn in range(TURNS + 1)]
        pairs, side = [], 0.0
        for first, last in pairwise(edges):
            pairs.append((measure(folder, 1, first, last), measure(folder, 2, first, last)))
            side += side_by_side(folder, first, last)
    wall, cpu = (
        [sum(getattr(pair[which], what) for pair in pairs) for which in (0, 1)]
        for what in ("elapsed_s", "cpu_s")
    )
    named = "all" if sorted(whole.failures) == broken else "NOT ALL"
    return [
        f"{count} projects of 4 sessions: {whole.computed} computed, {len(whole.failures)} failed",
        f"one process {wall[0]:.1f} s, {count / cpu[0]:.0f} projects a processor second",
        f"two processes {wall[1]:.1f} s: {wall[0] / wall[1]:.2f} times the throughput",
        f"two programs side by side {side:.1f} s with their start: the peer of two processes, "
        f"{wall[0] / side:.2f} times one",
        f"processor time of two against one: {cpu[1] / cpu[0]:.2f} times, so that two free cores "
        f"give at most {2.0 * cpu[0] / cpu[1]:.2f} times",
        f"peak memory {tenth.peak_mb:.0f} MB after {count // 10}, {whole.peak_mb:.0f} MB after "
        f"{count} projects",
        f"broken ones named: {named} of {len(broken)}",
    ]
