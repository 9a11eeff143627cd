"""A run under observation as lines of text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from surveyapp.core.observing.passage_forecast import PassageForecast
from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.target import Target
from surveyapp.observation.aim import Aim
from surveyapp.report.numbers import plain, seconds
from surveyapp.report.text import filled
from surveyapp.tui import texts
from surveyapp.tui.cells import columns
from surveyapp_models.angles import AngleUnit, format_angle

if TYPE_CHECKING:
    from surveyapp.diagnosis.outlook import ActionResult

WIDTH = 54
"""Columns beside the steps in a terminal of 80."""
RESIDUAL_WIDTH = 7
NEAR_S = 10.0
"""A moment is near this long before and after it, longer where it is known less sharply."""


def is_near(progress: Progress, remaining_s: float | None) -> bool:
    """Whether what is waited for is about to come: the signal is given."""
    if remaining_s is None:
        return False
    if progress.passage is not None:
        return abs(remaining_s) <= max(progress.passage.half_width_s, NEAR_S)
    spread = 0.0 if progress.next is None else progress.next.moment_half_width_s or 0.0
    return abs(remaining_s) <= max(spread, NEAR_S)


def countdown_text(progress: Progress, remaining_s: float | None) -> str:
    """The next turning point or passage, and the time to it."""
    if progress.passage is not None:
        return _passage_text(progress.passage, remaining_s, near=is_near(progress, remaining_s))
    forecast = progress.next
    if forecast is None:
        return ""
    side = forecast.side or texts.NEXT_ANY
    if remaining_s is None:
        pattern = texts.NEXT_SIDE if forecast.moment_s is None else texts.NEXT_LONG_PAST
        return pattern.format(side=side)
    pattern = texts.NEXT_NOW if is_near(progress, remaining_s) else texts.NEXT_POINT
    text = pattern.format(side=side, time=_clock_text(remaining_s))
    if progress.scale and forecast.moment_half_width_s is not None:
        text += texts.NEXT_SPREAD.format(seconds=plain(forecast.moment_half_width_s, 0))
    return text


def _passage_text(passage: PassageForecast, remaining_s: float | None, *, near: bool) -> str:
    way = texts.WAYS[passage.way]
    if remaining_s is None:
        return texts.PASSAGE_OVERDUE.format(way=way)
    pattern = texts.NEXT_PASSAGE_NOW if near else texts.NEXT_PASSAGE
    spread = texts.NEXT_SPREAD.format(seconds=plain(passage.half_width_s))
    return pattern.format(way=way, time=_clock_text(remaining_s)) + spread


def _clock_text(remaining_s: float) -> str:
    minutes, seconds = divmod(round(abs(remaining_s)), 60)
    sign = "-" if round(remaining_s) < 0 else ""
    return f"{sign}{minutes}:{seconds:02d}"


def forecast_text(progress: Progress, unit: AngleUnit) -> str:
    """The predicted reading of the next turning point with its interval."""
    forecast = progress.next
    if forecast is None or progress.next_reading is None:
        return ""
    if progress.scale:
        reading = plain(progress.next_reading, 2, sign=True)
        pattern = texts.NEXT_READING_DIV if progress.passage is None else texts.NEXT_POINT_DIV
        text = pattern.format(side=forecast.side, reading=reading)
        if forecast.half_width is None:
            return text
        return text + texts.NEXT_INTERVAL_DIV.format(interval=plain(forecast.half_width, 2))
    text = texts.NEXT_READING.format(reading=format_angle(progress.next_reading, unit))
    if forecast.half_width is not None:
        text += texts.NEXT_INTERVAL.format(interval=seconds(forecast.half_width, 1))
    return text


_NORTH_NONE = {
    "tracking": texts.NORTH_NONE,
    "amplitude": texts.NORTH_NONE_SCALE,
    "transit": texts.NORTH_NONE_TRANSIT,
    "automatic": texts.NORTH_NONE_ROUND,
}


def north_text(progress: Progress, unit: AngleUnit, method: str) -> str:
    """Gyro north, or the delivered azimuth, with its interval; else why there is none."""
    if progress.north is None:
        if progress.missing:
            told = texts.NORTH_MISSING.format(problem=progress.missing)
            return filled(told, WIDTH)
        return _NORTH_NONE[method]
    north = format_angle(progress.north, unit)
    if progress.interval95 is None:
        pattern = texts.AZIMUTH_OPEN if progress.delivered else texts.NORTH_OPEN
        return pattern.format(north=north)
    pattern = texts.AZIMUTH_NOW if progress.delivered else texts.NORTH_NOW
    return pattern.format(north=north, interval=seconds(progress.interval95, 1))


def outlook_text(progress: Progress, aim: Aim) -> str:
    """What two more points would bring, what is wanted, and whether it is enough."""
    parts = []
    if progress.interval95_two_more is not None:
        parts.append(texts.AFTER_TWO.format(interval=seconds(progress.interval95_two_more, 1)))
    target = aim.target
    if target is None:
        parts.append(_no_target(aim))
        return "  ".join(parts)
    pattern = texts.WANTED if target.origin == "session" else texts.RULE_TARGET
    parts.append(pattern.format(interval=seconds(target.interval95, 1)))
    if progress.enough(target.interval95):
        parts.insert(0, texts.ENOUGH)  # in sight in the narrowest window
    return "  ".join(parts)


def next_lines(actions: Sequence[ActionResult], shown: int = 2) -> list[str]:
    """What to observe next, best first: how sure the cause would be, and the interval then.

    The interval is that of north, or where determinations of a constant are next that of a line
    in a month.
    """
    lines = []
    for place, item in enumerate(actions[:shown]):
        pattern = texts.NEXT_ACTION if place == 0 else texts.ELSE_ACTION
        if item.action in texts.CAMPAIGN_ACTIONS:
            pattern = texts.NEXT_CAMPAIGN if place == 0 else texts.ELSE_CAMPAIGN
        short = {**texts.ACTIONS, **texts.CAMPAIGN_ACTIONS}
        lines.append(
            pattern.format(
                action=short.get(item.action, item.text),
                share=f"{item.separation:.0%}",
                interval=seconds(item.interval95, 1),
            )
        )
    return lines


def _no_target(aim: Aim) -> str:
    if aim.problem:
        return texts.TARGET_PROBLEM.format(problem=aim.problem)
    return texts.TARGET_NOT_IN_BOOK.format(book=aim.book) if aim.book else texts.NO_TARGET_SET


def target_source_text(target: Target | None) -> str:
    """Where the rule book's target comes from; empty where the session named its own."""
    if target is None or target.origin == "session":
        return ""
    text = texts.TARGET_SOURCE.format(
        sigma=seconds(target.sigma, 1), book=target.book, clause=target.clause
    )
    return text if target.confirmed else text + texts.TARGET_UNCONFIRMED


