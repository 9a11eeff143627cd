"""Sessions worked by random keystrokes, by default 2000.

No confirmed row is lost, altered or doubled, no text is booked under another kind, and every
reader reads the book. ``SURVEYAPP_FROM``, ``SURVEYAPP_COUNT``, ``SURVEYAPP_SECONDS`` take a part.
"""

from __future__ import annotations

import asyncio
import os
import tempfile
from pathlib import Path

from bench._parts import FaultsFoundError, Part
from tests.tui.random_keys import random_session

SESSIONS, KEYS = 2000, 60


def run() -> list[str]:
    """One line, and one for each session with a fault."""
    part = Part(SESSIONS)
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
