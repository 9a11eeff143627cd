"""A run under observation as lines of text."""

from __future__ import annotations

from surveyapp.core.forecast import PointForecast
from surveyapp.core.progress import Progress
from surveyapp.core.run_alert import Alert
from surveyapp.tui import texts
from surveyapp.tui.views.form import arcsec_text
from surveyapp_models.angles import AngleUnit, format_angle


def countdown_text(forecast: PointForecast | None, remaining_s: float | None) -> str:
    """Side of the next turning point and the time to it."""
    if forecast is None:
        return ""
    if remaining_s is None:
        pattern = texts.NEXT_SIDE if forecast.moment_s is None else texts.NEXT_LONG_PAST
        return pattern.format(side=forecast.side)
    minutes, seconds = divmod(round(abs(remaining_s)), 60)
    sign = "-" if round(remaining_s) < 0 else ""
    time = f"{sign}{minutes}:{seconds:02d}"
    spread = forecast.moment_half_width_s or 0.0
    pattern = texts.NEXT_NOW if abs(remaining_s) <= max(spread, 10.0) else texts.NEXT_POINT
    return pattern.format(side=forecast.side, time=time)


def forecast_text(progress: Progress, unit: AngleUnit) -> str:
    """The predicted reading with its interval."""
    if progress.next is None or progress.next_reading is None:
        return ""
    text = texts.NEXT_READING.format(reading=format_angle(progress.next_reading, unit))
    if progress.next.half_width is not None:
        interval = arcsec_text(progress.next.half_width)
        text += texts.NEXT_INTERVAL.format(interval=interval)
    return text


def north_text(progress: Progress, unit: AngleUnit) -> str:
    """Gyro north with its interval."""
    if progress.north is None:
        return texts.NORTH_NONE
    north = format_angle(progress.north, unit)
    if progress.interval95 is None:
        return texts.NORTH_OPEN.format(north=north)
    return texts.NORTH_NOW.format(north=north, interval=arcsec_text(progress.interval95))


def outlook_text(progress: Progress, wanted: float | None) -> str:
    """What two more points would bring, what is wanted, and whether it is enough."""
    parts = []
    if progress.interval95_two_more is not None:
        parts.append(texts.AFTER_TWO.format(interval=arcsec_text(progress.interval95_two_more)))
    if wanted is None:
        parts.append(texts.NO_WANTED)
    else:
        parts.append(texts.WANTED.format(interval=arcsec_text(wanted)))
        if progress.enough(wanted):
            parts.append(texts.ENOUGH)
    return "  ".join(parts)


def schuler_text(progress: Progress, unit: AngleUnit, shown: int = 2) -> str:
    """The latest Schuler means."""
    means = progress.schuler_means[-shown:]
    if not means:
        return ""
    values = "  ".join(format_angle(mean, unit) for mean in means)
    return f"{texts.SCHULER}  {values}"


def channel_lines(progress: Progress, shown: int) -> tuple[str, ...]:
    """Residuals in the channels of midpoint and amplitude, the latest at the end."""
    if not progress.midpoint:
        return ()
    return tuple(
        f"{label} " + "".join(f"{arcsec_text(value, sign=True):>7}" for value in values[-shown:])
        for label, values in (
            (texts.CHANNEL_MIDPOINT, progress.midpoint),
            (texts.CHANNEL_AMPLITUDE, progress.amplitude),
        )
    )


def alert_text(alert: Alert | None) -> str:
    """What to do about a run that breaks the model."""
    if alert is None:
        return ""
    return texts.ALERTS[alert.trouble].format(number=alert.index + 1, p=alert.p)
