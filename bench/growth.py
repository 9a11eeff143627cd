"""How time and memory grow with the sessions of one project: ``orient`` and ``report``.

A programme of a mine with many gyro sides: every tenth session stands on one of two known lines
(at most ``CALIBRATIONS`` of them), the others orient sides of 400 m four times each. Automatic
sessions of three rounds, and tracking runs of eight turning points beside them. Every measurement
is a process of its own, so that its memory is its own; on an idle machine it says what the program
takes, beside others it is an upper bound (processor seconds are printed as well).
"""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import sys
import tempfile
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np

ORIENT: Final = (100, 1000, 10_000)
REPORT: Final = (100, 1000)
RUNS: Final = (100, 1000)
TURNS: Final = 8
CALIBRATIONS: Final = 60
ROUNDS: Final = 4
SIDE_M: Final = 400.0
MOST_S: Final = 10.0
MOST_MB: Final = 250.0

WORKER = """
import json, resource, sys, time
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
from surveyapp import api
begin = time.perf_counter()
what, folder = sys.argv[1:3]
if what == "orient":
    api.orient(folder).to_dict()
else:
    api.report(folder, folder + "/record.pdf")
elapsed = time.perf_counter() - begin
usage = resource.getrusage(resource.RUSAGE_SELF)
print(json.dumps([elapsed, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024.0]))
"""


def dms(degrees: float) -> str:
    """An angle of a field book."""
    seconds = round((degrees % 360.0) * 36000.0) / 10.0
    minutes, rest = divmod(seconds, 60.0)
    return f"{int(minutes // 60)}-{int(minutes % 60):02d}-{rest:04.1f}"


def book(rng: np.random.Generator, line: float) -> str:
    """A tracking run and the sights of its target; gyro north at 0 of a circle set at random."""
    zero = rng.uniform(0.0, 360.0)
    rows = ["seq,elapsed_s,kind,value,face,side,target"]
    error = 4.0 / 3600.0

    def sights(seq: int) -> None:
        for place, face in enumerate("LR"):
            value = zero + line + 180.0 * place + rng.normal(0.0, 2.0 / 3600.0)
            rows.append(f"{seq + place},,backsight,{dms(value)},{face},,B")

    sights(1)
    for k in range(TURNS):
        side = 1.0 if k % 2 == 0 else -1.0
        value = zero + 3.0 * side * math.exp(-0.007 * k) + rng.normal(0.0, error)
        rows.append(
            f"{k + 3},{212.7 * (k + 1):.1f},reversal,{dms(value)},,{'R' if side > 0 else 'L'},"
        )
    sights(TURNS + 3)
    return "\n".join(rows) + "\n"


def rounds(rng: np.random.Generator, line: float) -> str:
    """Three rounds of an automatic gyro."""
    rows = ["seq,kind,value"]
    rows += [f"{k},azimuth,{dms(line + rng.normal(0.0, 4.0 / 3600.0))}" for k in range(1, 4)]
    return "\n".join(rows) + "\n"


def write_project(folder: Path, count: int, *, tracking: bool = False, seed: int = 7) -> None:
    """Write a project of ``count`` sessions."""
    rng = np.random.default_rng(seed)
    (folder / "observations").mkdir(parents=True)
    sides = max(1, count // (ROUNDS + 1))
    text = ['format = 1\nname = "Growth"\ncrs = "EPSG:25832"']
    card = "wild-gak1" if tracking else "mom-gi-b3"
    text.append(f'[[instrument]]\nid = "G"\ncard = "{card}"')
    for i in range(sides + 1):
        east, north = 500_000.0 + SIDE_M * (i % 40), 5_600_000.0 + SIDE_M * (i // 40)
        text.append(f'[[station]]\nname = "P{i}"\ne = {east}\nn = {north}')
    for name, east in (("K1", 499_000.0), ("K2", 499_300.0)):
        text.append(f'[[station]]\nname = "{name}"\ne = {east}\nn = 5599000.0\nfixed = true')
    every = max(10, count // CALIBRATIONS)
    method = "tracking" if tracking else "automatic"
    for number in range(count):
        known = number % every == 0
        start, end = ("K1", "K2") if known else (f"P{number % sides}", f"P{number % sides + 1}")
        text.append(
            f'[[orientation]]\nid = "s{number:05d}"\nstation = "{start}"\ntarget = "{end}"\n'
            f'instrument = "G"\nmethod = "{method}"\norder = {number}\n'
            f'purpose = "{"calibration" if known else "survey"}"\n'
            f'book = "observations/s{number:05d}.csv"'
        )
        own = book(rng, 90.0).replace(",B\n", f",{end}\n") if tracking else rounds(rng, 90.0)
        (folder / "observations" / f"s{number:05d}.csv").write_text(own, encoding="utf-8")
    (folder / "project.toml").write_text("\n".join(text) + "\n", encoding="utf-8")


def measure(what: str, folder: Path) -> tuple[float, float, float]:
    """Seconds, processor seconds and megabytes of one command; infinite beyond 4 GB."""
    answer = subprocess.run(
        [sys.executable, "-c", WORKER, what, str(folder)],
        check=False,
        capture_output=True,
        text=True,
    )
    if answer.returncode:
        return math.inf, math.inf, math.inf
    elapsed, cpu, megabytes = json.loads(answer.stdout)
    return elapsed, cpu, megabytes


def run() -> list[str]:
    """Tables of growth, with what is allowed."""
    lines = []
    root = Path(tempfile.mkdtemp(prefix="growth-"))
    try:
        for count in ORIENT:
            write_project(root / str(count), count)
        for count in RUNS:
            write_project(root / f"runs {count}", count, tracking=True)
        for what, title, names in (
            ("orient", "orient", [str(n) for n in ORIENT]),
            ("orient", "orient, tracking runs", [f"runs {n}" for n in RUNS]),
            ("report", "report", [str(n) for n in REPORT]),
            ("report", "report, tracking runs", [f"runs {n}" for n in RUNS]),
        ):
            lines += _table(title, [(int(n.split()[-1]), *measure(what, root / n)) for n in names])
    finally:
        shutil.rmtree(root, ignore_errors=True)
    return lines


def _table(title: str, found: list[tuple[int, float, float, float]]) -> list[str]:
    lines = [f"{title:24s}{'sessions':>9s}{'s':>8s}{'cpu s':>8s}{'MB':>7s}"]
    lines += [f"{'':24s}{n:9d}{s:8.2f}{cpu:8.2f}{mb:7.0f}" for n, s, cpu, mb in found]
    for (a, _, first, _), (b, _, second, _) in pairwise(found):
        power = math.log(second / first) / math.log(b / a) if second < math.inf else math.inf
        lines.append(f"{'':24s}{a} -> {b}: processor time grows with the power {power:.2f}")
    _, _, cpu, megabytes = found[-1]
    verdict = "met" if cpu <= MOST_S and megabytes <= MOST_MB else "NOT MET"
    lines.append(f"{'':24s}{verdict}: within {MOST_S:g} s and {MOST_MB:g} MB")
    return lines


if __name__ == "__main__":
    print("\n".join(run()))
