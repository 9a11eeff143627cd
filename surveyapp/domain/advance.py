"""How far a long computation is: told to whoever waits, and of no influence on any number."""

from __future__ import annotations

from collections.abc import Callable

Advance = Callable[[str, int, int], None]
"""Called with what is being done, how many are done, and of how many (0: nobody knows)."""


def silent(_what: str, _done: int, _total: int) -> None:
    """Nobody waits."""


PartDone = Callable[[float], None]
"""Told from time to time which part of a work is done, 0 to 1."""


def stage(progress: PartDone | None, start: float, end: float) -> PartDone | None:
    """What a part of a work tells: its 0 to 1 is ``start`` to ``end`` of the whole [-]."""
    if progress is None:
        return None
    return lambda share: progress(start + share * (end - start))
