"""How far a long computation is: told to whoever waits, and of no influence on any number."""

from __future__ import annotations

from collections.abc import Callable

Advance = Callable[[str, int, int], None]
"""Called with what is being done, how many are done, and of how many (0: nobody knows)."""


def silent(_what: str, _done: int, _total: int) -> None:
    """Nobody waits."""


PartDone = Callable[[float], None]
"""Told from time to time which part of a work is done, 0 to 1."""
