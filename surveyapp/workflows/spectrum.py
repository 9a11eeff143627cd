"""``spectrum``: interference lines of a column, its magnetic budget, and two states compared."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surveyapp.core.sensors.adopted_effects import EVENT_COLUMNS
from surveyapp.diagnosis.long_records.interference import (
    Interference,
    deviation_of,
    find_interference,
    plotted_density,
    scatter_of,
)
from surveyapp.domain.advance import PartDone
from surveyapp.domain.line_spectrum import LineSpectrum, MagneticBudget
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import NUMBER_COLUMNS, SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.languages import said
from surveyapp.workflows.adopted_effects import read_without_adopted
from surveyapp.workflows.noise import FEWEST
from surveyapp_models.rate.triad import magnetic_bias

GYROS = ("gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s")


@dataclass(frozen=True, slots=True)
class MagneticOptions:
    """Field [uT], sensitivity [deg/h per T] and shielding factor as stated."""

    field_uT: float | None = None  # noqa: N815  the unit of the contract
    sensitivity_deg_h_t: float | None = None
    shielding: float | None = None


def find_spectrum(
    file: LogFile,
    column: str,
    *,
    magnetic: MagneticOptions,
    against: LogFile | None = None,
    entry: SensorLogEntry | None = None,
    progress: PartDone | None = None,
) -> LineSpectrum:
    """Lines of a column, without effects that were adopted for the log of the entry.

    Raises
    ------
    SurveyError
    """
    problems = _magnetic_problems(magnetic)
    column = _canonical(file, column)
    columns = [column] if against is None else _axes(file, against, column)
    try:
        log = _read(file, list(dict.fromkeys([column, *columns])), progress, entry)
    except SurveyError as error:
        raise SurveyError([*problems, *error.problems]) from None
    if problems:
        raise SurveyError(problems)
    found = find_interference(log.columns["time_s"], log.columns[column])
    result = _spectrum(log, column, found, _budget(magnetic))
    if against is None:
        return result
    other = _read(against, columns, progress)
    return replace(result, against=_compared(log, other, columns))


def _canonical(file: LogFile, column: str) -> str:
    """The name under which a column of the file is held."""
    if file.has(column):
        return column
    return next((n for n, place in file.places.items() if place.name == column), column)


def _axes(file: LogFile, other: LogFile, column: str) -> list[str]:
    """The three axes that both files hold: the gyros, or the column with x, y and z in its name."""
    gyros = [c for c in GYROS if file.has(c) and other.has(c)]
    if column in gyros:
        return gyros
    for k, letter in enumerate(column):
        if letter.lower() in "xyz":
            upper = letter.isupper()
            names = [column[:k] + (a.upper() if upper else a) + column[k + 1 :] for a in "xyz"]
            both = [n for n in names if file.has(n) and other.has(n)]
            if len(both) > 1:
                return both
    return [column]


def _read(
    file: LogFile,
    columns: list[str],
    progress: PartDone | None,
    entry: SensorLogEntry | None = None,
) -> SensorLog:
    known = tuple(c for c in columns if c in NUMBER_COLUMNS)
    others = tuple(c for c in columns if c not in NUMBER_COLUMNS)
    need = Need(columns=known, varying=tuple(columns), optional=(), others=others)
    changed = [c for c in columns if c in GYROS or c in EVENT_COLUMNS]
    log = read_without_adopted(file, need, entry if changed else None, progress=progress)
    if log.size < FEWEST:
        found, expected = (
            said("{size} rows", size=log.size),
            said("{fewest} rows or more", fewest=FEWEST),
        )
        raise SurveyError(Problem("the log is too short", log.path, found, expected))
    return log


def _magnetic_problems(magnetic: MagneticOptions) -> list[Problem]:
    problems = []
    if (magnetic.field_uT is None) != (magnetic.sensitivity_deg_h_t is None):
        missing = "sensitivity" if magnetic.sensitivity_deg_h_t is None else "field_uT"
        problems.append(
            Problem("a magnetic budget needs field and sensitivity", missing, "", "both of them")
        )
    if magnetic.shielding is not None and not magnetic.shielding > 0.0:
        found = f"{magnetic.shielding:g}"
        problems.append(Problem("this is no shielding factor", "shielding", found, "above 0"))
    return problems


def _budget(magnetic: MagneticOptions) -> MagneticBudget | None:
    if magnetic.field_uT is None or magnetic.sensitivity_deg_h_t is None:
        return None
    shielding = 1.0 if magnetic.shielding is None else magnetic.shielding
    bias = magnetic_bias(
        magnetic.field_uT * 1e-6, sensitivity=magnetic.sensitivity_deg_h_t, shielding=shielding
    )
    return MagneticBudget(magnetic.field_uT, magnetic.sensitivity_deg_h_t, shielding, bias)


def _spectrum(
    log: SensorLog, column: str, found: Interference, magnetic: MagneticBudget | None
) -> LineSpectrum:
    values = log.columns[column]
    rate = log.rate_hz or 1.0
    unit = log.units.get(column, "1")
    warnings = list(log.warnings)
    if found.unsearched:
        warnings.append(ResultWarning("no_lines_searched", found.unsearched))
    frequency, density = plotted_density(values, rate_hz=rate)
    scatter = scatter_of(values, found.rest, rate_hz=rate, unit=unit)
    if found.lines and scatter.before_10s and scatter.after_10s is not None:
        change = 100.0 * (scatter.after_10s / scatter.before_10s - 1.0)
        text = said(
            "taking the lines out changes the scatter of 10 s means by "
            "{change:+.1f} %: lines average out within seconds",
            change=change,
        )
        warnings.append(ResultWarning("means", text))
    return LineSpectrum(
        source=log.id,
        column=column,
        unit=unit,
        n=log.size,
        rate_hz=rate,
        lines=found.lines,
        families=found.families,
        scatter=scatter,
        magnetic=magnetic,
        warnings=tuple(warnings),
        sha256=log.sha256,
        frequency_hz=tuple(frequency.tolist()),
        density=tuple(density.tolist()),
    )


def _compared(first: SensorLog, second: SensorLog, columns: list[str]) -> dict[str, Any]:
    """Two states of a turntable: per axis the scatter, what is new, and both spectra in dB."""
    axes = []
    for column in columns:
        one, two = first.columns[column], second.columns[column]
        found_one = find_interference(first.columns["time_s"], one)
        found_two = find_interference(second.columns["time_s"], two)
        old = np.array([line.frequency_hz for line in found_one.lines])
        slack = 2.0 / min(_length(first), _length(second))
        new = [
            line.to_dict()
            for line in found_two.lines
            if np.abs(old - line.frequency_hz).min(initial=np.inf) > slack
        ]
        sd_one, sd_two = deviation_of(one), deviation_of(two)
        axes.append(
            {
                "column": column,
                "unit": first.units.get(column, "1"),
                "sd_first": sd_one,
                "sd_second": sd_two,
                "sd_ratio": sd_two / sd_one if sd_one > 0.0 else None,
                "lines_first": [line.to_dict() for line in found_one.lines],
                "lines_second": [line.to_dict() for line in found_two.lines],
                "new_lines": new,
                "families_second": [family.to_dict() for family in found_two.families],
                "first": _in_db(one, first.rate_hz or 1.0),
                "second": _in_db(two, second.rate_hz or 1.0),
            }
        )
    return {"source": second.id, "sha256": second.sha256, "axes": axes}


def _length(log: SensorLog) -> float:
    """From the first to the last sample [s]."""
    return float(log.columns["time_s"][-1] - log.columns["time_s"][0])


def _in_db(values: np.ndarray, rate_hz: float) -> dict[str, list[float]]:
    """Power spectral density in dB re unit^2/Hz, and the amplitude of a line of that height."""
    frequency, density = plotted_density(values, rate_hz=rate_hz)
    block = min(values.size, 1 << 14)
    # a sine A at the centre of a bin has the density A^2 n / (3 f), Hann taper
    amplitude = np.sqrt(density * 3.0 * rate_hz / block)
    return {
        "frequency_hz": frequency.tolist(),
        "psd_db": (10.0 * np.log10(np.maximum(density, 1e-300))).tolist(),
        "amplitude": amplitude.tolist(),
    }
