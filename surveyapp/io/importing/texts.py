"""The readings as read and the traverse book made of them, as text.

Angles stand in decimal degrees with their unit in the row, so that a project in gon reads them too.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import Final

from surveyapp.domain.fieldfile import FieldFile, Pointing, ReducedSet, ReducedSight
from surveyapp.io.traverse.rows import COLUMNS

RAW_COLUMNS: Final = (
    *("line", "at", "to", "face", "set", "hz_deg", "v_deg", "sd_m", "hd_m", "hi_m", "ht_m"),
    *("ppm", "prism_mm", "temperature_c", "pressure_hpa", "time", "code", "note"),
)


def degrees(value: float | None) -> str:
    """An angle in degrees, nine decimals (4 microseconds of arc) without idle zeros."""
    return "" if value is None else _trimmed(f"{math.degrees(value):.9f}")


@lru_cache(maxsize=1 << 12)
def metres(value: float | None) -> str:
    """A length, 0.1 micrometre without idle zeros."""
    return "" if value is None else _trimmed(f"{value:.7f}")


def _trimmed(text: str) -> str:
    text = text.rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


@lru_cache(maxsize=1 << 12)
def plain(value: float | None) -> str:
    """A number as short as it can be said."""
    return "" if value is None else f"{value:.10g}"


def _clean(text: str) -> str:
    if not text:
        return ""
    return "".join(c if c.isprintable() else " " for c in text).strip()[:200]


def csv_text(header: Sequence[str], rows: Iterable[Sequence[str]]) -> bytes:
    """A table as CSV with plain line ends, in UTF-8."""
    stream = io.BytesIO()
    text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    text.flush()
    return stream.getvalue()


def raw_row(p: Pointing) -> tuple[str, ...]:
    """One pointing as read."""
    return (
        *(str(p.line), p.at, p.to, p.face, f"{p.setup}:{p.set}" if p.set else p.setup),
        *(degrees(p.hz), degrees(p.v), metres(p.sd), metres(p.hd), metres(p.hi), metres(p.ht)),
        *(plain(p.ppm), plain(None if p.prism_m is None else p.prism_m * 1000.0)),
        *(plain(p.temperature_c), plain(p.pressure_hpa)),
        *(_clean(p.time), _clean(p.code), _clean(p.note)),
    )


def raw_text(file: FieldFile) -> bytes:
    """Every pointing as read, one row each."""
    return csv_text(RAW_COLUMNS, (raw_row(p) for p in file.pointings))


def _sight_rows(made: ReducedSet, sight: ReducedSight) -> list[tuple[str, ...]]:
    named = (
        ("direction", degrees(sight.direction), "deg"),
        ("zenith", degrees(sight.zenith), "deg"),
        ("slope_distance", metres(sight.slope_distance), "m"),
        ("distance", metres(sight.distance), "m"),
    )
    lines = " ".join(str(line) for line in sight.lines)
    note = f"line {lines}" if len(sight.lines) == 1 else f"lines {lines}"
    tail = (made.name, metres(sight.hi), metres(sight.ht), note)
    return [
        (kind, made.at, "", sight.to, value, unit, "", "", *tail)
        for kind, value, unit in named
        if value
    ]


def book_text(sets: Sequence[ReducedSet]) -> tuple[bytes, int]:
    """Traverse book of reduced sets and the number of its rows."""
    number = 0

    def rows() -> Iterator[tuple[str, ...]]:
        nonlocal number
        for made in sets:
            for sight in made.sights:
                found = _sight_rows(made, sight)
                number += len(found)
                yield from found

    text = csv_text(COLUMNS, rows())
    return text, number
