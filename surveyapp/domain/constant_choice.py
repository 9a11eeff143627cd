"""How a session chooses its constant: the words of ``constant_choice``."""

from __future__ import annotations

from typing import Final

CHOICES: Final = ("predicted", "pooled", "interpolated", "nearest", "known")
RUNNING: Final = "running:"
MOST_RUNNING: Final = 1000


def running_count(choice: str) -> int | None:
    """How many determinations on either side ``running:5`` takes; None for other choices."""
    text = choice.removeprefix(RUNNING)
    if text == choice or not (text.isascii() and text.isdecimal()):
        return None
    count = int(text[:6])
    return count if 1 <= count <= MOST_RUNNING else None
