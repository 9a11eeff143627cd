"""Home, and the forms for a project, a session and practice."""

from __future__ import annotations

from typing import Final

# home
HOME_TITLE: Final = "surveyapp: gyro orientation"
HOME_RECENT: Final = "Recent projects"
HOME_NO_RECENT: Final = "  none yet"
HOME_SAMPLES: Final = "Samples (opened as your own copy; synthetic ones say so by name)"
HOME_MORE: Final = "Begin"
HOME_NEW: Final = "New project ..."
HOME_OPEN: Final = "Open a folder ..."
HOME_PRACTISE: Final = "Practise on a simulated instrument ..."
HOME_LANGUAGE: Final = "Language: English, Deutsch, Русский, 中文 ..."
KEY_LANGUAGE: Final = "Language"
LANGUAGE_NOT_KEPT: Final = "The settings cannot be written: set the language by LANGUAGE=de"
HOME_FOLDER: Final = "project folder"
HOME_FOLDER_TITLE: Final = "Which folder? Enter opens it."

# new project
NEW_TITLE: Final = "New project"
NEW_STATE: Final = "F8 makes it"
F_NAME: Final = "Name"
F_FOLDER: Final = "Folder"
F_FOLDER_HINT: Final = "a folder that does not exist yet"
F_GRID: Final = "Grid"
F_GRID_HINT: Final = "part of its name, or EPSG code; empty for none"
F_FOLDER_MADE: Final = "becomes {path}"
F_MINE_GRID: Final = "Mine grid"
F_MINE_GRID_HINT: Final = "rotation, origin e n, base e n, sigma; empty: none"
F_GRIDS: Final = "{count} grids; Down and Enter choose"
F_GRIDS_HERE: Final = "{count} grids where the stations lie; Down and Enter choose"
F_GRIDS_MANY: Final = "the first {count} grids; type more of the name"
F_GRIDS_NONE: Final = "no grid of this name"
F_GRIDS_NONE_HERE: Final = "no grid of this name where the stations lie"
F_UNIT: Final = "Angles"
F_TYPING: Final = "Typing"
F_RULES: Final = "Rule book"
F_STATIONS: Final = "Stations"
F_STATIONS_HINT: Final = (
    "One a line: name, east, north, height. Or a first line that\n"
    "names the columns: name, lat, lon, h. Or a CSV file's path."
)
F_INSTRUMENT: Final = "Instrument"
F_INSTRUMENT_ID: Final = "Its id"
F_SERIAL: Final = "Serial no."
F_SCALE: Final = "Scale value"
F_SCALE_HINT: Final = "arc-seconds of one division, as the owner determined it"
F_PERIODS: Final = "Periods"
F_PERIODS_HINT: Final = "T1 and T2 in s, latitude in deg, like 425.4 388.3 47.0"
F_TORSION: Final = "Torsion ratio"
F_TORSION_HINT: Final = "lambda at that latitude; empty: from T1 and T2"
F_CONSTANT: Final = "Constant"
F_CONSTANT_HINT: Final = "arc-seconds and sigma, like -9.7 3.0; empty: from calibrations"
UNITS: Final = {
    "dms": "degrees, minutes, seconds",
    "gon": "gon",
    "deg": "decimal degrees",
}
TYPINGS: Final = {
    "separated": "179-01-56 or 179 01 56",
    "packed": "packed, 179.0156",
}
CARD_KNOWN: Final = "{title}: {known}"
CARD_SIGMA: Final = 'one turning point ±{value}"'
CARD_AZIMUTH: Final = 'one azimuth ±{value}"'
CARD_PERIOD: Final = "period {value} s at latitude {latitude}"
CARD_SCALE: Final = 'scale {value}" a division'
CARD_OWNER: Final = "Its owner must enter: {values}; without them {without}."
CARD_WITHOUT: Final = {
    "period": "moments and spin are not checked",
    "scale value": "there is no tape zero and no clamped swing",
    "torsion ratio": "there is no tape zero and no clamped swing",
}
CARD_NOTHING: Final = "no values known; what is missing is taken from the residuals"

# new session
NEW_SESSION_TITLE: Final = "New session"
F_ID: Final = "Id"
F_STATION: Final = "Station"
F_TARGET: Final = "Target"
F_METHOD: Final = "Method"
F_PURPOSE: Final = "Purpose"
F_KNOWN: Final = "Known azimuth"
F_KNOWN_HINT: Final = "grid azimuth, for a calibration; empty: from the coordinates"
F_WANTED: Final = "Wanted 95 %"
F_WANTED_HINT: Final = "arc-seconds of gyro north to stop at; empty: from the rule book"
METHODS: Final = {
    "tracking": "tracking: turning points on the circle",
    "amplitude": "amplitude: turning points on the scale, clamped",
    "transit": "transit: timed passages, clamped",
    "automatic": "automatic gyro: delivered azimuths",
}
NO_TARGET: Final = "none: gyro north only"
WANTED_NOT: Final = "the wanted interval is no positive number"
MISSING_FIELD: Final = "{field} is missing"
