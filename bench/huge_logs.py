"""Sensor logs of 1e7 rows: seconds, and megabytes beyond what the same command takes of 1e4 rows.

Each command runs in a process of its own on a short log of the same kind first: what it has taken
then is the interpreter, the libraries and what every log takes. The growth from there to the end of
the long log is what the length of a log costs. The logs are declared simulation.
SURVEYAPP_BENCH_ROWS=N takes other lengths, SURVEYAPP_BENCH_STORE=DIR keeps the logs.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path

import numpy as np

ROWS = int(os.environ.get("SURVEYAPP_BENCH_ROWS", "10000000"))
SHORT = 10_000
LIMIT_MB = 100.0
BLOCK = 100_000
RATE_HZ = 100.0

_CHILD = """
import json, pathlib, resource, sys
from surveyapp import api
from surveyapp.errors import SurveyError
name, short, long, keywords = sys.argv[1:5]
def peak():
    # ru_maxrss of a child begins with that of its parent, VmHWM of Linux does not
    status = pathlib.Path("/proc/self/status")
    if status.exists():
        lines = status.read_text().splitlines()
        return float(next(line for line in lines if line.startswith("VmHWM")).split()[1]) / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
def spent():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime
told = []
def run(file, progress):
    given = {k: v.replace("{file}", file) if isinstance(v, str) else v
             for k, v in json.loads(keywords).items()}
    first = [given.pop("kind")] if "kind" in given else []
    try:
        return getattr(api, name)(*first, file, progress=progress, **given)
    except SurveyError as error:
        return error.problems[0].what
