"""What in a record of motion contradicts what its columns are taken for."""

from __future__ import annotations

import numpy as np

from surveyapp.core.sensors.rate.motion_axes import axes_doubts
from surveyapp.core.sensors.rate.motion_pieces import ACCELEROMETERS, PIECE_ROWS, stacked
from surveyapp.core.sensors.rate.rests import Rests
from surveyapp.domain.columns import PIECE, pieces, span
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

ODOMETER = "odometer_m"
FALLS_M = 0.5
"""By so much an odometer may count back: a wheel that rocks at a stop."""
UPRIGHT = 0.7
"""Share of gravity along z from which z is up or down, within 45 degrees."""
LEAST_MOVING_S = 5.0
CONTRADICTIONS = (
    "odometer_stands",
    "forward_is_x",
    "turning_reversed",
    "rates_in_degrees",
    "rates_too_small",
)
"""Doubts under which states or path are not what they say; a vehicle may back all the way."""


def odometer_problems(log: SensorLog) -> list[Problem]:
    """An odometer that counts back: what was driven then is not known."""
    values = log.columns.get(ODOMETER)
    if values is None:
        return []
    back, first = 0.0, 0
    for number, piece in enumerate(pieces(values, overlap=1)):
        falls = np.minimum(np.diff(piece), 0.0)
        if back == 0.0 and falls.any():
            first = number * PIECE + int(np.argmax(falls < 0.0)) + 1
        back -= float(falls.sum())
    if back <= FALLS_M:
        return []
    return [
        Problem(
            said("the odometer counts back"),
            said("{path}, row {row}", path=log.path, row=first + 1),
            said("{back:.1f} m in all", back=back),
            said("metres driven, which never fall"),
            said("cut the log where the odometer was set back; a vehicle that backs drives on"),
        )
    ]


def _mean_of(log: SensorLog, rests: Rests) -> Floats:
    """Mean force at rest, (3,), piece by piece; of the whole record where it never rests."""
    total, chosen = np.zeros(3), rests if rests.runs else Rests(((0, log.size),), log.size)
    for begin in range(0, log.size, PIECE_ROWS):
        part = slice(begin, begin + PIECE_ROWS)
        rows = chosen.mask(begin, begin + PIECE_ROWS)
        total = total + stacked(log, ACCELEROMETERS, part)[rows].sum(axis=0)
    return np.asarray(total / chosen.count)


def record_doubts(log: SensorLog, rests: Rests, *, snapping: bool) -> list[ResultWarning]:
    """What may be wrong although a result comes out.

    Parameters
    ----------
    log : SensorLog
    rests : Rests
    snapping : bool
        Whether the drift is to be laid back over the path.
    """
    found = []
    felt = _mean_of(log, rests)
    size = float(np.linalg.norm(felt))
    if abs(felt[2]) < UPRIGHT * size:
        along = "xyz"[int(np.argmax(np.abs(felt)))]
        text = said(
            "gravity lies along {along}, not along z: with X right, Y forward, Z up the states of "
            "acceleration and turning do not mean what they say; are the columns exchanged?",
            along=along,
        )
        found.append(ResultWarning("z_not_up", text))
    else:
        found += axes_doubts(log, rests)
    odometer = log.columns.get(ODOMETER)
    if odometer is None:
        if snapping:
            text = "nothing was snapped: the drift is laid back over what an odometer counted"
            found.append(ResultWarning("no_odometer", text))
        return found
    moving_s = (log.size - rests.count) / (log.rate_hz or 100.0)
    if span(odometer) == 0.0 and moving_s > LEAST_MOVING_S:
        text = said(
            "the odometer stands while the sensors move for {moving_s:.0f} s: the path is no path",
            moving_s=moving_s,
        )
        found.append(ResultWarning("odometer_stands", text))
    return found
