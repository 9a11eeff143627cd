"""A field file into a project."""

from __future__ import annotations

from pathlib import Path

from surveyapp.domain.fieldfile import ImportResult
from surveyapp.observation import exchange
from surveyapp.report.blocks import Block, Paragraph
from surveyapp.tui import texts
from surveyapp.tui.screens.files import FilesScreen, PartRead
from surveyapp.tui.views.exchange import import_blocks


class ImportScreen(FilesScreen[ImportResult]):
    """Takes the files of total stations and automatic gyros.

    Parameters
    ----------
    folder : str
        The project.
    begin : str
        Folder whose files are listed first.
    """

    CHOOSE = (Paragraph(texts.IMPORT_CHOOSE),)
    OPTIONS = texts.IMPORT_OPTIONS
    HINT = texts.IMPORT_HINT

    def __init__(self, folder: str, begin: str = ".") -> None:
        super().__init__(texts.IMPORT_TITLE.format(name=Path(folder).resolve().name), begin)
        self.folder = folder

    def listed(self, place: str) -> list[exchange.Entry]:
        """Folders and field files."""
        return exchange.entries(place)

    def look(
        self, entry: exchange.Entry, options: str, *, preview: bool, progress: PartRead
    ) -> ImportResult:
        """As ``surveyapp import``."""
        return exchange.bring(entry, self.folder, options, preview=preview, progress=progress)

    def told(self, found: ImportResult) -> tuple[tuple[Block, ...], str, bool]:
        """What was understood."""
        state = texts.IMPORT_TAKEN if found.written else texts.IMPORT_PREVIEW
        return import_blocks(found), state, found.written