run(short, None)
before, begun = peak(), spent()
result = run(long, told.append)
said = result if isinstance(result, str) else type(result).__name__
print(before, peak(), spent() - begun, len(told), said)
"""


def _vectors(rng: np.random.Generator, rows: int) -> dict[str, np.ndarray]:
    """Field [uT] and specific force [m/s2] of a compass in every attitude, with iron."""
    axis = rng.standard_normal((rows, 4))
    w, x, y, z = (axis / np.linalg.norm(axis, axis=1)[:, None]).T
    up = np.column_stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x**2 + y**2)])
    north = np.column_stack([2 * (x * y + w * z), 1 - 2 * (x**2 + z**2), 2 * (y * z - w * x)])
    field = 20.0 * north - 44.0 * up
    iron = np.array([[1.05, 0.02, 0.0], [0.02, 0.97, 0.01], [0.0, 0.01, 1.0]])
    field = field @ iron + np.array([8.0, -5.0, 3.0]) + 0.3 * rng.standard_normal((rows, 3))
    force = 9.81 * up + 0.02 * rng.standard_normal((rows, 3))
    made = {f"mag_{a}_uT": field[:, i] for i, a in enumerate("xyz")}
    return made | {f"acc_{a}_m_s2": force[:, i] for i, a in enumerate("xyz")}


def _tilts(rng: np.random.Generator, rows: int) -> dict[str, np.ndarray]:
    """Two axes [arcsec] with cross axis and temperature, against a reference."""
    along, across = rng.uniform(-600.0, 600.0, (2, rows))
    warmth = np.round(rng.uniform(0.0, 40.0, rows), 1)
    noise = rng.standard_normal((2, rows))
    return {
        "tilt_along_arcsec": 3.0 + 1.01 * along + 0.02 * across + 0.5 * (warmth - 20.0) + noise[0],
        "tilt_across_arcsec": -2.0 + 0.99 * across - 0.01 * along + noise[1],
        "ref_along_arcsec": along,
        "ref_across_arcsec": across,
        "temperature_c": warmth,
    }


def _noise(rng: np.random.Generator, rows: int) -> dict[str, np.ndarray]:
    """A gyro [rad/s]: white noise and a slow swing that stands for drift."""
    return {"gyr_z_rad_s": 1e-3 * rng.standard_normal(rows) + 1e-4}


def _drives(rng: np.random.Generator, rows: int) -> dict[str, np.ndarray]:
    """A minute over and over: rest, driving off, a way, braking, rest; it shakes on its way."""
    phase = np.arange(rows) / RATE_HZ % 60.0
    pushed = 0.4 * (((phase >= 30.0) & (phase < 35.0)) * 1.0 - ((phase >= 50.0) & (phase < 55.0)))
    moving = (phase >= 30.0) & (phase < 55.0)
    force = np.array([0.0, 0.0, 9.81]) + 0.02 * rng.standard_normal((rows, 3))
    force += 0.15 * moving[:, None] * rng.standard_normal((rows, 3))
    force[:, 1] += pushed
    rate = 1e-3 * (1.0 + moving[:, None]) * rng.standard_normal((rows, 3)) + 1e-4
    made = {f"acc_{a}_m_s2": force[:, i] for i, a in enumerate("xyz")}
    return made | {f"gyr_{a}_rad_s": rate[:, i] for i, a in enumerate("xyz")}


def _ways(rng: np.random.Generator, rows: int) -> dict[str, np.ndarray]:
    """The same drive with its odometer, which turns 18 degrees to the right on its way."""
    made = _drives(rng, rows)
    phase = np.arange(rows) / RATE_HZ % 60.0
    made["gyr_z_rad_s"] -= 0.0628 * ((phase >= 40.0) & (phase < 45.0))
    speed = 0.4 * (np.clip(phase - 30.0, 0.0, 5.0) - np.clip(phase - 50.0, 0.0, 5.0))
    made["odometer_m"] = np.cumsum(speed) / RATE_HZ
    return made


KINDS = {"compass": _vectors, "tilt": _tilts, "noise": _noise, "drive": _drives, "way": _ways}


def write_log(path: Path, kind: str, rows: int) -> None:
    """A log of so many rows at 100 Hz; one block of rows at a time."""
    rng, driven = np.random.default_rng(7), 0.0
    with path.open("w", encoding="utf-8") as stream:
        for start in range(0, rows, BLOCK):
            size = min(BLOCK, rows - start)
            columns = KINDS[kind](rng, size)
            if "odometer_m" in columns:
                columns["odometer_m"] += driven
                driven = columns["odometer_m"][-1]
            if start == 0:
                stream.write(",".join(["time_s", *columns]) + "\n")
            cells = [[f"{t:.2f}" for t in ((start + np.arange(size)) / RATE_HZ).tolist()]]
            cells += [[f"{v:.7g}" for v in values.tolist()] for values in columns.values()]
            stream.writelines(",".join(row) + "\n" for row in zip(*cells, strict=True))


def _commands(folder: Path) -> Iterator[tuple[str, str, str, dict[str, object]]]:
    """Title, kind of log, function of the API, keywords."""
    compass, tilt, out = (str(folder / n) for n in ("compass.toml", "tilt.toml", "out.csv"))
    yield "calibrate compass", "compass", "calibrate", {"kind": "compass", "card": compass}
    yield "calibrate tilt", "tilt", "calibrate", {"kind": "tilt", "card": tilt}
    for kind, card in (("compass", compass), ("tilt", tilt)):
        yield f"compensate {kind}", kind, "compensate", {"kind": kind, "card": card, "out": out}
    yield "allan", "noise", "allan", {}
    yield "filter kalman -o", "noise", "filter_log", {"name": "kalman", "out": out}
    yield "filter sage-husa", "noise", "filter_log", {"name": "sage-husa"}
    yield "spectrum", "noise", "spectrum", {"column": "gyr_z_rad_s"}
    yield "motion", "drive", "motion", {}
    yield "motion --path", "drive", "motion", {"options": {"path": True}}
    yield "motion, odometer", "way", "motion", {"options": {"path": True}}
    snapping = {"path": True, "snap": True, "end": "0,0"}
    yield "motion --snap", "way", "motion", {"options": snapping}
    yield "diagnose compass", "compass", "diagnose_log", {}


def _measured(command: tuple[str, str, dict[str, object]], logs: tuple[Path, Path]) -> str:
    _, name, keywords = command
    done = subprocess.run(
        [sys.executable, "-c", _CHILD, name, *map(str, logs), json.dumps(keywords)],
        check=True,
        capture_output=True,
        text=True,
    )
    before, peak, seconds, told, said = done.stdout.strip().split(" ", 4)
    grown = float(peak) - float(before)
    verdict = "met" if grown < LIMIT_MB and int(told) > 10 else "NOT MET"
    return (
        f"{float(seconds):6.1f} s  {float(before):4.0f} MB and {grown:4.0f} more of at most "
        f"{LIMIT_MB:.0f}  progress told {told} times  {verdict}  {said}"
    )


def run() -> Iterator[str]:
    """One line for each command."""
    kept = os.environ.get("SURVEYAPP_BENCH_STORE")
    with nullcontext(kept) if kept else tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for kind in KINDS:
            for rows in (SHORT, ROWS):
                path = folder / f"{kind}-{rows}.csv"
                if not path.exists():
                    write_log(path, kind, rows)
        for title, kind, function, keywords in _commands(folder):
            logs = (folder / f"{kind}-{SHORT}.csv", folder / f"{kind}-{ROWS}.csv")
            yield f"{title:<20} {_measured((kind, function, keywords), logs)}"
