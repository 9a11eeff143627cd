"""Positions of a unit on a rate table: stretches of each position to mean outputs.

Shared by the six-position and the temperature programme. Finds labels that gravity contradicts
and senses of rotation that the gyros contradict.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.sensors.rate.accelerometers import Resting
from surveyapp.core.sensors.rate.six_position import PositionMeans, StaticMeans, position_means
from surveyapp.core.sensors.rate.table_axis import axis_rate
from surveyapp.core.sensors.rate.table_log import (
    Turned,
    motion_of,
    red_noise_factor,
    saturated,
    stretches_of,
    usable,
)
from surveyapp.core.sensors.rate.turning import Steady, TableMotion
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem
from surveyapp.languages import either, said
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.turntable import POSITIONS

GYROS = ("gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s")
ACCELEROMETERS = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")
REST_SHARE = 1e-6
"""Of the largest table rate: slower is rest."""
MOST_SCALE = 2.0
"""Response to the table's rate, or its inverse, above which the unit is wrong, not the scale."""
RATE_UNITS = {
    "deg/s": math.degrees(1.0),
    "deg/h": math.degrees(1.0) * 3600.0,
}
"""What a gyro in another unit shows of a rate of one rad/s."""
UNIT_SLACK = 0.15
"""Relative distance within which a response is taken for that of a unit."""
FEWEST_AROUND = 8
"""Rows of turning from which a sinusoid of the table's angle is fitted."""
GUARD_ROWS = 3
"""Rows left out beside turning when the rest of a position is averaged."""


@dataclass(frozen=True, slots=True)
class Placed:
    """What was turned in one position of one round (or at one temperature).

    Parameters
    ----------
    position : str
    group : int
    turned : tuple of Turned
    """

    position: str
    group: int
    turned: tuple[Turned, ...]


def place_problems(log: SensorLog) -> list[Problem]:
    """Labels of positions that are none."""
    if "position" not in log.texts:
        hint = "x+ = body x up along the table's axis; `columns` position=COLUMN names the column"
        return [Problem("the log does not name its positions", log.path, "", "position", hint)]
    words = sorted(set(log.texts["position"]) - set(POSITIONS) - {""})
    if not words:
        return []
    expected = either(POSITIONS)
    return [Problem("this is no position", log.path, ", ".join(words[:5]), expected)]


def placed_stretches(
    log: SensorLog, motion: TableMotion, groups: Sequence[int], labels: Sequence[str]
) -> tuple[list[Placed], list[Problem]]:
    """Stretches of each position and group, cut to what can be used.

    Parameters
    ----------
    log : SensorLog
    motion : TableMotion
    groups : sequence of int, length n
        Round or temperature node of each row.
    labels : sequence of str
        Columns whose change begins something new.
    """
    by_place: dict[tuple[int, str], list[Steady]] = {}
    words = log.texts["position"]
    for stretch in stretches_of(log, motion, labels):
        word = words[stretch.start]
        if word:
            by_place.setdefault((groups[stretch.start], word), []).append(stretch)
    placed, problems = [], []
    for (group, word), stretches in by_place.items():
        where = said("{path}, position {word}", path=log.path, word=word)
        if group > 1:
            where = said("{where}, round {group}", where=where, group=group)
        turned, wrong = usable(stretches, where=where)
        problems += wrong
        if turned:
            placed.append(Placed(word, group, tuple(turned)))
            problems += _saturation(log, placed[-1], where)
    if not by_place:
        problems += usable([], where=log.path)[1]
    return placed, problems


def _saturation(log: SensorLog, placed: Placed, where: str) -> list[Problem]:
    axis = "xyz".index(placed.position[0])
    column = log.columns[GYROS[axis]]
    for item in placed.turned:
        part = column[item.stretch.start : item.stretch.stop]
        if saturated(part, column, expected=abs(item.rate)):
            found = said(
                "{gyros} stays at {value:.6g} deg/s",
                gyros=GYROS[axis],
                value=math.degrees(abs(float(part[0]))),
            )
            return [
                Problem(
                    "the gyro is saturated",
                    where,
                    found,
                    said(
                        "the table's rate of {value:.6g} deg/s", value=math.degrees(abs(item.rate))
                    ),
                    "turn the table more slowly",
                )
            ]
    return []


