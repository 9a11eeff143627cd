"""A sensor log into a project: which column is what, and what was understood."""

from __future__ import annotations

from pathlib import Path

from surveyapp.domain.log_preview import LogPreview
from surveyapp.observation.exchange import Entry
from surveyapp.observation.sensors import adding
from surveyapp.report.blocks import Block, KeyValues, Paragraph
from surveyapp.tui import texts
from surveyapp.tui.screens.files import FilesScreen, PartRead
from surveyapp.tui.views.sensors import preview_blocks


class AddLogScreen(FilesScreen[LogPreview]):
    """Takes the logs of compasses, tilt and rate sensors.

    Parameters
    ----------
    folder : str
        The project.
    begin : str
        Folder whose files are listed first.
    """

    CHOOSE = (
        Paragraph(texts.ADD_LOG_CHOOSE),
        KeyValues(tuple(texts.ADD_LOG_OPTIONS.items())),
        Paragraph(texts.ADD_LOG_TAKE),
    )
    OPTIONS = texts.LOG_OPTIONS
    HINT = texts.ADD_LOG_HINT

    def __init__(self, folder: str, begin: str = ".") -> None:
        super().__init__(texts.ADD_LOG_TITLE.format(name=Path(folder).resolve().name), begin)
        self.folder = folder

    def listed(self, place: str) -> list[Entry]:
        """Folders and files that may be logs."""
        return adding.log_entries(place)

    def look(self, entry: Entry, options: str, *, preview: bool, progress: PartRead) -> LogPreview:
        """Read it with the columns that are named; take it into ``sensors/``."""
        del progress
        return (
            adding.look_at(entry, options) if preview else adding.take(self.folder, entry, options)
        )

    def told(self, found: LogPreview) -> tuple[tuple[Block, ...], str, bool]:
        """What was understood of every column."""
        if found.written is not None:
            return preview_blocks(found), texts.ADD_LOG_TAKEN.format(path=found.written), True
        state = texts.ADD_LOG_BAD if found.problems else texts.ADD_LOG_GOOD
        return preview_blocks(found), state, False
