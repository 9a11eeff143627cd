"""A log of a rate table, read into steady stretches with what was written beside them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.sensors.rate.turning import (
    Steady,
    TableMotion,
    TurnMean,
    common_arc,
    mean_over_arc,
    mean_over_turns,
    settled,
    steady_stretches,
    table_motion,
)
from surveyapp.core.statistics.distributions import chi_square_tail
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

SATURATED_SHARE = 0.02
"""Of the samples of a stretch at the very end of the column's range."""
SATURATED_LACK = 0.02
"""Relative lack of the mean against the table's rate."""
CONTRADICTION = 0.1
"""Relative difference of recorded angle and nominal rate that no table has."""
TABLE_CLOCKS = 1e-5
"""Relative difference that the clocks of table and log may have."""
RED_NOISE_LEVEL = 0.01
"""Probability below which the means of turns scatter more than their samples allow."""


def motion_of(log: SensorLog) -> TableMotion | Problem:
    """Rates and angles of the table, or what is missing."""
    rate, angle = log.columns.get("table_rate_deg_s"), log.columns.get("table_angle_deg")
    if rate is None and angle is None:
        return Problem(
            "the log does not say how the table turned",
            log.path,
            ", ".join(log.columns),
            "table_rate_deg_s (nominal) or table_angle_deg",
            "`columns` table_rate_deg_s=COLUMN names it",
        )
    return table_motion(log.columns["time_s"], rate_deg_s=rate, angle_deg=angle)


def sense_warnings(
    motion: TableMotion, of_gyros: Sequence[ResultWarning] = ()
) -> list[ResultWarning]:
    """Told where the nominal rates had the wrong sign, by the encoder or by the gyros.

    Parameters
    ----------
    motion : TableMotion
    of_gyros : sequence of ResultWarning
        What the gyros said of the sense that was believed.
    """
    if not motion.reversed_sense:
        return list(of_gyros)
    if of_gyros:
        text = (
            "table_angle_deg counts anticlockwise from above: every gyro agrees with the sign of "
            "table_rate_deg_s, which was believed"
        )
        return [ResultWarning("sense_of_rotation", text)]
    text = (
        "table_rate_deg_s has the opposite sign of the recorded table_angle_deg; the angle was "
        "believed: clockwise from above is positive"
    )
    return [ResultWarning("sense_of_rotation", text)]


def label_breaks(log: SensorLog, names: Sequence[str]) -> np.ndarray:
    """Rows at which any of these columns changes, shape (n,), bool."""
    change = np.zeros(log.size, dtype=bool)
    for name in names:
        if name in log.columns:
            values = log.columns[name]
            change[1:] |= values[1:] != values[:-1]
        elif name in log.texts:
            words = np.array(log.texts[name])
            change[1:] |= words[1:] != words[:-1]
    return change


def label(log: SensorLog, name: str, row: int, default: int) -> int:
    """A whole number written beside a row."""
    if name not in log.columns or not math.isfinite(log.columns[name][row]):
        return default
    return round(float(log.columns[name][row]))


@dataclass(frozen=True, slots=True)
class Turned:
    """A stretch as used: whole turns, or an arc that the way back retraces.

    Parameters
    ----------
    stretch : Steady
        As used.
    recorded : float
        Turns recorded.
    whole : bool
    """

    stretch: Steady
    recorded: float
    whole: bool

    @property
    def rate(self) -> float:
        """Of the table, clockwise [rad/s]."""
        return self.stretch.rate

    def mean(self, values: Floats) -> TurnMean:
        """Mean of a column over it."""
        return (
            mean_over_turns(self.stretch, values)
            if self.whole
            else mean_over_arc(self.stretch, values)
        )


def stretches_of(log: SensorLog, motion: TableMotion, labels: Sequence[str]) -> list[Steady]:
    """Steady stretches without the samples of running up that any gyro shows."""
    gyros = [log.columns[c] for c in log.columns if c.startswith("gyr_")]
    found = []
    for stretch in steady_stretches(motion, breaks=label_breaks(log, labels)):
        kept = stretch
        for values in gyros:
            kept = settled(kept, values)
        if not motion.nominal:
            kept = replace(kept, rate=recorded_rate(kept, log.columns["time_s"])[0])
        found.append(kept)
    return found


def recorded_rate(stretch: Steady, time_s: Floats) -> tuple[float, float]:
    """Rate of a stretch by its angles and its standard deviation [rad/s]: a straight line."""
    time = time_s[stretch.start : stretch.stop]
    time = time - time.mean()
    size = float(time @ time)
    slope = float(time @ stretch.angles) / size
    rest = stretch.angles - stretch.angles.mean() - slope * time
    return slope, math.sqrt(float(rest @ rest) / max(time.size - 2, 1) / size)


