"""Sessions worked by random keystrokes, by default 2000.

No confirmed row is lost, altered or doubled, no text is booked under another kind, and every
reader reads the book. ``SURVEYAPP_FROM`` and ``SURVEYAPP_COUNT`` take some of the seeds.
"""

from __future__ import annotations

import asyncio
import os
import tempfile
from pathlib import Path

from tests.tui.random_keys import random_session

SESSIONS, KEYS = 2000, 60


def run() -> list[str]:
    """One line, and one for each session with a fault."""
    first = int(os.environ.get("SURVEYAPP_FROM", "0"))
    count = int(os.environ.get("SURVEYAPP_COUNT", SESSIONS))
    os.environ["TEXTUAL_ANIMATIONS"] = "none"
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CONFIG_HOME"] = folder
        for seed in range(first, first + count):
            try:
                asyncio.run(random_session(Path(folder) / f"s{seed}", seed, keys=KEYS))
            except Exception as error:
                faults.append(f"  seed {seed}: {type(error).__name__}: {error}")
    told = f"{count} sessions of random keys (seeds {first} to {first + count - 1})"
    return [f"{told}: {len(faults)} with a fault", *faults[:20]]
