"""A real terminal, typed into and killed with SIGKILL at seeded random moments.

What the screen said was on the disk must be there, once and unaltered, and the step must be right
when the session is opened again. ``run()`` does it 100 times; the test suite takes a few of them.
"""

from __future__ import annotations

import os
import re
import signal
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pexpect

from surveyapp.core.observing.steps import STEP_NOTE, Step
from surveyapp.domain.readings import ReadingKind
from surveyapp.io.fieldbook import COLUMNS
from surveyapp.observation import session as api_session
from surveyapp_models.angles import ARCSEC, AngleUnit, format_angle

ROOT = Path(__file__).resolve().parents[1]
KILLS = 100
F8 = "\x1b[19~"
PROJECT = """\
format = 1
name = "Kill"
angle_unit = "dms"
[[instrument]]
id = "G1"
card = "wild-gak1"
[[station]]
name = "A"
lat = 47.0
lon = 8.0
[[station]]
name = "B"
[[orientation]]
id = "r1"
station = "A"
target = "B"
instrument = "G1"
method = "tracking"
book = "observations/r1.csv"
"""
_ESCAPES = re.compile(r"\x1b\[[0-9;?]*[ -/]*[@-~]|\x1b[()][A-Z0-9]|\x1b[=>]")
_CONFIRMED = re.compile(r"on disk: row (\d+), [a-z ]+? ([-+0-9.]+)")


@dataclass(frozen=True, slots=True)
class Act:
    """One thing that is typed, and the row that it makes."""

    keys: str
    kind: ReadingKind
    text: str


@dataclass(frozen=True, slots=True)
class Outcome:
    """What was found after one kill; ``faults`` is empty if all was well."""

    seed: int
    confirmed: int
    rows: int
    faults: tuple[str, ...]


def script(rng: np.random.Generator) -> list[Act]:
    """A session: sights, tape zero, run-up, turning points."""
    acts = [_go(Step.SIGHTS_BEFORE), _typed(ReadingKind.BACKSIGHT, "175-00-09")]
    acts.append(_typed(ReadingKind.BACKSIGHT, "354-59-48"))
    acts.append(_go(Step.ZERO_BEFORE))
    acts += [_typed(ReadingKind.TAPE_ZERO, text) for text in ("4.1", "-3.6", "3.9")]
    acts += [_go(Step.RUN_UP), _go(Step.SWING)]
    for k in range(12):
        offset = 7200.0 * (-1) ** k * 0.995**k + rng.normal(scale=3.0)
        reading = format_angle(np.radians(100.0) + offset * ARCSEC, AngleUnit.DMS, 1)
        acts.append(_typed(ReadingKind.REVERSAL, reading))
    acts += [_go(Step.ZERO_AFTER), _typed(ReadingKind.TAPE_ZERO, "3.7")]
    return acts


def _typed(kind: ReadingKind, text: str) -> Act:
    return Act(text + "\r\r", kind, text)  # the second Enter answers a question, if one is asked


def _go(step: Step) -> Act:
    return Act(F8, ReadingKind.NOTE, f"{STEP_NOTE}{step}")


def make_project(folder: Path) -> None:
    """A project whose session stands at its first step."""
    (folder / "observations").mkdir(parents=True)
    (folder / "project.toml").write_text(PROJECT, encoding="utf-8")
    (folder / "observations" / "r1.csv").write_text(",".join(COLUMNS) + "\n", encoding="utf-8")
    seen = api_session.SessionDesk(folder, "r1")
    seen.record(api_session.NewRow(ReadingKind.NOTE, note=f"{STEP_NOTE}{Step.SETUP}"))
    seen.close()


