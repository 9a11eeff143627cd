"""Texts of the screens for files of other programs."""

from __future__ import annotations

from typing import Final

KEY_IMPORT: Final = "Import"
KEY_EXPORT: Final = "Export"
KEY_PREVIEW: Final = "Preview"
KEY_TAKE: Final = "Take it"
KEY_WRITE: Final = "Write"
LONG_IMPORT: Final = "Import a field file of a total station or gyro"
LONG_EXPORT: Final = "Export for other programs"
IMPORT_TITLE: Final = "{name}: import"
EXPORT_TITLE: Final = "{name}: export"
IMPORT_OPTIONS: Final = "Options"
IMPORT_HINT: Final = "traverse=main station-code=21 fix=A,B at=Stn hz=HA unit.hz=gon skip-damaged"
IMPORT_CHOOSE: Final = (
    "Enter on a file shows what is understood of it; F8 takes it into the project. Nothing is "
    "written before. Tab leads to the options, page keys move this text."
)
IMPORT_CHOOSE_FIRST: Final = "choose a file first"
IMPORT_READING: Final = "reading ..."
IMPORT_PART: Final = "reading, {percent} %"
IMPORT_PREVIEW: Final = "preview: F8 takes it"
IMPORT_TAKEN: Final = "taken into the project"
IMPORT_REFUSED: Final = "not understood"
IMPORT_HEAD: Final = "{variant}: {readings} readings, {rows} rows"
IMPORT_STATIONS: Final = "Stations"
IMPORT_SETS: Final = "Sets, mean of the faces"
IMPORT_STATION_HEAD: Final = ("station", "E m", "N m", "H m", "state")
IMPORT_SET_HEAD: Final = ("set", "at", "to", "faces", 'collimation "', 'index "')
IMPORT_LEFT_OUT: Final = "Left out"
IMPORT_TOLD: Final = "Told"
IMPORT_LINE: Final = "line {line}: {text}"
IMPORT_MORE: Final = "and {count} more"
EXPORT_FILE: Final = "File"
EXPORT_STATE: Final = "F8 writes"
EXPORT_DONE: Final = "{path}: {items} items"
KEY_MAKE_IMPORT: Final = "Make + import"
