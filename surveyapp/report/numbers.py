"""Numbers as a record prints them: one place for decimals, signs and what is not known."""

from __future__ import annotations

import math

from surveyapp.domain.results import AngleResult, to_arcsec
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle

NOTHING = "-"


def plain(value: float | None, decimals: int = 1, *, sign: bool = False) -> str:
    """A number with fixed decimals, ``-`` where it is not determined."""
    if value is None or not math.isfinite(value):
        return NOTHING
    text = f"{value:+.{decimals}f}" if sign else f"{value:.{decimals}f}"
    return text.replace("-0.", "0.", 1) if float(text) == 0.0 and not sign else text


def seconds(angle: float | None, decimals: int = 2, *, sign: bool = False) -> str:
    """A small angle [rad] in arc-seconds."""
    return plain(to_arcsec(angle), decimals, sign=sign)


def signed_angle(angle: float | None) -> str:
    """A small angle [rad] with its sign: seconds, from a minute and a degree on those as well."""
    if angle is None or not math.isfinite(angle):
        return NOTHING
    total = round(abs(angle) * RHO_ARCSEC, 2)
    sign = "-" if angle < 0.0 and total > 0.0 else "+"
    minutes, rest = divmod(total, 60.0)
    if not minutes:
        return f'{sign}{rest:.2f}"'
    degrees, minutes = divmod(minutes, 60.0)
    if not degrees:
        return f"{sign}{minutes:.0f}'{rest:05.2f}\""
    return f"{sign}{degrees:.0f}\N{DEGREE SIGN}{minutes:02.0f}'{rest:05.2f}\""


def direction(angle: float | None, unit: AngleUnit, decimals: int = 1) -> str:
    """A direction [rad] in the project's unit."""
    return NOTHING if angle is None else format_angle(angle, unit, decimals)


def with_sigma(item: AngleResult | None, unit: AngleUnit) -> tuple[str, str, str]:
    """A direction, its sigma and the half-width of its 95 % interval [arcsec]."""
    if item is None:
        return NOTHING, NOTHING, NOTHING
    return direction(item.value, unit), seconds(item.sigma), seconds(item.interval95)


def decimals_of(sigma: float | None) -> int | None:
    """Decimals that show two digits of a standard deviation; None where there is none."""
    if sigma is None or not math.isfinite(sigma) or sigma <= 0.0:
        return None
    return max(0, 1 - math.floor(math.log10(sigma)))


def by_sigma(value: float | None, sigma: float | None) -> str:
    """A number with four significant digits, or as many as its sigma is worth."""
    decimals = decimals_of(sigma)
    if value is None or decimals is None or sigma is None or sigma > 5e-4 * abs(value):
        return four_digits(value)
    return plain(value, decimals)


def dms_beside(name: str, value: float | None) -> str:
    """Degrees, minutes and seconds of a reading in degrees, for beside its unit; else nothing."""
    if name != "instrument_constant" or value is None:
        return ""
    return format_angle(math.radians(value), AngleUnit.DMS, 2)


def line_name(station: str, target: str | None) -> str:
    """A line as people write it; a station alone where it has no target."""
    return station if target is None else f"{station}-{target}"


def four_digits(value: float | None) -> str:
    """A number with four significant digits."""
    return NOTHING if value is None or not math.isfinite(value) else f"{value:.4g}"
