"""Sensor logs, cards and previews as blocks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from surveyapp.domain.log_preview import LogPreview, PreviewedColumn
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.languages import joined
from surveyapp.languages.names import named
from surveyapp.observation.sensors.desk import CardShown
from surveyapp.report.blocks import Block, Heading, KeyValues, Paragraph, Table
from surveyapp.report.numbers import four_digits
from surveyapp.report.sections.sensors import parameter_table
from surveyapp.tui import texts

CELLS_SHOWN = 2


def log_table(logs: Sequence[SensorLogEntry], cards: Sequence[CardShown]) -> Table:
    """A row a log, with the card that was made from it."""
    rows: list[tuple[str, ...]] = []
    for entry in logs:
        card = card_of(entry, cards)
        rows.append(
            (
                entry.id,
                entry.kind or texts.NOT_DETERMINED,
                entry.programme or "",
                "" if card is None else card.path.rpartition("/")[2],
                "" if card is None else validity(card),
            )
        )
    head = (texts.COL_LOG, texts.COL_KIND, texts.COL_PROGRAMME, texts.COL_CARD, texts.COL_VALID)
    return Table(head, tuple(rows))


def card_of(entry: SensorLogEntry, cards: Sequence[CardShown]) -> CardShown | None:
    """The card whose source is a log, the last one where there are several."""
    found = [
        shown
        for shown in cards
        if shown.card is not None and shown.card.source.startswith(f"{entry.id}, ")
    ]
    return found[-1] if found else None


def validity(shown: CardShown) -> str:
    """Until when a card holds."""
    if shown.card is None:
        return texts.SENSOR_CARD_BROKEN
    if not shown.holds:
        return texts.SENSOR_CARD_OVER
    until = shown.card.valid_to
    return texts.SENSOR_ANY if until is None else texts.SENSOR_CARD_HOLDS.format(day=until)


def card_table(cards: Sequence[CardShown]) -> Table:
    """A row a card."""
    rows = tuple(
        (
            shown.path,
            "" if shown.card is None else shown.card.kind,
            "" if shown.card is None else str(shown.card.calibrated_on or ""),
            validity(shown),
        )
        for shown in cards
    )
    return Table((texts.COL_CARD, texts.COL_KIND, texts.COL_CALIBRATED, texts.COL_VALID), rows)


def log_details(entry: SensorLogEntry) -> tuple[Block, ...]:
    """What project.toml says of a log."""
    values = {
        "file": entry.file,
        "columns": ", ".join(f"{k} = {v}" for k, v in entry.columns.items()),
        "units": ", ".join(f"{k} {v}" for k, v in entry.units.items()),
        "scale": ", ".join(f"{k} {v:g}" for k, v in entry.scale.items()),
        "rate": "" if entry.rate_hz is None else f"{entry.rate_hz:g} Hz",
        "instrument": " ".join(filter(None, (entry.instrument, entry.serial))),
        "latitude": "" if entry.latitude_deg is None else f"{entry.latitude_deg:g}",
        "calibrated_on": str(entry.calibrated_on or ""),
        "sha256": (entry.sha256 or "")[:16],
        "effects": joined(", ", [named(effect.id) for effect in entry.effects]),
    }
    return (_facts(texts.SENSOR_FACTS_LOG, values),)


def _facts(names: Mapping[str, str], values: Mapping[str, str]) -> KeyValues:
    return KeyValues(tuple((names[key], value) for key, value in values.items() if value))


def card_details(shown: CardShown) -> tuple[Block, ...]:
    """Parameters of a card, where it is from and where it holds."""
    card = shown.card
    refused = () if shown.holds else (Paragraph(shown.problem, "warning"),)
    if card is None:
        return refused
    first, last = (day or texts.SENSOR_ANY for day in (card.valid_from, card.valid_to))
    span = card.temperature_c
    values = {
        "title": card.title,
        "source": card.source,
        "days": texts.SENSOR_DAYS.format(first=first, last=last),
        "temperatures": texts.SENSOR_ANY
        if span is None
        else texts.SENSOR_TEMPERATURES.format(low=span[0], high=span[1]),
        "notes": "; ".join(card.notes.values()),
    }
    odd = tuple(Paragraph(warning.text, "warning") for warning in card.warnings)
    facts = _facts(texts.SENSOR_FACTS_CARD, values)
    return (facts, *refused, *odd, parameter_table(card.parameters))


def preview_blocks(preview: LogPreview) -> tuple[Block, ...]:
    """What was understood of a log: problems first, they decide whether it is taken."""
    rate = "" if preview.rate_hz is None else texts.ADD_LOG_RATE.format(rate=preview.rate_hz)
    found: list[Block] = []
    if preview.rows:
        found.append(Paragraph(texts.ADD_LOG_HEAD.format(rows=preview.rows, rate=rate)))
    warnings = tuple(joined(": ", (w.code, w.text)) for w in preview.warnings)
    for title, lines in (
        (texts.ADD_LOG_WRONG, preview.problems),
        (texts.ADD_LOG_TOLD, warnings),
    ):
        if lines:
            found.append(Heading(title, 2))
            found += [Paragraph(line, "small") for line in lines]
    rows = tuple(_column_row(column) for column in preview.columns)
    return (*found, Table(texts.ADD_LOG_COLUMNS, rows, "lllrrl"))


def _column_row(column: PreviewedColumn) -> tuple[str, ...]:
    unit = column.unit
    if column.canonical is not None and not column.stated and column.name != column.canonical:
        unit = texts.ADD_LOG_ASSUMED.format(unit=unit)
    if column.factor != 1.0:
        unit = texts.ADD_LOG_FACTOR.format(unit=unit, factor=column.factor)
    return (
        column.name,
        column.canonical or texts.ADD_LOG_NOT_KNOWN,
        unit,
        four_digits(column.low),
        four_digits(column.high),
        " ".join(column.first[:CELLS_SHOWN]),
    )
