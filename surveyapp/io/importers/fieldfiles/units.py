"""Units of field files: what a word or a column is written in, as a factor to radians or metres."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

FOOT: Final = 0.3048
US_FOOT: Final = 1200.0 / 3937.0
"""US survey foot [m]: 2 ppm longer than the international one."""
GON: Final = math.pi / 200.0
DEGREE: Final = math.pi / 180.0
MIL: Final = math.pi / 3200.0
"""Mil of artillery and total stations: 1/6400 of the circle."""

LENGTHS: Final = {
    "m": 1.0,
    "mm": 1e-3,
    "cm": 1e-2,
    "ft": FOOT,
    "usft": US_FOOT,
}
ANGLES: Final = {
    "gon": GON,
    "deg": DEGREE,
    "dms": DEGREE,
    "mil": MIL,
    "rad": 1.0,
    "mgon": GON * 1e-3,
    "arcsec": DEGREE / 3600.0,
}
"""Factors to radians; ``dms`` is read by its own rule."""
PRESSURES: Final = {"hPa": 1.0, "mbar": 1.0, "mmHg": 1.333223874, "inHg": 33.86388640}
TEMPERATURES: Final = ("C", "F")


def celsius(value: float, unit: str) -> float:
    """A temperature in degrees Celsius."""
    return (value - 32.0) / 1.8 if unit == "F" else value


@dataclass(frozen=True, slots=True)
class FootChoice:
    """Which foot a file means where it says no more than feet."""

    metres: float = FOOT
    told: bool = False

    @property
    def text(self) -> str:
        """What is told about it."""
        kind = "US survey feet" if self.metres == US_FOOT else "international feet"
        why = "as told by --unit" if self.told else "nothing tells which: --unit foot=us otherwise"
        return f"lengths in feet are taken for {kind} ({why}); the two differ by 2 ppm"