def start(folder: Path, log: Path) -> pexpect.spawn[bytes]:
    """The program in a terminal of 80x24."""
    environment = {
        **os.environ,
        "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'models'}",
        "TERM": "xterm-256color",
        "XDG_CONFIG_HOME": str(folder.parent / "config"),
        "TEXTUAL_ANIMATIONS": "none",
    }
    child: pexpect.spawn[bytes] = pexpect.spawn(
        sys.executable,
        ["-m", "surveyapp", "open", str(folder)],
        env=environment,
        dimensions=(24, 80),
        timeout=20,
    )
    child.delaybeforesend = None
    child.logfile_read = log.open("wb")
    return child


def stop(child: pexpect.spawn[bytes]) -> None:
    """End a terminal that was started here."""
    child.close(force=True)
    child.logfile_read.close()


def plain(log: Path) -> str:
    """What the terminal was sent, without its escape sequences."""
    return _ESCAPES.sub("", log.read_bytes().decode("utf-8", errors="replace"))


def run_once(folder: Path, seed: int) -> Outcome:
    """Type, kill, and look at what is left."""
    rng = np.random.default_rng(seed)
    make_project(folder)
    log = folder.parent / "first.log"
    child = start(folder, log)
    child.expect(rb"level along")
    acts = script(rng)
    deadline = time.monotonic() + float(rng.uniform(0.0, 3.0))
    _type(child, acts, deadline, rng)
    os.kill(child.pid, signal.SIGKILL)
    stop(child)
    confirmed = [(int(seq), text) for seq, text in _CONFIRMED.findall(plain(log))]
    return _judge(folder, seed, acts, confirmed)


def _type(
    child: pexpect.spawn[bytes], acts: list[Act], deadline: float, rng: np.random.Generator
) -> None:
    """Type until the deadline; sometimes faster than the screen answers."""
    for act in acts:
        for key in [act.keys] if act.keys == F8 else act.keys:
            if time.monotonic() >= deadline:
                return
            child.send(key)
        pause = min(float(rng.uniform(0.0, 0.25)), max(deadline - time.monotonic(), 0.0))
        end = time.monotonic() + pause
        while time.monotonic() < end:
            _drain(child)
    while time.monotonic() < deadline:
        _drain(child)


def _drain(child: pexpect.spawn[bytes]) -> None:
    try:
        child.read_nonblocking(65536, timeout=0.02)
    except (pexpect.TIMEOUT, pexpect.EOF):
        time.sleep(0.005)


def _judge(folder: Path, seed: int, acts: list[Act], confirmed: list[tuple[int, str]]) -> Outcome:
    faults = []
    seen = api_session.SessionDesk(folder, "r1")
    rows = seen.book.rows[1:]
    found = [(row.kind, row.note if row.kind is ReadingKind.NOTE else row.text) for row in rows]
    wanted = [(act.kind, act.text) for act in acts[: len(found)]]
    if found != wanted:
        faults.append(f"the book holds {found}, typed was {wanted}")
    by_seq = {row.seq: row.text for row in rows}
    for seq, text in confirmed:
        if by_seq.get(seq) != text:
            faults.append(f"row {seq} was confirmed as {text}, the book has {by_seq.get(seq)}")
    if not seen.writable:
        faults.append("the lock of the killed program holds")
    steps = [Step(text.removeprefix(STEP_NOTE)) for kind, text in found if kind == "note"]
    step = steps[-1] if steps else Step.SETUP
    if seen.step is not step:
        faults.append(f"the step is {seen.step}, it was {step}")
    seen.close()
    return Outcome(seed, len(confirmed), len(rows), tuple(faults))


def run() -> list[str]:
    """A hundred kills."""
    outcomes = []
    for seed in range(KILLS):
        with tempfile.TemporaryDirectory() as place:
            outcomes.append(run_once(Path(place) / "p", seed))
    bad = [item for item in outcomes if item.faults]
    lines = [
        f"{len(outcomes)} kills: {sum(item.confirmed for item in outcomes)} confirmed rows, "
        f"{sum(item.rows for item in outcomes)} on disk, {len(bad)} faulty"
    ]
    lines += [f"  seed {item.seed}: {fault}" for item in bad for fault in item.faults]
    return lines
