"""Pause Python's cycle collector while very many small values without cycles are built.

A network of 100 000 points is some million frozen values; the collector walks over all of them
again and again and finds nothing, for a third of the whole time. Reference counting goes on.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def paused_collection() -> Iterator[None]:
    """Pause the cycle collector, if it runs, until the end of the block."""
    running = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if running:
            gc.enable()
