"""Measured runs, transcribed from their sources, for the tests of the diagnosis."""

from __future__ import annotations

import numpy as np

from surveyapp.diagnosis import TurningPoints
from surveyapp_models.angles import ARCSEC

# Williams & Belling 1967, p. 273: 20 turning points of a Wild GAK1, left and right alternating.
JOHANNESBURG_DMS = (
    (179, 1, 56), (181, 17, 26), (179, 6, 5), (181, 12, 59), (179, 11, 16), (181, 7, 43),
    (179, 12, 42), (181, 6, 52), (179, 13, 42), (181, 5, 58), (179, 14, 35), (181, 4, 50),
    (179, 14, 58), (181, 4, 32), (179, 15, 39), (181, 3, 56), (179, 15, 59), (181, 3, 39),
    (179, 16, 19), (181, 3, 2),
)  # fmt: skip
# Soviet instruction, appendix 8-2: MOM Gi-B1 No. 825006, six turning points.
GI_B1_DMS = (
    (112, 23, 58), (107, 57, 34), (112, 23, 50), (107, 57, 43), (112, 23, 55), (107, 57, 47),
)  # fmt: skip


def radians(readings: tuple[tuple[int, int, int], ...]) -> list[float]:
    return [float(np.dot(dms, (3600.0, 60.0, 1.0)) * ARCSEC) for dms in readings]


def johannesburg(points: int = 20) -> TurningPoints:
    return TurningPoints(
        radians(JOHANNESBURG_DMS)[:points],
        resolution=ARCSEC,
        instrument="GAK1 3139",
        identity="johannesburg",
    )


def gi_b1() -> TurningPoints:
    return TurningPoints(
        radians(GI_B1_DMS), resolution=ARCSEC, instrument="Gi-B1 825006", identity="gi-b1"
    )
