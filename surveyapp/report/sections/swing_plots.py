"""Pictures of one session: its swing, and the residuals of its points."""

from __future__ import annotations

import math

from surveyapp.domain.results import SessionResult
from surveyapp.languages import said
from surveyapp.report.blocks import Figure
from surveyapp.report.plots import Frame, axis, half_wave
from surveyapp_models.angles import RHO_ARCSEC, wrap_pi


def plots(item: SessionResult) -> list[Figure]:
    """Turning points with the fitted swing, then the residuals, where there are any."""
    residuals = [(float(p.index + 1), p.residual) for p in item.points if p.residual is not None]
    scale = item.method in ("amplitude", "transit")
    figures = []
    if len(item.points) > 2 and item.method != "automatic":
        figures.append(_scale_swing(item) if scale else _swing(item))
    if len(residuals) > 1:
        factor, unit = (1.0, said("div")) if scale else (RHO_ARCSEC, said("arcsec"))
        points = [(x, y * factor) for x, y in residuals]
        figures.append(_residuals(item, points, unit))
    return figures


def _swing(item: SessionResult) -> Figure:
    """Turning points about gyro north in arc-minutes, the fitted swing between them."""
    reference = item.gyro_north.value if item.gyro_north is not None else item.points[0].observed
    reference -= item.tape_zero_correction or 0.0

    def minutes(angle: float) -> float:
        return wrap_pi(angle - reference) * RHO_ARCSEC / 60.0

    observed = [(float(p.index + 1), minutes(p.observed)) for p in item.points]
    fitted = [(float(p.index + 1), minutes(p.fitted)) for p in item.points if p.fitted is not None]
    frame = Frame(
        axis([x for x, _ in observed], count=10, whole=True),
        axis([y for _, y in observed], about_zero=True),
    )
    parts = frame.axes(said("turning point"), said("arcmin from gyro north as observed"))
    parts.append(frame.level(0.0, "mean"))
    if len(fitted) > 1:
        parts.append(frame.curve(half_wave(fitted), "data"))
    parts += frame.marks(observed, "circle")
    return frame.figure(said("Swing: circles observed, line fitted"), parts)


def _scale_swing(item: SessionResult) -> Figure:
    """Turning points on the scale, the fitted swing between them."""
    observed = [(float(p.index + 1), p.observed) for p in item.points]
    fitted = [(float(p.index + 1), p.fitted) for p in item.points if p.fitted is not None]
    frame = Frame(
        axis([x for x, _ in observed], count=10, whole=True), axis([y for _, y in observed])
    )
    parts = frame.axes(said("turning point"), said("divisions"))
    middle = {name: value for name, value, _ in item.quantities}.get("middle of the swing")
    if middle is not None:
        parts.append(frame.level(middle, "mean"))
    if len(fitted) > 1:
        parts.append(frame.curve(half_wave(fitted), "data"))
    parts += frame.marks(observed, "circle")
    title = said("Swing on the scale: circles observed, line fitted; dashed: its middle")
    return frame.figure(title, parts)


def _residuals(item: SessionResult, points: list[tuple[float, float]], unit: str) -> Figure:
    sigma = None
    if item.reading_sigma is not None and math.isfinite(item.reading_sigma):
        sigma = item.reading_sigma * (RHO_ARCSEC if unit == "arcsec" else 1.0)
    values = [y for _, y in points] + ([2.0 * sigma] if sigma else [])
    frame = Frame(
        axis([x for x, _ in points], count=10, whole=True),
        axis(values, about_zero=True),
        height_mm=45.0,
    )
    parts = frame.axes(said("point"), unit)
    parts.append(frame.level(0.0, "axis"))
    if sigma:
        parts += [frame.level(2.0 * sigma, "limit"), frame.level(-2.0 * sigma, "limit")]
    for x, y in points:
        parts += frame.bar(x, low=min(0.0, y), high=max(0.0, y))
    parts += frame.marks(points, "dot")
    title = (
        said("Residuals; dashed: twice the sigma of one reading") if sigma else said("Residuals")
    )
    return frame.figure(title, parts)
