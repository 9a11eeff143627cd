"""The field book as it was observed: every row, struck ones visible as struck."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from surveyapp.domain.project import OrientationSession, Project
from surveyapp.domain.readings import Reading, ReadingKind
from surveyapp.languages import joined, said, said_each, term
from surveyapp.report.blocks import Block, Heading, KeyValues, Paragraph, Table
from surveyapp.report.numbers import plain

_COLUMNS: Final[tuple[tuple[str, str, Callable[[Reading], str]], ...]] = (
    (said("seq"), "r", lambda row: str(row.seq)),
    (said("time"), "l", lambda row: "" if row.time is None else row.time.isoformat(sep=" ")),
    (said("elapsed s"), "r", lambda row: "" if row.elapsed_s is None else f"{row.elapsed_s:g}"),
    (said("kind"), "l", lambda row: row.kind.value),
    (said("value"), "r", lambda row: row.text),
    (said("unit"), "l", lambda row: row.unit),
    (said("face"), "c", lambda row: "" if row.face is None else row.face.value),
    (said("side"), "c", lambda row: "" if row.side is None else row.side.value),
    (said("target"), "l", lambda row: row.target),
    (
        said("temp. C"),
        "r",
        lambda row: plain(row.temperature_c, 1) if row.temperature_c is not None else "",
    ),
)
_ALWAYS: Final = said_each("seq", "kind", "value")


def blocks(project: Project) -> tuple[Block, ...]:
    """Blocks of every session's book."""
    found: list[Block] = []
    for session in project.sessions:
        found += _session(session)
    return (Heading(said("Field book as observed")), *found) if found else ()


def _session(session: OrientationSession) -> list[Block]:
    line = session.station if session.target is None else f"{session.station}-{session.target}"
    facts = [
        (said("line"), line),
        (said("instrument, method"), joined(", ", (session.instrument, term(session.method)))),
        (said("purpose"), term(session.purpose)),
        (said("book"), session.book_path),
    ]
    if session.date is not None:
        facts.append((said("date"), session.date.isoformat()))
    if session.observer:
        facts.append((said("observer"), session.observer))
    facts += [
        (key.replace("_", " "), str(value))
        for key, value in session.override
        if key in ("rounds", "sigma_arcsec", "note")
    ]
    found: list[Block] = [Heading(said("Session {id}", id=session.id), 2), KeyValues(tuple(facts))]
    if session.book.torn_tail is not None:
        text = said(
            "The last line had no newline and does not count: {torn_tail}",
            torn_tail=session.book.torn_tail,
        )
        found.append(Paragraph(text, "warning"))
    if not session.book.rows:
        return [*found, Paragraph(said("The book is empty."))]
    return [*found, _rows(session)]


def _rows(session: OrientationSession) -> Table:
    rows = session.book.rows
    used = [
        column for column in _COLUMNS if column[0] in _ALWAYS or any(column[2](row) for row in rows)
    ]
    reasons = {
        row.strikes: said("struck by row {seq}", seq=row.seq)
        + (f": {row.note}" if row.note else "")
        for row in rows
        if row.kind is ReadingKind.STRIKE and row.strikes is not None
    }
    struck = frozenset(i for i, row in enumerate(rows) if row.seq in session.book.struck)
    lines = []
    for row in rows:
        remark = row.note
        if row.seq in session.book.struck:
            struck_by = reasons.get(row.seq, said("struck"))
            remark = joined("; ", [part for part in (row.note, struck_by) if part])
        lines.append((*(text(row) for _, _, text in used), remark or ""))
    head = (*(name for name, _, _ in used), said("note"))
    if not any(line[-1] for line in lines):
        head, lines = head[:-1], [line[:-1] for line in lines]
    align = "".join(letter for _, letter, _ in used) + "l"
    return Table(head, tuple(lines), align[: len(head)], struck=struck)
