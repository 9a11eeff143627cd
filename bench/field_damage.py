"""Damage to field files in every dialect: how often it is named, harmless, or silently wrong.

Files are drawn as in ``tests.formats.dialects``; each gets one damage of every kind. ``wrong`` is
a row that differs from the truth although ``--skip-damaged`` left lines out.
"""

from __future__ import annotations

import random
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from tests.formats.damaging import FREE_COLUMNS, KINDS, damaged, outcome, read, reading
from tests.formats.dialects import DIALECTS

FILES = 300
OUTCOMES = ("named", "refused", "harmless", "missing", "silent", "wrong")


def run() -> Iterator[str]:
    """A line for each format and kind of damage."""
    yield f"{'format':<8} {'damage':<8} " + " ".join(f"{name:>8}" for name in OUTCOMES)
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "f"
        for form, draw in DIALECTS.items():
            r = random.Random(form)
            counts: dict[str, Counter[str]] = {kind: Counter() for kind in KINDS}
            for seed in range(FILES):
                written = draw(random.Random(f"d{form}{seed}"))
                if len(written.lines) < 5:
                    continue
                truth = Counter(reading(p) for p in read(file, written, written.lines).pointings)
                for kind in KINDS:
                    made = damaged(written.lines, kind, r)
                    if made is not None and not (
                        form in FREE_COLUMNS and kind in ("drop", "double")
                    ):
                        counts[kind][outcome(file, written, truth, made, kind=kind)] += 1
            for kind, found in counts.items():
                numbers = " ".join(f"{found[name]:8d}" for name in OUTCOMES)
                yield f"{form:<8} {kind:<8} {numbers}"
