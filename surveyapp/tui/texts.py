"""Every text that the screens show, in one catalogue: a translation is a copy of this file.

Texts with braces are filled by ``str.format``. No text is made anywhere else in ``surveyapp.tui``.
"""

from __future__ import annotations

from typing import Final

APP_TITLE: Final = "surveyapp"
NOT_DETERMINED: Final = "-"

# project screen
PROJECT_TITLE: Final = "{name}"
COMPUTING: Final = "computing ..."
ALL_MET: Final = "all confirmed checks met"
SOME_NOT_MET: Final = "{count} of {total} confirmed checks NOT MET"
NO_CHECKS: Final = "no confirmed check could be applied"
CANNOT_USE: Final = "this project cannot be used as it stands"
TAB_SESSIONS: Final = "1 Sessions"
TAB_LINES: Final = "2 Lines"
TAB_CONSTANTS: Final = "3 Constants"
TAB_CHECKS: Final = "4 Checks"
TAB_WARNINGS: Final = "5 Warnings"
NO_SESSIONS: Final = "This project has no orientation session yet."
NO_LINES: Final = "No line is oriented yet: a line needs sights of a target and gyro north."
NO_CONSTANTS: Final = "No calibration session: there is no instrument constant from this project."
NO_CHECK_ROWS: Final = "There is nothing to check yet."
NO_WARNINGS: Final = "No warnings."

# columns
COL_SESSION: Final = "session"
COL_METHOD: Final = "method"
COL_POINTS: Final = "n"
COL_NORTH: Final = "gyro north"
COL_SIGMA: Final = '±"'
COL_AZIMUTH: Final = "gyro azimuth"
COL_LINE: Final = "line"
COL_GRID: Final = "grid azimuth"
COL_INTERVAL: Final = '95 % ±"'
COL_CONSTANT: Final = 'constant "'
COL_COUNT: Final = "n"
COL_INSTRUMENT: Final = "instrument"
COL_LENGTH: Final = "length m"
COL_VERDICT: Final = "verdict"
COL_CHECK: Final = "check"
COL_WHERE: Final = "where"
COL_VALUE: Final = "value"
COL_LIMIT: Final = "limit"

# details
D_STATION: Final = "station"
D_TARGET: Final = "line to"
D_INSTRUMENT: Final = "instrument"
D_PURPOSE: Final = "purpose"
D_ESTIMATOR: Final = "estimator"
D_POINTS: Final = "points, degrees of freedom"
D_SIGMA_SOURCE: Final = "sigma from"
D_INTERVAL: Final = "95 % interval"
D_RMS: Final = "rms of the residuals"
D_AMPLITUDE: Final = "amplitude, first point"
D_DAMPING: Final = "damping per half swing"
D_PERIOD: Final = "period"
D_ZERO: Final = "tape zero before, after"
D_ZERO_CORRECTION: Final = "its correction (inside)"
D_COLLIMATION: Final = "collimation"
D_DRIFT: Final = "sights after minus before"
D_READING: Final = "line reading {target}"
D_AZIMUTH: Final = "gyro azimuth {target}"
D_GYRO: Final = "gyro azimuth"
D_PLUS_CONSTANT: Final = "+ constant ({choice})"
D_TRUE: Final = "= true azimuth ({reference})"
D_DEFLECTION: Final = "- deflection of the vertical"
D_CONVERGENCE: Final = "- meridian convergence"
D_ARC_TO_CHORD: Final = "- arc-to-chord"
D_GRID: Final = "= grid azimuth"
D_SOUTH: Final = "direction from south"
D_EXISTING: Final = "azimuth from coordinates"
D_BUDGET: Final = "budget"
D_SHARE: Final = "share"
POOLED: Final = "{choice}"
STABLE: Final = "stable"
NOT_STABLE: Final = "NOT STABLE"
PURPOSES: Final = {"calibration": "calibration", "survey": "survey"}

# verdicts: words, never colour alone
MET: Final = "met"
NOT_MET: Final = "NOT MET"
WARNS: Final = "warning"
OPEN: Final = "open"

# problems
FOUND: Final = "found: {text}"
EXPECTED: Final = "expected: {text}"

# home
HOME_TITLE: Final = "surveyapp: gyro orientation"
HOME_RECENT: Final = "Recent projects"
HOME_SAMPLES: Final = "Samples (measured data, opened as a copy)"
HOME_EMPTY: Final = "surveyapp open DIR opens a project; surveyapp new DIR makes one."

# keys
KEY_QUIT: Final = "Quit"
KEY_BACK: Final = "Back"
KEY_TABS: Final = "Page"
KEY_RELOAD: Final = "Read again"
KEY_OPEN: Final = "Open"