def means_of(
    log: SensorLog, placed: Sequence[Placed], *, latitude: float | None = None
) -> list[PositionMeans]:
    """Slope and rest of each position, and the earth's rate along it where a latitude [rad] is."""
    columns = [log.columns[c] for c in GYROS]
    every = [t for p in placed for t in p.turned]
    red = [red_noise_factor(every, c) for c in columns]
    found = []
    for place in placed:
        cells = [[t.mean(c) for c in columns] for t in place.turned]
        means = np.array([[m.mean for m in row] for row in cells])
        sigmas = np.array([[m.sigma for m in row] for row in cells]) * np.array(red)
        rates = np.array([t.rate for t in place.turned])
        one = position_means(
            place.position, rates=rates, means=means, sigmas=sigmas, group=place.group
        )
        if not all(t.whole for t in place.turned):
            one = replace(one, rest=np.full(3, np.nan))
        if latitude is not None:
            earth, _ = axis_rate(log, place.turned, one.axis, latitude=latitude)
            one = replace(one, earth=earth)
        found.append(one)
    return found


def unit_problems(means: Sequence[PositionMeans], *, where: str) -> list[Problem]:
    """Gyros whose response to the table's rate is that of another unit."""
    shown = {"xyz"[m.axis]: abs(float(m.column()[m.axis])) for m in means}
    wrong = {a: s for a, s in shown.items() if not 1.0 / MOST_SCALE <= s <= MOST_SCALE}
    if not wrong:
        return []
    found = ", ".join(
        said("gyr_{axis} shows {share:.4g} of the table's rate", axis=a, share=s)
        for a, s in wrong.items()
    )
    factor = math.exp(float(np.mean(np.log([max(s, 1e-12) for s in wrong.values()]))))
    units = [u for u, f in RATE_UNITS.items() if abs(factor / f - 1.0) < UNIT_SLACK]
    hint = said("are the gyros in rad/s and the table in deg/s? counts take `scale` COLUMN=VALUE")
    if units:
        hint = said("are the gyros in {unit}? `units` COLUMN={unit}", unit=units[0])
    if abs(factor / math.degrees(1.0) - 1.0) < UNIT_SLACK:
        hint += said("; or is the table's rate in rad/s?")
    expected = said("{low:g} to {high:g}", low=1.0 / MOST_SCALE, high=MOST_SCALE)
    return [Problem("the gyros are in another unit than the table", where, found, expected, hint)]


def sense_of(
    means: Sequence[PositionMeans], *, where: str
) -> tuple[list[PositionMeans], list[ResultWarning], list[Problem]]:
    """Turn the table's sense round where every gyro contradicts it; refuse where only some do."""
    against = [m for m in means if m.column()[m.axis] < 0.0]
    if not against:
        return list(means), [], []
    if len(against) == len(means):
        turned = [replace(m, slope=-m.slope) for m in means]
        text = (
            "every gyro contradicts the sign of the table's rate: the table counts anticlockwise "
            "from above, or the positions name the axis that points down; the sign was turned"
        )
        return turned, [ResultWarning("sense_of_rotation", text)], []
    names = ", ".join(dict.fromkeys(m.position for m in against))
    whole = {a for a in range(3) if all(m in against for m in means if m.axis == a)}
    hint = "is a position named wrongly, or was the table turned the other way?"
    if all(m.axis in whole for m in against):
        hint = "does this gyro count the other way, or are its columns exchanged with another's?"
    return (
        list(means),
        [],
        [
            Problem(
                "the sense of rotation contradicts the position",
                where,
                said(
                    "the gyro of {names} turns against the table, the others with it", names=names
                ),
                "x+ = body x up; an axis that points up reads minus the clockwise rate",
                hint,
            )
        ],
    )


def resting_of(
    log: SensorLog, motion: TableMotion, placed: Sequence[Placed], *, levelled: bool = False
) -> tuple[list[StaticMeans], list[tuple[int, Resting]]]:
    """Mean outputs at rest in each position: of the gyros, and of the accelerometers by group.

    Where a position has no rows at rest, the accelerometers are averaged over its whole turns.
    ``levelled`` takes the tilt of the table out of them.
    """
    largest = float(np.abs(motion.rates).max(initial=0.0))
    rest = np.abs(motion.rates) <= REST_SHARE * largest
    for shift in range(1, GUARD_ROWS + 1):
        moving = np.abs(motion.rates) > REST_SHARE * largest
        rest[shift:] &= ~moving[:-shift]
        rest[:-shift] &= ~moving[shift:]
    words = np.array(log.texts["position"])
    has_forces = log.has(*ACCELEROMETERS)
    static: list[StaticMeans] = []
    resting: list[tuple[int, Resting]] = []
    for place in placed:
        inside = _rows_of(place, words)
        rows = np.flatnonzero(rest & inside)
        if rows.size > 10:
            static.append(StaticMeans(place.position, *_mean(log, GYROS, rows)))
        else:
            rows = np.concatenate(
                [np.arange(t.stretch.start, t.stretch.stop) for t in place.turned]
            )
        if has_forces:
            turned = [t.stretch for t in place.turned] if levelled else []
            mean, sigma = _levelled(log, motion, rows, turned)
            resting.append((place.group, Resting(place.position, mean, sigma)))
    return static, resting


