"""A run under observation as lines of text."""

from __future__ import annotations

from surveyapp.api_session import Aim
from surveyapp.core.forecast import PointForecast
from surveyapp.core.progress import Progress
from surveyapp.core.run_alert import Alert
from surveyapp.core.target import Target
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


def outlook_text(progress: Progress, aim: Aim) -> str:
    """What two more points would bring, what is wanted, and whether it is enough."""
    parts = []
    if progress.interval95_two_more is not None:
        parts.append(texts.AFTER_TWO.format(interval=arcsec_text(progress.interval95_two_more)))
    target = aim.target
    if target is None:
        parts.append(_no_target(aim))
        return "  ".join(parts)
    pattern = texts.WANTED if target.origin == "session" else texts.RULE_TARGET
    parts.append(pattern.format(interval=arcsec_text(target.interval95)))
    if progress.enough(target.interval95):
        parts.append(texts.ENOUGH)
    return "  ".join(parts)


def _no_target(aim: Aim) -> str:
    if aim.problem:
        return texts.TARGET_PROBLEM.format(problem=aim.problem)
    return texts.TARGET_NOT_IN_BOOK.format(book=aim.book) if aim.book else texts.NO_TARGET_SET


def target_source_text(target: Target | None) -> str:
    """Where the rule book's target comes from; empty where the session named its own."""
    if target is None or target.origin == "session":
        return ""
    text = texts.TARGET_SOURCE.format(
        sigma=arcsec_text(target.sigma), book=target.book, clause=target.clause
    )
    return text if target.confirmed else text + texts.TARGET_UNCONFIRMED


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
