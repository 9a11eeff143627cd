"""A doubt about a reading in words."""

from __future__ import annotations

from surveyapp.core.observing.doubts import Question
from surveyapp.report.numbers import plain, signed_angle
from surveyapp.tui import texts


def question_text(item: Question) -> str:
    """A doubt in words."""
    if item.unit:
        return texts.QUESTIONS[item.doubt].format(
            difference=_with_unit(item.difference, item.unit),
            low="" if item.low is None else _with_unit(item.low, item.unit),
            limit=_with_unit(item.limit, item.unit),
        )
    if item.scale:
        return texts.QUESTIONS[item.doubt].format(
            difference=texts.DIVISIONS.format(value=plain(item.difference, 2, sign=True)),
            limit=texts.DIVISIONS.format(value=plain(item.limit, 2)),
        )
    return texts.QUESTIONS[item.doubt].format(
        difference=signed_angle(item.difference), limit=signed_angle(item.limit).lstrip("+")
    )


def _with_unit(value: float, unit: str) -> str:
    names = {"C": "°C", "deg": "°", "arcsec": '"'}
    gap = "" if unit in ("deg", "arcsec") else " "
    return f"{value:.10g}{gap}{names.get(unit, unit)}" if unit != "s" else f"{value:.0f} s"