def _levelled(
    log: SensorLog, motion: TableMotion, rows: np.ndarray, turned: Sequence[Steady]
) -> tuple[Floats, Floats]:
    """Mean accelerometer outputs of rows without what a tilt of the table has in them, and sigma.

    While it turns, the tilt goes round as a sinusoid of its angle, and turning itself adds a
    constant; at rest the tilt stands still in the mean. What goes round is taken out at the angles
    of the rows: half a degree of tilt would be half a degree of misalignment.
    """
    mean, sigma = _mean(log, ACCELEROMETERS, rows)
    parts = [np.arange(t.start, t.stop) for t in turned]
    around = np.concatenate(parts) if parts else np.zeros(0, dtype=np.intp)
    angles = motion.angles[around]
    if around.size < FEWEST_AROUND or float(np.ptp(angles)) < math.pi:
        return mean, sigma
    design = np.column_stack([np.ones(around.size), np.cos(angles), np.sin(angles)])
    forces = np.column_stack([log.columns[c][around] for c in ACCELEROMETERS])
    found = np.linalg.lstsq(design, forces, rcond=None)[0]
    spread = np.std(forces - design @ found, axis=0, ddof=3)
    here = np.array([np.cos(motion.angles[rows]).mean(), np.sin(motion.angles[rows]).mean()])
    return mean - here @ found[1:], np.hypot(sigma, spread * math.sqrt(2.0 / around.size))


def _rows_of(place: Placed, words: np.ndarray) -> np.ndarray:
    """Rows of this position around its stretches, shape (n,), bool."""
    same = words == place.position
    first = min(t.stretch.start for t in place.turned)
    last = max(t.stretch.stop for t in place.turned) - 1
    breaks = np.flatnonzero(~same)
    low = int(breaks[breaks < first].max(initial=-1)) + 1
    later = breaks[breaks > last]
    high = int(later.min()) if later.size else words.size
    inside = np.zeros(words.size, dtype=bool)
    inside[low:high] = True
    return inside


def _mean(log: SensorLog, names: Sequence[str], rows: np.ndarray) -> tuple[Floats, Floats]:
    values = np.array([log.columns[c][rows] for c in names])
    spread = values.std(axis=1, ddof=1) if rows.size > 1 else np.zeros(values.shape[0])
    return values.mean(axis=1), spread / math.sqrt(rows.size)


def label_problems(resting: Sequence[tuple[int, Resting]], *, where: str) -> list[Problem]:
    """Positions that gravity contradicts."""
    problems = []
    for _, one in resting:
        axis = int(np.argmax(np.abs(one.mean)))
        felt = "xyz"[axis] + ("+" if one.mean[axis] > 0.0 else "-")
        if felt != one.position:
            problems.append(
                Problem(
                    "gravity contradicts the position",
                    said("{where}, position {position}", where=where, position=one.position),
                    said("the accelerometers say {felt}", felt=felt),
                    one.position,
                    "are axes swapped, is a position named wrongly, or is the unit not specific "
                    "force (+g on the axis that points up)?",
                )
            )
    return problems


def table_tilt(resting: Sequence[tuple[int, Resting]]) -> float | None:
    """Angle between specific force and the axis that points up, of the first position [rad]."""
    if not resting:
        return None
    one = resting[0][1]
    axis = "xyz".index(one.position[0])
    across = math.hypot(*np.delete(one.mean, axis).tolist())
    return math.atan2(across, abs(float(one.mean[axis])))


def resting_rows(log: SensorLog) -> tuple[Resting, ...]:
    """Mean accelerometer outputs of each position of a log, over its rows at rest.

    Parameters
    ----------
    log : SensorLog
        With the accelerometers and ``position``; rows in which the table turns are left out.
    """
    still = np.ones(log.size, dtype=bool)
    if "table_rate_deg_s" in log.columns:
        still = np.abs(log.columns["table_rate_deg_s"]) <= 1e-9
    motion = motion_of(log) if "time_s" in log.columns else None
    stretches: list[Steady] = []
    if isinstance(motion, TableMotion):
        stretches = stretches_of(log, motion, ("position",))
    words = np.array(log.texts["position"])
    found = []
    for word in POSITIONS:
        rows = np.flatnonzero((words == word) & still)
        if rows.size < 2:
            rows = np.flatnonzero(words == word)
        if rows.size and isinstance(motion, TableMotion):
            turned = [s for s in stretches if words[s.start] == word]
            found.append(Resting(word, *_levelled(log, motion, rows, turned)))
        elif rows.size:
            found.append(Resting(word, *_mean(log, ACCELEROMETERS, rows)))
    return tuple(found)
