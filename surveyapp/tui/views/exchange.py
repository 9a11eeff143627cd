"""An import as text: what was understood, what was left out, what must be told."""

from __future__ import annotations

from collections.abc import Sequence

from rich.text import Text

from surveyapp.domain.fieldfile import ImportResult
from surveyapp.languages import shown
from surveyapp.observation.exchange import Entry
from surveyapp.tui import texts
from surveyapp.tui.views.form import number_text

_MOST = 40


def entry_text(entry: Entry) -> str:
    """A line of the file list."""
    return entry.name if not entry.format else f"{entry.name}  {entry.kilobytes:.0f} kB"


def _seconds(value: object) -> str:
    return f'{value:+.1f}"' if isinstance(value, float) else "-"


def _block(text: Text, title: str, lines: Sequence[str]) -> None:
    if not lines:
        return
    text.append(f"\n{title}\n", style="bold")
    for line in lines[:_MOST]:
        text.append(f"  {line}\n")
    if len(lines) > _MOST:
        text.append(f"  {texts.IMPORT_MORE.format(count=len(lines) - _MOST)}\n")


def import_text(result: ImportResult) -> Text:
    """What an import understood, warnings first: they decide whether it is taken."""
    head = texts.IMPORT_HEAD.format(
        variant=result.variant, readings=result.readings, rows=result.rows
    )
    text = Text(f"{head}\n")
    _block(text, texts.IMPORT_TOLD, [f"{x.code}: {shown(x.text)}" for x in result.warnings])
    skipped = [texts.IMPORT_LINE.format(line=x.line, text=shown(x.text)) for x in result.skipped]
    _block(text, texts.IMPORT_LEFT_OUT, skipped)
    stations = [
        f"{x.name}  {number_text(x.e, 3)}  {number_text(x.n, 3)}  {number_text(x.h, 3)}  {x.state}"
        for x in result.stations
    ]
    _block(text, texts.IMPORT_STATIONS, stations)
    sets = []
    for item in result.sets:
        values = item.to_dict()
        sets.append(
            texts.IMPORT_SET.format(
                name=item.name,
                at=item.at,
                targets=" ".join(values["targets"]),
                faces=values["faces"],
                c=_seconds(values["collimation_arcsec"]),
                i=_seconds(values["index_arcsec"]),
            )
        )
    _block(text, texts.IMPORT_SETS, sets)
    return text
