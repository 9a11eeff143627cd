"""What is wrong or odd in the columns of a log, all of it together.

A needed column must be there, must be finite and must vary; times must increase; counts need a
unit. Values that no sensor can have in the stated unit are counts or another unit: refused with
what they look like, never guessed.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.sensors.clipping import ends_of_range
from surveyapp.domain.columns import PIECE, pieces, sampled
from surveyapp.domain.sensor_log import NUMBER_COLUMNS, SENSOR_COLUMNS, TRIPLES, Array, Gap
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem
from surveyapp.languages import counted, either, said

GAP_FACTOR: Final = 2.5
"""An interval of more than so many median ones is a gap."""

OFF_GRID: Final = 0.05
FEW_MISSING: Final = 0.1
"""Steps within so much of whole multiples of the median one, few of them longer: an even record."""

LARGEST: Final = 1e20
"""No sensor and no clock gives more in any unit; squares above would leave the range of a float."""

LOOKED_AT: Final = 20_000
"""Rows that tell the unit of a column, evenly taken."""

MOST_FIELD_UT: Final = 150.0
"""Twice the strongest field of the earth at the ground (67 uT), rounded up."""

LEAST_READING_DEG: Final = -180.0
"""Some instruments count a circle from -180 to 180 degrees."""

SWEPT_FIELD_UT: Final = 4.0 * MOST_FIELD_UT
"""No axis that is turned in the field of the earth, soft iron included, changes by so much."""


@dataclass(frozen=True, slots=True)
class Plausible:
    """Bounds of the median size of a vector, and in which unit each range would be."""

    low: float
    high: float
    unit: str
    looks_like: tuple[tuple[str, float, float], ...]


PLAUSIBLE: Final[dict[str, Plausible]] = {
    "mag": Plausible(1.0, 1000.0, "uT", (("nT", 1e3, 1e6), ("G", 0.05, 1.0), ("mG", 50.0, 2000.0))),
    "acc": Plausible(2.0, 50.0, "m/s2", (("g", 0.5, 2.0), ("mg", 500.0, 2000.0))),
}
"""Sizes that a magnetic field on the ground and a specific force can have in a record."""


def not_finite(
    name: str, values: Array, *, where: str, first_row: int, blanks: bool = False
) -> list[Problem]:
    """NaN, infinite, impossibly large or empty cells; ``blanks`` are allowed in other columns."""
    count, first = 0, None
    for number, piece in enumerate(pieces(values)):
        bad = np.flatnonzero(~((np.abs(piece) <= LARGEST) | (blanks & np.isnan(piece))))
        count += bad.size
        if first is None and bad.size:
            first = number * PIECE + int(bad[0])
    if first is None:
        return []
    return [
        Problem(
            counted(
                "{name} is not a number in {count} row",
                "{name} is not a number in {count} rows",
                name=name,
                count=count,
            ),
            said("{where}, line {line}", where=where, line=first_row + first),
            str(values[first]) if not np.isnan(values[first]) else "NaN or an empty cell",
            "a number that a sensor can give, in each row",
            "cut the log where the sensor was silent, or leave these rows out",
        )
    ]


def constant(name: str, values: Array, *, where: str) -> list[Problem]:
    """A needed column that never changes holds no information."""
    if values.size < 2 or any(np.any(piece != values[0]) for piece in pieces(values)):
        return []
    hint = "is the sensor connected, and is it the right column?"
    found, expected = (
        said("{values:g} in all {size} rows", values=values[0], size=values.size),
        "a column that varies",
    )
    return [Problem(said("{name} is constant", name=name), where, found, expected, hint)]


def bad_times(time: Array, *, where: str, first_row: int) -> list[Problem]:
    """Times that run backwards or stand twice."""
    problems = []
    back, twice = [0, 0], [0, 0]
    for number, piece in enumerate(pieces(time, overlap=1)):
        step = np.diff(piece)
        for found, bad in ((back, step < 0.0), (twice, step == 0.0)):
            if found[0] == 0 and bad.any():
                found[1] = number * PIECE + int(np.argmax(bad)) + 1
            found[0] += int(np.count_nonzero(bad))
    told = (
        counted(
            "time_s runs backwards in {count} place",
            "time_s runs backwards in {count} places",
            count=back[0],
        ),
        counted(
            "time_s stands twice in {count} place",
            "time_s stands twice in {count} places",
            count=twice[0],
        ),
    )
    for (count, row), what in zip((back, twice), told, strict=True):
        if count:
            problems.append(
                Problem(
                    what,
                    said("{where}, line {line}", where=where, line=first_row + row),
                    said("{time:.12g} after {time2:.12g}", time=time[row], time2=time[row - 1]),
                    "increasing times",
                    "are two records in one file, or was it sorted by another column?",
                )
            )
    return problems


def gaps_of(time: Array) -> tuple[float, tuple[Gap, ...]]:
    """Interval of the samples [s], and the intervals that are much longer than the median one."""
    if time.size < 3:
        return (float(time[1] - time[0]) if time.size == 2 else 0.0), ()
    median = _usual_step(time)
    gaps = []
    for piece in pieces(time, overlap=1):
        places = np.flatnonzero(np.diff(piece) > GAP_FACTOR * median)
        gaps += [Gap(float(piece[i]), float(piece[i + 1])) for i in places]
    return _interval(time, median), tuple(gaps)


def _usual_step(time: Array) -> float:
    """Median step of the times; of a long record, median of those of its pieces."""
    return float(np.median([np.median(np.diff(piece)) for piece in pieces(time, overlap=1)]))


def _interval(time: Array, median: float) -> float:
    """Interval of the samples [s] from the steps between them, gaps left out.

    Times rounded by the logger (3 and 4 ms at 286 Hz) have another median than mean, and the mean
    is right. Where a few rows are missing of an even record, the step over them counts for two.
    """
    if median <= 0.0:
        return median
    count = missing = 0
    length = steps = 0.0
    even = True
    for piece in pieces(time, overlap=1):
        near = np.diff(piece)
        near = near[near <= GAP_FACTOR * median]
        multiple = np.rint(near / median)
        even = even and bool(np.all(np.abs(near / median - multiple) < OFF_GRID))
        even = even and bool(np.all(multiple > 0.0))
        count, missing = count + near.size, missing + int(np.count_nonzero(multiple > 1.0))
        length, steps = length + float(np.sum(near)), steps + float(np.sum(multiple))
    if count == 0:
        return median
    return length / steps if even and missing < FEW_MISSING * count else length / count


def clipped_columns(columns: Mapping[str, Array]) -> dict[str, int]:
    """Sensor columns that stay at an end of their range, with the number of rows."""
    found = {}
    for name, values in columns.items():
        if name in SENSOR_COLUMNS and values.size and np.isfinite(values[0]):
            rows = sum(ends_of_range(values).values())
            if rows:
                found[name] = rows
    return found


def implausible(
    columns: Mapping[str, Array], *, stated: Collection[str], where: str
) -> list[Problem]:
    """Vectors that cannot be in their unit; ``stated`` are the columns with a unit or scale."""
    problems = []
    for name, bounds in PLAUSIBLE.items():
        names = TRIPLES[name]
        if not all(column in columns for column in names):
            continue
        size = np.sqrt(sum(sampled(columns[c], LOOKED_AT) ** 2 for c in names))
        median = float(np.median(size)) if size.size else 0.0
        if not np.isfinite(median) or bounds.low <= median <= bounds.high:
            continue
        unstated = not all(column in stated for column in names)
        whole = all(_whole(sampled(columns[c], LOOKED_AT)) for c in names)
        what = said("{name}_x/y/z cannot be in {unit}", name=name, unit=bounds.unit)
        if unstated and whole:
            what = said("{name}_x/y/z are counts without a unit", name=name)
        units = [unit for unit, low, high in bounds.looks_like if low <= median <= high]
        hint = "counts take `scale` COLUMN=VALUE"
        if units:
            hint = said(
                "is it {names}? `units` COLUMN={units}; {hint}",
                names=either(units),
                units=units[0],
                hint=hint,
            )
        found = said("a median size of {median:.6g} {unit}", median=median, unit=bounds.unit)
        expected = said(
            "{low:g} to {high:g} {unit}", low=bounds.low, high=bounds.high, unit=bounds.unit
        )
        problems.append(Problem(what, where, found, expected, hint))
    return problems


TEMPERATURES_C: Final = (-100.0, 230.0)
"""What a sensor and its electronics survive; a room in kelvin lies above."""


def strange_temperatures(columns: Mapping[str, Array], *, where: str) -> list[Problem]:
    """Temperatures that are in another unit: kelvin, counts, thousandths of a degree."""
    problems = []
    low, high = TEMPERATURES_C
    for name in ("temperature_c", "reference_temperature_c"):
        values = columns.get(name)
        part = None if values is None else sampled(values, LOOKED_AT)
        if part is None or not np.any(np.isfinite(part)):
            continue
        middle = float(np.nanmedian(part))
        if low <= middle <= high:
            continue
        problems.append(
            Problem(
                said("{name} cannot be in degrees Celsius", name=name),
                where,
                said("a median of {middle:.6g}", middle=middle),
                said("{low:g} to {high:g}", low=low, high=high),
                "kelvin or counts with an offset are converted before; "
                "thousandths take `scale` COLUMN=VALUE",
            )
        )
    return problems


def unstated_counts(
    columns: Mapping[str, Array], *, stated: Collection[str], named: Collection[str], where: str
) -> list[Problem]:
    """Sensor columns of whole numbers without a unit.

    A rate in rad/s is never a whole number. Fields, forces and tilts may be rounded to whole units,
    so they are refused only where no name says the unit either (``named`` are those that do), or
    where an axis sweeps several times what the field of the earth can.
    """
    problems = []
    for name, values in columns.items():
        if name not in SENSOR_COLUMNS or name == "output" or name in stated or values.size < 10:
            continue
        part = sampled(values, LOOKED_AT)
        swept = name in TRIPLES["mag"] and _span(part) > SWEPT_FIELD_UT
        if name in named and name not in TRIPLES["gyr"] and not swept:
            continue
        if _whole(part) and float(np.ptp(part)) > 0.0:
            unit = "deg/s" if name in TRIPLES["gyr"] else NUMBER_COLUMNS[name]
            hint = said("counts take `scale` COLUMN=VALUE (and `units` COLUMN={unit})", unit=unit)
            found = said(
                "whole numbers from {value:g} to {value2:g}",
                value=part.min(),
                value2=part.max(),
            )
            problems.append(
                Problem(
                    said("{name} is counts without a unit", name=name), where, found, "a unit", hint
                )
            )
    return problems


def off_circle(columns: Mapping[str, Array], *, where: str) -> list[Problem]:
    """Readings of a circle that no circle of degrees has; -180 to 360 is one."""
    problems = []
    for name in ("vertical_circle_deg", "horizontal_circle_deg"):
        values = columns.get(name)
        if values is None:
            continue
        bad = _first_off(values)
        if bad is not None:
            what = said("{name} is no reading of a circle", name=name)
            hint = "was it typed in gon? `units` COLUMN=gon"
            found, expected = said("{value:g} deg", value=bad), said("0 to 360 deg")
            problems.append(Problem(what, where, found, expected, hint))
    return problems


def _first_off(values: Array) -> float | None:
    """The first reading that no circle has, None where there is none."""
    for piece in pieces(values):
        bad = piece[(piece < LEAST_READING_DEG) | (piece > 360.0)]
        if bad.size:
            return float(bad[0])
    return None


def mixed_units(columns: Mapping[str, Array], *, where: str) -> list[Problem]:
    """Axes of one vector whose sizes differ by more than a factor of 100: two units in one.

    An axis that sweeps more than the earth's field does, five times more than the others, is in
    milligauss or nanotesla.
    """
    problems = []
    for name in ("mag", "acc"):
        names = TRIPLES[name]
        if not all(column in columns for column in names):
            continue
        parts = [sampled(columns[c], LOOKED_AT) for c in names]
        sizes = [float(np.median(np.abs(part))) for part in parts]
        spans = [_span(part) for part in parts]
        large = max(range(3), key=lambda i: spans[i])
        others = [spans[i] for i in range(3) if i != large]
        apart = spans[large] > 100.0 * max(others) and sizes[large] > 100.0
        if name == "mag" and spans[large] > MOST_FIELD_UT:
            apart = apart or spans[large] > 5.0 * max(others)
        if min(others) > 0.0 and apart:
            found = ", ".join(f"{c} {s:.4g}" for c, s in zip(names, spans, strict=True))
            problems.append(
                Problem(
                    said("{name}_x/y/z are in different units", name=name),
                    where,
                    said("ranges {found}", found=found),
                    "one unit for the three axes",
                    said(
                        "give each its own: `units` COLUMN=..., for {names} as well",
                        names=names[large],
                    ),
                )
            )
    return problems


def _span(values: Array) -> float:
    """Range without the outermost hundredths: gross errors are no unit."""
    low, high = np.quantile(values, (0.01, 0.99))
    return float(high - low)


def _whole(values: Array) -> bool:
    return bool(np.all(values == np.round(values)))


def gap_warning(gaps: tuple[Gap, ...]) -> list[ResultWarning]:
    """That samples are missing, where, and how long the longest gap is."""
    if not gaps:
        return []
    longest = max(gaps, key=lambda gap: gap.end_s - gap.start_s)
    text = counted(
        "{count} gap in the record; the longest from {start_s:.12g} to {end_s:.12g} s.",
        "{count} gaps in the record; the longest from {start_s:.12g} to {end_s:.12g} s.",
        count=len(gaps),
        start_s=longest.start_s,
        end_s=longest.end_s,
    )
    return [ResultWarning("gaps", text)]


def clip_warning(clipped: Mapping[str, int]) -> list[ResultWarning]:
    """That a sensor was at the end of its range."""
    return [
        ResultWarning(
            "clipped",
            said(
                "{name} stands at the end of its range in {rows} rows: larger values "
                "were lost there.",
                name=name,
                rows=rows,
            ),
        )
        for name, rows in clipped.items()
    ]
