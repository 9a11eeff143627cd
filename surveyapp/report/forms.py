"""Blank field-book forms on paper, one a method: what is written there can be typed in as rows.

The rows stand in the order in which they are observed; every table names the row kind of the book.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

from surveyapp.errors import Problem, SurveyError, nearest_names
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
    return tuple(name.ljust(16, "\N{NO-BREAK SPACE}") for name in names)


def _sights(place: str) -> tuple[Block, ...]:
    rows = [("L",), ("R",), ("L",), ("R",)]
    head = ("face", *_wide("target", "circle reading", "zenith angle", "time"))
    return (Heading(f"Sights {place} (backsight, zenith)", 2), _form(head, rows, 4))


def _tape_zero(place: str) -> tuple[Block, ...]:
    rows = [(str(index + 1),) for index in range(6)]
    head = ("no.", "side", *_wide("scale reading div", "time", "remark"))
    return (
        Heading(f"Tape zero {place}, rotor at rest (tape_zero)", 2),
        _form(head, rows, 6),
    )


def _conditions() -> tuple[Block, ...]:
    head = _wide("time", "temperature C", "supply V / Hz", "level along", "level across", "remark")
    return (Heading("Conditions (temperature, supply, level)", 2), _form(head, [], 3))


def _tracking() -> tuple[Block, ...]:
    rows = [(str(index + 1),) for index in range(12)]
    head = ("no.", "side", *_wide("circle reading", "time", "elapsed s", "remark"))
    swing = (
        Heading("Pre-orientation (clamp)", 2),
        _form(_wide("circle reading", "time", "remark"), [], 1),
        Heading("Turning points (reversal; write missed for one that was not read)", 2),
        _form(head, rows, 12),
    )
    return (*_sights("before"), *_tape_zero("before"), *swing, *_after())


def _after() -> tuple[Block, ...]:
    return (*_tape_zero("after"), *_sights("after"), *_conditions())


def _amplitude() -> tuple[Block, ...]:
    rows = [(str(index + 1),) for index in range(10)]
    head = ("no.", "side", *_wide("scale reading div", "time", "elapsed s", "remark"))
    swing = (
        Heading("Clamped alidade (clamp)", 2),
        _form(_wide("circle reading", "time", "remark"), [], 1),
        Heading("Turning points on the scale (scale_reversal)", 2),
        _form(head, rows, 10),
    )
    return (*_sights("before"), *_tape_zero("before"), *swing, *_after())


def _transit() -> tuple[Block, ...]:
    rows = [(str(index + 1),) for index in range(12)]
    head = ("no.", *_wide("division passed", "elapsed s", "scale at turning point", "side"))
    swing = (
        Heading("Clamped alidade (clamp)", 2),
        _form(_wide("circle reading", "time", "remark"), [], 1),
        Heading("Passages and turning points between them (transit, scale_reversal)", 2),
        _form(head, rows, 12),
    )
    return (*_sights("before"), *_tape_zero("before"), *swing, *_after())


def _automatic() -> tuple[Block, ...]:
    rows = [(str(index + 1),) for index in range(8)]
    head = ("round", *_wide("azimuth or north", "time", "duration s", "remark"))
    rounds = (
        Heading("Rounds (azimuth: of the line; north: circle reading of north)", 2),
        _form(head, rows, 8),
    )
    return (*_sights("before"), *rounds, *_sights("after"), *_conditions())


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
                "--blank",
                method,
                " | ".join(FORMS),
                nearest_names(method, FORMS),
            )
        )
    pairs = (
        ("project", "session"),
        ("station", "target"),
        ("instrument, no.", "theodolite, no."),
        ("observer", "booker"),
        ("date", "weather, place"),
    )
    blank = "\N{NO-BREAK SPACE}" * 44
    top = Table(
        ("", blank, "", blank),
        tuple((left, "", right, "") for left, right in pairs),
        row_height_mm=_ROW_MM,
        lined=True,
    )
    note = Paragraph(
        "Struck entries are crossed out with one line and stay legible; the entry that takes their "
        "place is written below. Side R: larger reading, east.",
        "small",
    )
    return Document(
        title=f"Field book: {method} method",
        running_head=f"Field book, {method} method",
        foot=(software,),
        blocks=(top, *FORMS[method](), note, Signature(("Observed", "Booked"))),
    )
