"""An import as blocks: what was understood, what was left out, what must be told."""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.domain.fieldfile import ImportResult
from surveyapp.languages import joined
from surveyapp.observation.exchange import Entry
from surveyapp.report.blocks import Block, Heading, Paragraph, Table
from surveyapp.report.numbers import plain
from surveyapp.tui import texts

_MOST = 40


def entry_text(entry: Entry) -> str:
    """A line of the file list."""
    if not entry.format:
        return entry.name
    size = f"{entry.kilobytes:.0f}" if entry.kilobytes >= 10.0 else f"{entry.kilobytes:.1f}"
    return f"{entry.name}  {size} kB"


def import_blocks(result: ImportResult) -> tuple[Block, ...]:
    """What an import understood, warnings first: they decide whether it is taken."""
    head = texts.IMPORT_HEAD.format(
        variant=result.variant, readings=result.readings, rows=result.rows
    )
    skipped = [texts.IMPORT_LINE.format(line=x.line, text=x.text) for x in result.skipped]
    return (
        Paragraph(head),
        *_lines(texts.IMPORT_TOLD, [joined(": ", (x.code, x.text)) for x in result.warnings]),
        *_lines(texts.IMPORT_LEFT_OUT, skipped),
        *_table(texts.IMPORT_STATIONS, _stations(result)),
        *_table(texts.IMPORT_SETS, _sets(result)),
    )


def _lines(title: str, lines: Sequence[str]) -> tuple[Block, ...]:
    if not lines:
        return ()
    more = (texts.IMPORT_MORE.format(count=len(lines) - _MOST),) if len(lines) > _MOST else ()
    shown = (*lines[:_MOST], *more)
    return (Heading(title, 2), *(Paragraph(line, "small") for line in shown))


def _table(title: str, table: Table) -> tuple[Block, ...]:
    if not table.rows:
        return ()
    more = len(table.rows) - _MOST
    tail = (Paragraph(texts.IMPORT_MORE.format(count=more), "small"),) if more > 0 else ()
    return (Heading(title, 2), Table(table.head, table.rows[:_MOST], table.align), *tail)


def _stations(result: ImportResult) -> Table:
    rows = tuple(
        (x.name, plain(x.e, 3), plain(x.n, 3), plain(x.h, 3), x.state) for x in result.stations
    )
    return Table(texts.IMPORT_STATION_HEAD, rows, "lrrrl")


def _sets(result: ImportResult) -> Table:
    rows = []
    for item in result.sets:
        values = item.to_dict()
        targets = " ".join(values["targets"])
        errors = (values["collimation_arcsec"], values["index_arcsec"])
        told = (plain(value, sign=True) for value in errors)
        rows.append((item.name, item.at, targets, str(values["faces"]), *told))
    return Table(texts.IMPORT_SET_HEAD, tuple(rows), "lllrrr")
