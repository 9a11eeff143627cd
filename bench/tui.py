"""The screens in a real terminal: first paint, key to screen, memory after a long session.

Peer in the same run: a bare interpreter that imports textual, the least that such a program costs.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pexpect

from bench.tui_kill import make_project, start, stop
from surveyapp.core.observing.steps import STEP_NOTE, Step
from surveyapp.domain.readings import ReadingKind
from surveyapp.observation import session as api_session
from surveyapp_models.angles import ARCSEC, AngleUnit, format_angle

POINTS = 45
KEYS = 60
TITLE = b"surveyapp|Kill|tracking"


def write_points(folder: Path, count: int) -> None:
    """A session that stands at its turning points with that many of them written."""
    make_project(folder)
    seen = api_session.SessionDesk(folder, "r1")
    seen.record(api_session.NewRow(ReadingKind.NOTE, note=f"{STEP_NOTE}{Step.SWING}"))
    rng = np.random.default_rng(45)
    for k in range(count):
        offset = 7200.0 * (-1) ** k * 0.99**k + rng.normal(scale=3.0)
        reading = format_angle(np.radians(100.0) + offset * ARCSEC, AngleUnit.DMS, 1)
        seen.record(api_session.NewRow(ReadingKind.REVERSAL, reading, "dms"))
    seen.close()


def first_paint_s(place: Path) -> float:
    """From the start of the program to the first title on the screen [s]."""
    folder = place / "p"
    write_points(folder, 0)
    begin = time.perf_counter()
    child = start(folder, place / "paint.log")
    child.expect(TITLE)
    seconds = time.perf_counter() - begin
    stop(child)
    return seconds


def bare_textual_s() -> float:
    """A bare interpreter that imports textual [s]."""
    begin = time.perf_counter()
    subprocess.run([sys.executable, "-c", "import textual.app, textual.widgets"], check=True)
    return time.perf_counter() - begin


def key_to_screen(place: Path) -> tuple[list[float], float]:
    """Delays from key to screen [s] with 45 points while each entry is judged, and memory [MB]."""
    folder = place / "p"
    write_points(folder, POINTS)
    child = start(folder, place / "keys.log")
    child.expect(rb"ENOUGH|wanted|no target")
    delays = []
    for number in range(KEYS):
        if number % 12 == 0:
            child.send("\x1b[15~")  # F5, a missed point: written, and the run judged anew behind
        delays.append(_delay(child, "1" if number % 2 == 0 else "\x7f"))
    memory = _memory_mb(child.pid)
    stop(child)
    return delays, memory


def _delay(child: pexpect.spawn[bytes], key: str) -> float:
    """Send a key when nothing moves and wait until the screen answers."""
    begin = time.perf_counter()
    child.send(key)
    while time.perf_counter() - begin < 2.0:
        try:
            if child.read_nonblocking(65536, timeout=0.5):
                break
        except pexpect.TIMEOUT:
            continue
    seconds = time.perf_counter() - begin
    quiet = time.perf_counter() + 0.03
    while time.perf_counter() < quiet:
        try:
            child.read_nonblocking(65536, timeout=0.01)
        except pexpect.TIMEOUT:
            continue
    return seconds


def _memory_mb(pid: int) -> float:
    status = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    match = re.search(r"VmRSS:\s+(\d+) kB", status)
    return float(match[1]) / 1024.0 if match else float("nan")


def run() -> list[str]:
    """The three figures."""
    with tempfile.TemporaryDirectory() as place:
        paint = first_paint_s(Path(place))
    with tempfile.TemporaryDirectory() as place:
        delays, memory = key_to_screen(Path(place))
    bare = bare_textual_s()
    p50, p95 = np.percentile(delays, [50.0, 95.0]) * 1000.0
    return [
        f"first paint {paint:.2f} s (target 1.0 s; bare import of textual {bare:.2f} s)",
        f"key to screen with {POINTS} points, run judged behind: median {p50:.0f} ms, "
        f"p95 {p95:.0f} ms (target 60 ms)",
        f"memory after {POINTS} points {memory:.0f} MB (target 200 MB)",
    ]
