"""Blank field-book forms on paper, one a method: what is written there can be typed in as rows.

The rows stand in the order in which they are observed; every table names the row kind of the book.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said
from surveyapp.report.blocks import Block, Document, Heading, Paragraph, Signature, Table

_ROW_MM: Final = 6.5


def _form(head: tuple[str, ...], first: Sequence[tuple[str, ...]], rows: int) -> Table:
    """Table of empty rows; the first cells of each row may be printed."""
    lines = []
    for index in range(rows):
        given = first[index] if index < len(first) else ()
        lines.append((*given, *[""] * (len(head) - len(given))))
    return Table(head, tuple(lines), row_height_mm=_ROW_MM, lined=True)


def _wide(*names: str) -> tuple[str, ...]:
    """Column heads padded so that a form has room to write."""
    return tuple(name + "\N{NO-BREAK SPACE}" * (16 - len(name)) for name in names)


def _sights(place: str) -> tuple[Block, ...]:
    rows = [("L",), ("R",), ("L",), ("R",)]
    head = (
        said("face"),
        *_wide(said("target"), said("circle reading"), said("zenith angle"), said("time")),
    )
    return (
        Heading(said("Sights {place} (backsight, zenith)", place=place), 2),
        _form(head, rows, 4),
    )


def _tape_zero(place: str) -> tuple[Block, ...]:
    rows = [(str(index + 1),) for index in range(6)]
    head = (
        said("no."),
        said("side"),
        *_wide(said("scale reading div"), said("time"), said("remark")),
    )
    return (
        Heading(said("Tape zero {place}, rotor at rest (tape_zero)", place=place), 2),
        _form(head, rows, 6),
    )


def _conditions() -> tuple[Block, ...]:
    head = _wide(
        said("time"),
        said("temperature C"),
        said("supply V / Hz"),
        said("level along"),
        said("level across"),
        said("remark"),
    )
    return (Heading(said("Conditions (temperature, supply, level)"), 2), _form(head, [], 3))


def _tracking() -> tuple[Block, ...]:
    rows = [(str(index + 1),) for index in range(12)]
    head = (
        said("no."),
        said("side"),
        *_wide(said("circle reading"), said("time"), said("elapsed s"), said("remark")),
    )
    swing = (
        Heading(said("Pre-orientation (clamp)"), 2),
        _form(_wide(said("circle reading"), said("time"), said("remark")), [], 1),
        Heading(said("Turning points (reversal; write missed for one that was not read)"), 2),
        _form(head, rows, 12),
    )
    return (*_sights(said("before")), *_tape_zero(said("before")), *swing, *_after())


def _after() -> tuple[Block, ...]:
    return (*_tape_zero(said("after")), *_sights(said("after")), *_conditions())


def _amplitude() -> tuple[Block, ...]:
    rows = [(str(index + 1),) for index in range(10)]
    head = (
        said("no."),
        said("side"),
        *_wide(said("scale reading div"), said("time"), said("elapsed s"), said("remark")),
    )
    swing = (
        Heading(said("Clamped alidade (clamp)"), 2),
        _form(_wide(said("circle reading"), said("time"), said("remark")), [], 1),
        Heading(said("Turning points on the scale (scale_reversal)"), 2),
        _form(head, rows, 10),
    )
    return (*_sights(said("before")), *_tape_zero(said("before")), *swing, *_after())


def _transit() -> tuple[Block, ...]:
    rows = [(str(index + 1),) for index in range(12)]
    head = (
        said("no."),
        *_wide(
            said("division passed"), said("elapsed s"), said("scale at turning point"), said("side")
        ),
    )
    swing = (
        Heading(said("Clamped alidade (clamp)"), 2),
        _form(_wide(said("circle reading"), said("time"), said("remark")), [], 1),
        Heading(said("Passages and turning points between them (transit, scale_reversal)"), 2),
        _form(head, rows, 12),
    )
    return (*_sights(said("before")), *_tape_zero(said("before")), *swing, *_after())


def _automatic() -> tuple[Block, ...]:
    rows = [(str(index + 1),) for index in range(8)]
    head = (
        said("round"),
        *_wide(said("azimuth or north"), said("time"), said("duration s"), said("remark")),
    )
    rounds = (
        Heading(said("Rounds (azimuth: of the line; north: circle reading of north)"), 2),
        _form(head, rows, 8),
    )
    return (*_sights(said("before")), *rounds, *_sights(said("after")), *_conditions())


FORMS: Final[Mapping[str, Callable[[], tuple[Block, ...]]]] = {
    "tracking": _tracking,
    "amplitude": _amplitude,
    "transit": _transit,
    "automatic": _automatic,
}
"""Forms by method."""


def blank_form(method: str, *, software: str) -> Document:
    """Form of a method.

    Raises
    ------
    SurveyError
        If there is no such method.
    """
    if method not in FORMS:
        raise SurveyError(
            Problem(
                "there is no form for this method",
                "blank",
                method,
                " | ".join(FORMS),
                nearest_names(method, FORMS),
            )
        )
    pairs = (
        (said("project"), said("session")),
        (said("station"), said("target")),
        (said("instrument, no."), said("theodolite, no.")),
        (said("observer"), said("booker")),
        (said("date"), said("weather, place")),
    )
    blank = "\N{NO-BREAK SPACE}" * 44
    top = Table(
        ("", blank, "", blank),
        tuple((left, "", right, "") for left, right in pairs),
        row_height_mm=_ROW_MM,
        lined=True,
    )
    note = Paragraph(
        said(
            "Struck entries are crossed out with one line and stay legible; the entry "
            "that takes their place is written below. Side R: larger reading, east."
        ),
        "small",
    )
    return Document(
        title=said("Field book: {method} method", method=method),
        running_head=said("Field book, {method} method", method=method),
        foot=(software,),
        blocks=(top, *FORMS[method](), note, Signature((said("Observed"), said("Booked")))),
    )
