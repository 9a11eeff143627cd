"""Values as text: angles in the project's unit, small ones with their sign. Nothing is computed."""

from __future__ import annotations

from surveyapp.domain.results import AngleResult, finite, to_arcsec
from surveyapp.report.numbers import signed_angle
from surveyapp.tui import texts
from surveyapp_models.angles import AngleUnit, format_angle


def angle_text(item: AngleResult | None, unit: AngleUnit) -> str:
    """An angle in the project's unit."""
    return texts.NOT_DETERMINED if item is None else format_angle(item.value, unit)


def sigma_text(item: AngleResult | None) -> str:
    """The sigma of an angle in arc-seconds."""
    return arcsec_text(None if item is None else item.sigma)


def interval_text(item: AngleResult | None) -> str:
    """Half-width of the 95 % interval in arc-seconds."""
    return arcsec_text(None if item is None else finite(item.interval95))


def arcsec_text(value: float | None, decimals: int = 1, *, sign: bool = False) -> str:
    """An angle [rad] in arc-seconds."""
    return number_text(to_arcsec(value), decimals, sign=sign)


def number_text(value: float | None, decimals: int = 1, *, sign: bool = False) -> str:
    """A number with fixed decimals, a dash where it is not determined."""
    if value is None or finite(value) is None:
        return texts.NOT_DETERMINED
    return f"{value:{'+' if sign else ''}.{decimals}f}"


def small_text(value: float | None) -> str:
    """A small angle [rad]: its sign and seconds, from a minute and a degree on those as well."""
    return signed_angle(value)
