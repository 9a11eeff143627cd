"""The import of pyproj: once, whole, and by one thread at a time.

Two threads that begin with different parts of it get halves of modules from each other: a search
for a grid beside a computation ended in an AttributeError. Whoever imports a part calls this first.
"""

from __future__ import annotations

from threading import Lock
from typing import Final

_LOADING: Final = Lock()


def load_pyproj() -> None:
    """Import pyproj with the parts that are used here."""
    with _LOADING:
        import pyproj.exceptions  # noqa: F401
