"""Results of a part of a campaign, kept so that a campaign can be stopped and gone on with.

``SURVEYAPP_BENCH_STORE`` is a folder; without it nothing is kept. A part is known by its name, its
numbers and the program that made it: after a change of the source every part runs anew.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

STORE = os.environ.get("SURVEYAPP_BENCH_STORE")
_ROOTS = ("surveyapp/core", "surveyapp/diagnosis", "models/surveyapp_models")


@cache
def _program() -> str:
    """Digest of the sources that a campaign of sensors may call."""
    total = hashlib.sha256()
    root = Path(__file__).parents[1]
    for place in _ROOTS:
        for file in sorted((root / place).rglob("*.py")):
            total.update(file.read_bytes())
    return total.hexdigest()


def stored(name: str, key: object, make: Callable[[], Any]) -> Any:
    """A part of a campaign: read again where it was finished before, else made and kept.

    Parameters
    ----------
    name : str
        For the file; words are joined by hyphens.
    key : object
        What the part depends on beside the program: its ``repr`` counts.
    make : callable
        Returns what JSON can hold.
    """
    if STORE is None:
        return make()
    digest = hashlib.sha256(f"{_program()} {name} {key!r}".encode()).hexdigest()[:16]
    word = "-".join("".join(c if c.isalnum() else " " for c in name).split())
    file = Path(STORE) / f"{word}-{digest}.json"
    if not file.exists():
        file.parent.mkdir(parents=True, exist_ok=True)
        part = file.with_suffix(".part")
        part.write_text(json.dumps(make()), encoding="utf-8")
        part.replace(file)
    return json.loads(file.read_text(encoding="utf-8"))