def schuler_text(progress: Progress, unit: AngleUnit, shown: int = 2) -> str:
    """The latest Schuler means."""
    means = progress.schuler_means[-shown:]
    if not means:
        return ""
    if progress.scale:
        values = "  ".join(plain(mean, 3, sign=True) for mean in means)
        return f"{texts.SCHULER_DIV}  {values}"
    values = "  ".join(format_angle(mean, unit) for mean in means)
    return f"{texts.SCHULER}  {values}"


def time_difference_text(progress: Progress, shown: int = 4) -> str:
    """The latest time differences east minus west."""
    latest = progress.time_differences[-shown:]
    values = "  ".join(plain(value, 2, sign=True) for value in latest)
    return texts.TIME_DIFFERENCES.format(values=values) if values else ""


def channel_lines(progress: Progress) -> tuple[str, ...]:
    """Residuals in the channels of midpoint and amplitude, as many as fit, the latest last."""
    if not progress.midpoint:
        return ()
    labels = (texts.CHANNEL_MIDPOINT, texts.CHANNEL_AMPLITUDE)
    if progress.scale:
        labels = (texts.CHANNEL_MIDPOINT_DIV, texts.CHANNEL_AMPLITUDE_DIV)
    shown = min(6, (WIDTH - 1 - max(map(columns, labels))) // RESIDUAL_WIDTH)
    return tuple(
        f"{label} "
        + "".join(f"{residual_text(progress, v):>{RESIDUAL_WIDTH}}" for v in values[-shown:])
        for label, values in zip(labels, (progress.midpoint, progress.amplitude), strict=True)
    )


def residual_text(progress: Progress, value: float) -> str:
    """A residual in arc-seconds, on the scale in divisions."""
    if progress.scale:
        return plain(value, 3, sign=True)
    return seconds(value, 1, sign=True)


def alert_text(progress: Progress, method: str) -> str:
    """What to do about a run that breaks the model."""
    alert = progress.alert
    if alert is None:
        return ""
    pattern = texts.ALERTS[alert.trouble]
    if method == "automatic":
        pattern = texts.ROUND_ALERT
    elif method != "tracking":
        pattern = texts.CLAMPED_ALERTS.get(alert.trouble, pattern)
    return pattern.format(number=alert.index + 1, p=alert.p, share=alert.share)
