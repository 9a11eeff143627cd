"""What a source printed beside what the program computes: for the measured samples."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from surveyapp.domain.results import OrientationResult, to_arcsec
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle, parse_angle, wrap_pi


@dataclass(frozen=True, slots=True)
class Comparison:
    """One printed value beside the computed one.

    Parameters
    ----------
    quantity : str
    printed, computed : str
        As text, in the source's own way of writing.
    difference : float or None
        Computed minus printed, in ``unit``; None where one of them is missing.
    unit : str
    """

    quantity: str
    printed: str
    computed: str
    difference: float | None
    unit: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "quantity": self.quantity,
            "printed": self.printed,
            "computed": self.computed,
            "difference": self.difference,
            "unit": self.unit,
        }


def compare_with_print(
    expected: Mapping[str, Any], result: OrientationResult
) -> tuple[Comparison, ...]:
    """Lay every printed value of an ``expected.json`` beside its computed counterpart.

    Parameters
    ----------
    expected : mapping
        ``sessions[]``, ``constants[]`` and ``lines[]``, each with a table ``printed``.
    result : OrientationResult
        Computed with the estimator that the source used.
    """
    rows: list[Comparison] = []
    for entry in expected.get("sessions", []):
        rows += _session(entry, result)
    for entry in expected.get("constants", []):
        rows += _constant(entry, result)
    for entry in expected.get("lines", []):
        rows += _line(entry, result)
    return tuple(rows)


def _angle(quantity: str, printed: str, computed: float | None) -> Comparison:
    if computed is None:
        return Comparison(quantity, printed, "-", None, "arcsec")
    difference = wrap_pi(computed - parse_angle(printed, AngleUnit.DMS)) * RHO_ARCSEC
    text = format_angle(computed, AngleUnit.DMS, 2)
    return Comparison(quantity, printed, text, difference, "arcsec")


def _number(
    quantity: str, printed: float, computed: float | None, *, unit: str, decimals: int
) -> Comparison:
    if computed is None or not math.isfinite(computed):
        return Comparison(quantity, f"{printed:+.{decimals}f}", "-", None, unit)
    return Comparison(
        quantity,
        f"{printed:+.{decimals}f}",
        f"{computed:+.{decimals + 1}f}",
        computed - printed,
        unit,
    )


def _series(name: str, printed: Sequence[str], computed: Sequence[float]) -> list[Comparison]:
    return [
        _angle(f"{name} {number}", text, value)
        for number, (text, value) in enumerate(zip(printed, computed, strict=False), start=1)
    ]


def _session(entry: Mapping[str, Any], result: OrientationResult) -> list[Comparison]:
    session = next(item for item in result.sessions if item.id == entry["id"])
    printed = entry["printed"]
    rows = []
    if "gyro_north" in printed:
        north = None if session.gyro_north is None else session.gyro_north.value
        rows.append(_angle(f"gyro north ({session.estimator})", printed["gyro_north"], north))
    rows += _series("equilibrium", printed.get("equilibria", []), session.schuler_means)
    zeros = () if session.tape_zero is None else session.tape_zero.schuler_before_div
    for number, (text, value) in enumerate(
        zip(printed.get("tape_zeros_div", []), zeros, strict=False), start=1
    ):
        rows.append(_number(f"tape zero {number}", text, value, unit="div", decimals=1))
    if "tape_zero_mean_div" in printed:
        mean = None if session.tape_zero is None else session.tape_zero.value_div
        rows.append(
            _number("tape zero, mean", printed["tape_zero_mean_div"], mean, unit="div", decimals=1)
        )
    return rows


def _constant(entry: Mapping[str, Any], result: OrientationResult) -> list[Comparison]:
    name = f"{entry['station']}-{entry['target']}"
    value = None
    for constant in result.constants:
        for line in constant.by_line:
            if (line.station, line.target) == (entry["station"], entry["target"]):
                value = to_arcsec(line.value)
    printed = entry["printed"]["constant_arcsec"]
    return [_number(f"constant of {name}", printed, value, unit="arcsec", decimals=2)]


def _line(entry: Mapping[str, Any], result: OrientationResult) -> list[Comparison]:
    name = f"{entry['station']}-{entry['target']}"
    grid = None
    for line in result.lines:
        if (line.station, line.target) == (entry["station"], entry["target"]):
            grid = None if line.grid_azimuth is None else line.grid_azimuth.value
    return [_angle(f"grid azimuth {name}", entry["printed"]["grid_azimuth"], grid)]


@dataclass(frozen=True, slots=True)
class DemonstratedSample:
    """One sample: where it comes from, what was printed, what is computed.

    Parameters
    ----------
    name, folder, source : str
    result : OrientationResult
        With the estimator that the source used.
    default : OrientationResult
        With the program's own choice.
    comparisons : tuple of Comparison
    """

    name: str
    folder: str
    source: str
    result: OrientationResult
    default: OrientationResult
    comparisons: tuple[Comparison, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "name": self.name,
            "source": self.source,
            "comparisons": [row.to_dict() for row in self.comparisons],
            "passed": self.default.passed,
        }
