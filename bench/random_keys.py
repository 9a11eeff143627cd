"""Sessions worked by random keystrokes, by default 2000.

No confirmed row is lost, altered or doubled, no text is booked under another kind, and every
reader reads the book. Nothing is painted here (the suite's sessions are): that is a third of the
time. ``SURVEYAPP_FROM``, ``SURVEYAPP_COUNT``, ``SURVEYAPP_SECONDS`` take a part.
"""

from __future__ import annotations

import asyncio
import os
import tempfile
from pathlib import Path

from textual import _wait
from textual.screen import Screen

from bench._parts import FaultsFoundError, Part
from tests.tui.random_keys import random_session

SESSIONS, KEYS = 2000, 60


def unpainted(screen: Screen[object]) -> None:
    """Take a screen's dirty parts as painted."""
    screen._dirty_widgets.clear()
    screen._compositor._dirty_regions.clear()


def run() -> list[str]:
    """One line, and one for each session with a fault."""
    part = Part(SESSIONS)
    Screen._compositor_refresh = unpainted  # type: ignore[method-assign, assignment]
    _wait.SLEEP_GRANULARITY, _wait.SLEEP_IDLE = 1.0 / 200.0, 1.0 / 4000.0
    os.environ["TEXTUAL_ANIMATIONS"] = "none"
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CONFIG_HOME"] = folder
        for seed in part:
            try:
                asyncio.run(random_session(Path(folder) / f"s{seed}", seed, keys=KEYS))
            except Exception as error:
                faults.append(f"  seed {seed}: {type(error).__name__}: {error}")
    lines = [f"{part.done} sessions of random keys: {len(faults)} with a fault; seeds {part.told}"]
    if faults:
        raise FaultsFoundError([*lines, *faults[:20]])
    return lines
