"""Sensor logs, cards and previews as rows and text."""

from __future__ import annotations

from collections.abc import Sequence

from rich.text import Text

from surveyapp.domain.log_preview import LogPreview, PreviewedColumn
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.languages import shown, translated
from surveyapp.observation.sensors.desk import CardShown
from surveyapp.report.numbers import four_digits
from surveyapp.tui import texts
from surveyapp.tui.widgets.records import pairs_text, table_text

LOG_COLUMNS = (texts.COL_LOG, texts.COL_KIND, texts.COL_PROGRAMME, texts.COL_CARD, texts.COL_VALID)
CARD_COLUMNS = (texts.COL_CARD, texts.COL_KIND, texts.COL_CALIBRATED, texts.COL_VALID)
CELLS_SHOWN = 2


def log_rows(logs: Sequence[SensorLogEntry], cards: Sequence[CardShown]) -> list[tuple[str, ...]]:
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
    return rows


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


def card_rows(cards: Sequence[CardShown]) -> list[tuple[str, ...]]:
    """A row a card."""
    return [
        (
            shown.path,
            "" if shown.card is None else shown.card.kind,
            "" if shown.card is None else str(shown.card.calibrated_on or ""),
            validity(shown),
        )
        for shown in cards
    ]


def log_details(entry: SensorLogEntry) -> Text:
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
        "effects": ", ".join(effect.id.replace("_", " ") for effect in entry.effects),
    }
    pairs = [(texts.SENSOR_FACTS_LOG[key], value) for key, value in values.items() if value]
    return pairs_text(pairs)


def card_details(shown: CardShown) -> Text:
    """Parameters of a card, where it is from and where it holds."""
    card = shown.card
    if card is None:
        return Text(shown.problem)
    days = texts.SENSOR_DAYS.format(
        first=card.valid_from or texts.SENSOR_ANY, last=card.valid_to or texts.SENSOR_ANY
    )
    span = card.temperature_c
    values = {
        "title": card.title,
        "source": card.source,
        "days": days,
        "temperatures": texts.SENSOR_ANY if span is None else f"{span[0]:g} to {span[1]:g} C",
        "notes": "; ".join(card.notes.values()),
    }
    pairs = [(texts.SENSOR_FACTS_CARD[key], value) for key, value in values.items() if value]
    text = pairs_text(pairs)
    if not shown.holds:
        text.append(f"{shown.problem}\n", style="bold")
    text.append("\n")
    rows = [
        (
            translated(item.name.replace("_", " ")),
            four_digits(item.value),
            four_digits(item.sigma),
            item.unit,
        )
        for item in card.parameters
    ]
    return text.append_text(table_text(rows, left=(0, 3)))


def preview_text(preview: LogPreview) -> Text:
    """What was understood of a log: problems first, they decide whether it is taken."""
    rate = "" if preview.rate_hz is None else texts.ADD_LOG_RATE.format(rate=preview.rate_hz)
    text = Text()
    if preview.rows:
        text.append(texts.ADD_LOG_HEAD.format(rows=preview.rows, rate=rate) + "\n")
    _block(text, texts.ADD_LOG_WRONG, preview.problems)
    _block(text, texts.ADD_LOG_TOLD, [f"{w.code}: {shown(w.text)}" for w in preview.warnings])
    text.append("\n")
    rows = [texts.ADD_LOG_COLUMNS, *(_column_row(column) for column in preview.columns)]
    return text.append_text(table_text(rows, left=(0, 1, 2, 5)))


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


def _block(text: Text, title: str, lines: Sequence[str]) -> None:
    if lines:
        text.append(f"{title}\n", style="bold")
        for line in lines:
            text.append(f"  {line}\n")
