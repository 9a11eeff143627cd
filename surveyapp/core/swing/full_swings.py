"""How long every full swing lasted, from the moments in the book."""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.core.swing.sights import moments
from surveyapp.domain.readings import Reading, ReadingKind


def full_swings(rows: Sequence[Reading], kind: ReadingKind) -> list[tuple[float, int]]:
    """Length [s] and last seq of every full swing: from a row to the next but one."""
    spans = []
    for first, middle, last in zip(rows, rows[1:], rows[2:], strict=False):
        if first.kind is not kind or last.kind is not kind:
            continue
        if kind is ReadingKind.TRANSIT and len({first.value, middle.value, last.value}) > 1:
            continue
        times = moments([first, last])
        if times is not None:
            spans.append((float(times[1] - times[0]), last.seq))
    return spans
