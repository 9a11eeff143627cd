"""Values of a step, and what is to be done with clamp and brake, as lines of text."""

from __future__ import annotations

from surveyapp.core.observing.step_values import StepValues
from surveyapp.core.observing.steps import Step
from surveyapp.report.numbers import plain, seconds
from surveyapp.tui import texts
from surveyapp_models.angles import AngleUnit, format_angle


def care_text(step: Step, method: str, *, enough: bool = False) -> str:
    """What the hand must not forget at a step; empty where there is nothing."""
    if step is Step.SWING and method != "automatic":
        return texts.CARE_END if enough else ""
    return (texts.CARE_AUTOMATIC if method == "automatic" else texts.CARE)[step]


def value_lines(values: StepValues, unit: AngleUnit) -> list[str]:
    """Means, 2c, index and tape zero of a step, and what changed since before."""
    lines = []
    for sight in values.sights:
        mean = format_angle(sight.mean, unit)
        if sight.two_c is None:
            lines.append(texts.VALUE_SIGHT_ONE.format(target=sight.target, mean=mean))
        else:
            two_c = seconds(sight.two_c, 1, sign=True)
            lines.append(texts.VALUE_SIGHT.format(target=sight.target, mean=mean, two_c=two_c))
        if sight.change is not None:
            change = seconds(sight.change, 1, sign=True)
            lines.append(texts.VALUE_SIGHT_CHANGE.format(target=sight.target, change=change))
    for zenith in values.zeniths:
        index = seconds(zenith.index, 1, sign=True)
        mean = format_angle(zenith.mean, unit)
        lines.append(texts.VALUE_ZENITH.format(target=zenith.target, mean=mean, index=index))
    zero = values.zero
    if zero is not None:
        mean = plain(zero.mean_div, 3, sign=True)
        lines.append(texts.VALUE_ZERO.format(mean=mean, points=zero.points))
        if zero.change_div is not None:
            change = plain(zero.change_div, 3, sign=True)
            lines.append(texts.VALUE_ZERO_CHANGE.format(change=change))
    return lines