def encoder_told(
    log: SensorLog, motion: TableMotion, turned: Sequence[Turned], *, relative_rate_sigma: float
) -> tuple[list[ResultWarning], list[Problem]]:
    """Where the recorded angles do not turn at the nominal rate.

    Parameters
    ----------
    log : SensorLog
    motion : TableMotion
    turned : sequence of Turned
        What is used.
    relative_rate_sigma : float
        Stated for the table: three of it are allowed.
    """
    if not (motion.encoder and motion.nominal) or not turned:
        return [], []
    standing = [t for t in turned if not _moves(motion, t.stretch)]
    if standing:
        text = (
            "table_angle_deg stands still while table_rate_deg_s says that the table turns: the "
            "angle was taken from the rate"
        )
        return [ResultWarning("encoder_stands_still", text)], []
    cells = [(recorded_rate(t.stretch, log.columns["time_s"]), t.rate) for t in turned]
    off = np.array([slope / rate - 1.0 for (slope, _), rate in cells])
    sigma = np.array([sd / abs(rate) for (_, sd), rate in cells])
    worst = float(off[np.argmax(np.abs(off))])
    if abs(worst) > CONTRADICTION:
        return [], [
            Problem(
                "table_angle_deg and table_rate_deg_s contradict each other",
                log.path,
                said("the angle turns at {share:.4g} of the rate", share=1.0 + worst),
                said("within {share:.0%}", share=CONTRADICTION),
                "which of the two is in another unit? `units` COLUMN=UNIT states it",
            )
        ]
    limit = np.maximum(3.0 * relative_rate_sigma, TABLE_CLOCKS) + 5.0 * sigma
    if not np.any(np.abs(off) > limit):
        return [], []
    text = said(
        "by table_angle_deg the table turned {mean:+.2g} faster than table_rate_deg_s on the "
        "average, with a scatter of {sd:.2g}: the nominal rate was used. "
        "--table-rate-relative-sigma puts this into the sigmas; a log without table_rate_deg_s is "
        "calibrated by the recorded angle",
        mean=float(off.mean()),
        sd=float(np.std(off, ddof=1)) if off.size > 1 else 0.0,
    )
    return [ResultWarning("encoder_contradicts_rate", text)], []


def _moves(motion: TableMotion, stretch: Steady) -> bool:
    part = motion.angles[stretch.start : stretch.stop]
    return bool(part[-1] != part[0])


def usable(stretches: Sequence[Steady], *, where: str) -> tuple[list[Turned], list[Problem]]:
    """Cut the stretches of one position or set to whole turns, or to an arc passed both ways.

    Parameters
    ----------
    stretches : sequence of Steady
    where : str
        For messages.

    Returns
    -------
    turned : list of Turned
    problems : list of Problem
    """
    clockwise = [s for s in stretches if s.rate > 0.0]
    back = [s for s in stretches if s.rate < 0.0]
    if not clockwise or not back:
        found = (
            "no turning"
            if not stretches
            else ("clockwise only" if clockwise else "anticlockwise only")
        )
        hint = "bias and rate are told apart by turning both ways"
        return [], [Problem("one sense of rotation only", where, found, "both senses", hint)]
    whole = [(s, s.whole_turns()) for s in stretches]
    good = [Turned(w, s.turns, whole=True) for s, w in whole if w is not None]
    if any(t.rate > 0.0 for t in good) and any(t.rate < 0.0 for t in good):
        return good, []
    for one in clockwise:
        for other in back:
            arc = common_arc(one, other)
            if arc is not None:
                parts = zip(arc, (one.turns, other.turns), strict=True)
                return [Turned(s, t, whole=False) for s, t in parts], []
    turns = ", ".join(f"{math.copysign(s.turns, s.rate):+.2f}" for s in stretches)
    return [], [
        Problem(
            "less than one whole turn",
            where,
            said("{turns} turns", turns=turns),
            "at least one whole turn each way, or a way back over the same arc",
            "the level part of the earth rate cancels over whole turns only",
        )
    ]


def saturated(part: Floats, column: Floats, *, expected: float) -> bool:
    """Whether a gyro stands at the end of its range while the table turns about it.

    Parameters
    ----------
    part : ndarray
        The column over one stretch [rad/s].
    column : ndarray
        The whole of it.
    expected : float
        Magnitude of the rate [rad/s].
    """
    share = float(np.mean((part == column.max()) | (part == column.min())))
    if share < SATURATED_SHARE:
        return False
    lacks = abs(float(part.mean())) < (1.0 - SATURATED_LACK) * expected
    return lacks or (float(np.std(part)) > 0.0 and np.unique(part).size > 20)


def red_noise_factor(turned: Sequence[Turned], values: Floats) -> float:
    """Factor on the sigmas because means of turns scatter more than white noise allows; 1 = none.

    Parameters
    ----------
    turned : sequence of Turned
    values : ndarray, shape (n,)
        The whole column.
    """
    total, dof = 0.0, 0
    for item in turned:
        count = math.floor(item.stretch.turns + 0.01)
        if not item.whole or count < 3:
            continue
        found = item.mean(values)
        if found.noise == 0.0:
            continue
        parts = np.array_split(values[item.stretch.start : item.stretch.stop], count)
        means = np.array([p.mean() for p in parts])
        total += float(np.sum((means - means.mean()) ** 2)) / (found.noise**2 / parts[0].size)
        dof += count - 1
    if dof == 0 or chi_square_tail(total, dof) > RED_NOISE_LEVEL:
        return 1.0
    return math.sqrt(total / dof)
