"""An adjusted traverse as rows of text; what is wrong is a word and never a colour alone."""

from __future__ import annotations

import math
from collections.abc import Sequence

from surveyapp.domain.adjustment import AdjustedObservation, AdjustmentResult
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.results import Check
from surveyapp.languages import translated
from surveyapp.tui import texts
from surveyapp.tui.views.checks import quantity_text
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle, wrap_two_pi

MM = 1e3
POINT_COLUMNS = (
    texts.COL_POINT,
    texts.COL_EASTING,
    texts.COL_NORTHING,
    texts.COL_HEIGHT,
    texts.COL_ELLIPSE,
)
OBSERVATION_COLUMNS = (
    texts.COL_KIND,
    texts.COL_SIGHT,
    texts.COL_RESIDUAL,
    texts.COL_TEST,
    texts.COL_REDUNDANCY,
)
CLOSURE_COLUMNS = (texts.COL_ROUTE, texts.COL_ANGLES, texts.COL_PLACE, texts.COL_RELATIVE)
CHECK_COLUMNS = (texts.COL_VERDICT, texts.COL_CHECK, texts.COL_VALUE, texts.COL_LIMIT)


def _number(value: float | None, decimals: int = 1, *, sign: bool = False) -> str:
    if value is None:
        return "-"
    return f"{value:+.{decimals}f}" if sign else f"{value:.{decimals}f}"


def point_rows(result: AdjustmentResult) -> list[tuple[str, ...]]:
    """Each point with its coordinates and its standard ellipse."""
    return [
        (
            p.name,
            *(_number(value, 3) for value in (p.e, p.n, p.h)),
            texts.FIXED_POINT
            if p.ellipse is None
            else f"{p.ellipse.a_m * MM:.1f} x {p.ellipse.b_m * MM:.1f}",
        )
        for p in result.points
    ]


def point_details(result: AdjustmentResult, row: int) -> list[tuple[str, str]]:
    """Sigmas and ellipse of one point."""
    p = result.points[row]
    names = (texts.COL_EASTING, texts.COL_NORTHING, texts.COL_HEIGHT)
    values = zip(names, (p.e, p.n, p.h), (p.sigma_e, p.sigma_n, p.sigma_h), strict=True)
    pairs = [
        (name, f"{value:.4f} m  ±{_number(None if s is None else s * MM)} mm")
        for name, value, s in values
        if value is not None
    ]
    if p.ellipse is not None:
        azimuth = f"{math.degrees(p.ellipse.azimuth):.0f}°"
        axes = f"{p.ellipse.a_m * MM:.1f} x {p.ellipse.b_m * MM:.1f} mm"
        pairs.append((texts.COL_ELLIPSE, f"{axes}, {texts.T_LONG_AXIS} {azimuth}"))
    return pairs


def _unit(item: AdjustedObservation) -> tuple[float, str]:
    return (RHO_ARCSEC, '"') if item.angular else (MM, " mm")


def _sight(item: AdjustedObservation) -> str:
    return "-".join(name for name in (item.back, item.at, item.to) if name)


def observation_rows(result: AdjustmentResult) -> list[tuple[str, ...]]:
    """Each observation with its residual and what controls it."""
    rows: list[tuple[str, ...]] = []
    accused = {item.place for item in result.snooping.suspects[:1]}
    for item in result.observations:
        scale, unit = _unit(item)
        word = texts.SUSPECT if item.place in accused and item.place >= 0 else ""
        rows.append(
            (
                translated(str(item.kind).replace("_", " ")),
                _sight(item),
                f"{item.residual * scale:+.1f}{unit}",
                f"{_number(item.standardized, 1, sign=True)} {word}".strip(),
                _number(item.redundancy, 2),
            )
        )
    return rows


def observation_details(
    result: AdjustmentResult, row: int, unit: AngleUnit
) -> list[tuple[str, str]]:
    """Everything about one observation."""
    item = result.observations[row]
    scale, small = _unit(item)

    def value(number: float) -> str:
        if not item.angular:
            return f"{number:.4f} m"
        if item.kind is ObservationKind.GYRO_CONSTANT:
            return f'{number * RHO_ARCSEC:+.1f}"'
        return format_angle(wrap_two_pi(number), unit)

    def few(number: float | None) -> str:
        return "-" if number is None else f"{number * scale:.1f}{small}"

    moves = None if item.mdb_effect_m is None else item.mdb_effect_m * MM
    return [
        (texts.COL_SIGHT, _sight(item)),
        (texts.T_OBSERVED, f"{value(item.observed)}  ±{few(item.sigma)}"),
        (texts.T_ADJUSTED, f"{value(item.adjusted)}  ±{few(item.sigma_adjusted)}"),
        (texts.COL_RESIDUAL, few(item.residual)),
        (texts.COL_TEST, _number(item.standardized, 2, sign=True)),
        (texts.COL_REDUNDANCY, _number(item.redundancy, 3)),
        (texts.T_BIAS, few(item.mdb)),
        (texts.T_BIAS_MOVES, "-" if moves is None else f"{moves:.1f} mm"),
    ]


def closure_rows(result: AdjustmentResult) -> list[tuple[str, ...]]:
    """Each misclosure before the adjustment."""
    rows: list[tuple[str, ...]] = []
    for item in result.closures:
        relative = "-"
        if item.linear_m and item.length_m:
            relative = f"1 : {item.length_m / item.linear_m:.0f}"
        angles = "-"
        if item.angular is not None:
            angles = f'{item.angular * RHO_ARCSEC:+.1f}"'
            if item.angular_sigma is not None:
                angles += f" ±{item.angular_sigma * RHO_ARCSEC:.1f}"
        place = item.linear_m if item.linear_m is not None else item.height_m
        route = f"{item.stations[0]} - ({len(item.stations)}) - {item.stations[-1]}"
        rows.append((route, angles, "-" if place is None else f"{place * MM:.1f} mm", relative))
    return rows


def ordered(checks: Sequence[Check]) -> list[Check]:
    """What is not met first, what is open last."""
    order = {False: 0, True: 1, None: 2}
    return sorted(checks, key=lambda check: order[check.passed])


def check_rows(checks: Sequence[Check]) -> list[tuple[str, ...]]:
    """Each check in one row."""
    return [
        (
            translated(check.verdict),
            check.rule,
            quantity_text(check.value, check.unit),
            quantity_text(check.limit, check.unit),
        )
        for check in ordered(checks)
    ]


def state_text(result: AdjustmentResult) -> str:
    """The global test in a few words."""
    test = result.global_test
    if test.ratio is None:
        return texts.T_UNCONTROLLED
    word = {True: texts.MET, False: texts.NOT_MET, None: texts.OPEN}[test.passed]
    return texts.T_STATE.format(ratio=f"{test.ratio:.2f}", dof=result.dof, word=word)
