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
BEING_OBSERVED: Final = "This session is still being observed: Enter goes on with it."
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
COL_WARNING: Final = "warning"

# details
D_STATION: Final = "station"
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
D_PLUS_CONSTANT: Final = "+ instrument constant"
D_TRUE: Final = "= true azimuth ({reference})"
D_DEFLECTION: Final = "- deflection of the vertical"
D_CONVERGENCE: Final = "- meridian convergence"
D_ARC_TO_CHORD: Final = "- arc-to-chord"
D_GRID: Final = "= grid azimuth"
D_SOUTH: Final = "direction from south"
D_EXISTING: Final = "azimuth from coordinates"
D_BUDGET: Final = "budget"
D_SHARE: Final = "share"
CONSTANT_VALUE: Final = '- - {choice} {value}" ±{sigma}", ±{interval}" (95 %)'
CONSTANT_TEST: Final = "{verdict}: {text}"
CONSTANT_NUMBERS: Final = "{text}: {value}, limit {limit}"
CONSTANT_UNTESTED: Final = "nothing tests it: that takes two lines, or two epochs"
CONSTANT_DAYS: Final = "days (UTC)"
CONSTANT_ORDER: Final = "in order"
CONSTANT_AXIS: Final = 'constant ", bars ±1 sigma; {axis}'
STABLE: Final = "stable"
NOT_STABLE: Final = "NOT STABLE"
PURPOSES: Final = {"survey": "survey", "calibration": "calibration"}

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
HOME_NO_RECENT: Final = "  none yet"
HOME_SAMPLES: Final = "Samples (measured data, opened as your own copy)"
HOME_MORE: Final = "Begin"
HOME_NEW: Final = "New project ..."
HOME_OPEN: Final = "Open a folder ..."
HOME_PRACTISE: Final = "Practise on a simulated instrument ..."
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

# keys; what is too short for the palette has a longer name below
KEY_QUIT: Final = "Quit"
KEY_SOUND: Final = "Sound of the countdown: on, off"
SOUND_ON: Final = "the countdown is heard"
SOUND_OFF: Final = "the countdown is silent"
KEY_THEME: Final = "Next theme: dark, light, high contrast"
KEY_BACK: Final = "Back"
KEY_TABS: Final = "Page"
KEY_RELOAD: Final = "Reload"
KEY_OPEN: Final = "Open"
LONG_PAGE: Final = "Page {tab}"
LONG_OBSERVE: Final = "Observe this session"
LONG_NEW: Final = "New session"
LONG_DIAGNOSE: Final = "Diagnose: what the model lacks"
LONG_RELOAD: Final = "Read the folder again"
LONG_BACK: Final = "Back to where one came from"
LONG_HELP: Final = "Help: explain this step"
LONG_KIND: Final = "Another kind of reading"
LONG_FACE: Final = "The other face"
LONG_TARGET: Final = "Another target"
LONG_MISSED: Final = "Missed: this turning point was not read"
LONG_STRIKE: Final = "Strike a reading, with a reason"
LONG_UNDO: Final = "Undo: strike the latest reading"
LONG_PREVIOUS: Final = "Back to the step before"
LONG_NEXT: Final = "Next step"
LONG_LEAVE: Final = "Leave; everything is on the disk"
LONG_PASSAGE: Final = "A passage now (Space in the empty line)"
LONG_PDF: Final = "PDF: write the record"
LONG_TRAVERSES: Final = "Traverses: adjusted, with plan and ellipses"
LONG_ADOPT: Final = "Adopt what was named"

# session screen
SESSION_TITLE: Final = "{project}  {session}  {method}  {line}"
WRITING: Final = "each reading goes to disk"
READING_ONLY: Final = "READING ONLY: open elsewhere, or read-only"
STEP_NAMES: Final = {
    "set-up": "set-up, level",
    "sights-before": "sights before",
    "tape-zero-before": "tape zero",
    "run-up": "run-up",
    "observation": "observation",
    "tape-zero-after": "tape zero after",
    "sights-after": "sights after",
    "result": "result",
}
SWING_NAMES: Final = {
    "tracking": "turning points",
    "amplitude": "scale points",
    "transit": "transits",
    "automatic": "azimuths",
}
STEP_HINTS: Final = {
    "set-up": "Set up and level. Nothing needs to be typed here;\nF8 goes on, F1 explains.",
    "sights-before": "Sight each target in face left, then face right.\nF8 goes on, F1 explains.",
    "tape-zero-before": "Rotor at rest: read three or more turning points\nof the mark.",
    "run-up": "Start the rotor and wait until it runs steadily.\nF8 when the gyro is lowered.",
    "observation": "Nothing is read yet. F1 explains what to read here.",
    "tape-zero-after": "Rotor at rest again: read three or more turning points\nof the mark.",
    "sights-after": "Sight each target once more in both faces.",
    "result": "Nothing is read in this session.",
}
STEP_MARKS: Final = {"open": "·", "begun": "~", "done": "√"}
STEP_HERE: Final = ">"
KIND_NAMES: Final = {
    "backsight": "sight",
    "zenith": "zenith angle",
    "reversal": "turning point",
    "missed": "missed",
    "clamp": "clamp, circle",
    "scale_reversal": "scale point, div",
    "transit": "transit",
    "tape_zero": "tape zero, div",
    "azimuth": "gyro azimuth",
    "north": "gyro north",
    "level_along": 'level along, "',
    "level_across": 'level across, "',
    "supply": "supply, V Hz mA",
    "temperature": "temperature, °C",
    "note": "note",
    "strike": "strike",
}
PROMPT: Final = "{kind} {number}{detail}{unit}"
PROMPT_UNIT: Final = " ({unit})"
PROMPT_FACE: Final = " {target} face {face}"
PROMPT_SIDE: Final = " {side}"
ENTRY_HINT: Final = "type the reading, Enter writes it"
TRANSIT_HINT: Final = "Space at the moment of passage"
RESULT_HINT: Final = "F8 shows the result, Escape leaves"
UNDERSTOOD: Final = "= {value}"
UNDERSTOOD_COMPLETED: Final = "= {value}  (completed)"
REFUSED: Final = "not possible: {what}"
REFUSED_EXPECTED: Final = "not possible: {what}; expected {expected}"
RECORDED: Final = "on disk: row {seq}, {kind} {value}"
STEP_COMPLETE: Final = "; complete: F8 goes on"
STRUCK: Final = "row {seq} struck: {reason}; it stays visible"
NOTHING_TO_STRIKE: Final = "there is no reading to strike"
MISSED_NOTED: Final = "on disk: row {seq}, turning point missed; the count goes on"
NOT_WRITTEN: Final = "NOT written: {what}. {hint}"
ASK_AGAIN: Final = "{question} Enter keeps it, typing replaces it."
BOOK_CHANGED: Final = "the book was changed by another hand: this is how it stands now"
BOOK_BROKEN: Final = "the book was changed by another hand and cannot be read. {what}"
DRAFT_KEPT: Final = "what you typed is kept; Escape again leaves, Enter writes it"
CLOSED_BEFORE: Final = "the swing has begun: what is read now counts as after it (F8 goes on)"
CLOCK_SET: Final = (
    "; the computer's clock is off by {seconds:+.0f} s now, the session's time goes on unbroken"
)
TORN: Final = "a torn line stands in {file}: is that reading missing here?"
CLOCK_BACK: Final = (
    "the computer's clock is {seconds:.0f} s before the last row; time goes on from that row"
)
QUESTIONS: Final = {
    "outside_forecast": "{difference} from the forecast, ±{limit}.",
    "wrong_side": "It lies on the other side.",
    "faces_contradict": "Faces differ by 180° and {difference}.",
    "sight_moved": "{difference} from the last sight.",
    "collimation_jump": "2c jumps by {difference}.",
    "zeniths_contradict": "Faces differ from 360° by {difference}.",
    "clamp_moved": "{difference} from the clamp reading before.",
    "outside_rounds": "{difference} from the rounds so far, ±{limit}.",
    "off_scale": "{difference} beyond the scale's end at {limit}.",
}
ALERTS: Final = {
    "gross_error": "Point {number} stands out: strike it and repeat (p {p:.4f})",
    "midpoint_step": "Midpoint jumps at point {number}: check the tripod (p {p:.4f})",
    "damping_break": "Decay changes at point {number}: check follow-up (p {p:.4f})",
    "unclear": "Run breaks at point {number}: go on to point 12 (p {p:.4f})",
    "passage_missed": "Transit {number} is off the count: strike it, F5 per point",
    "passage_mistimed": "Transit {number} is mistimed: strike it, take the next",
}
CLAMPED_ALERTS: Final = {
    "midpoint_step": "Midpoint jumps at point {number}: clamp, tripod (p {p:.4f})",
    "damping_break": "Decay changes at point {number}: draught? (p {p:.4f})",
}
ROUND_ALERT: Final = "Round {number} stands out: strike it and repeat (p {p:.4f})"
LEDGER_COLUMNS: Final = ("row", "time", "kind", "reading", "", 'v "')
LEDGER_COLUMNS_DIV: Final = ("row", "time", "kind", "reading", "", "v div")
LEDGER_STRUCK: Final = "struck"
NEXT_POINT: Final = "next {side} in {time}"
NEXT_NOW: Final = "next {side} NOW ({time})"
NEXT_LONG_PAST: Final = "next {side} overdue (F5: missed)"
NEXT_SIDE: Final = "next {side}"
NEXT_READING: Final = "at {reading}"
NEXT_INTERVAL: Final = ' ±{interval}"'
NORTH_NOW: Final = 'gyro north {north} ±{interval}" (95 %)'
NORTH_OPEN: Final = "gyro north {north}, interval not known"
NORTH_NONE: Final = "gyro north from two turning points on"
NORTH_NONE_SCALE: Final = "gyro north from three scale points on"
NORTH_NONE_TRANSIT: Final = "gyro north from three transits and two points on"
NORTH_NONE_ROUND: Final = "gyro north from the first round on"
NORTH_MISSING: Final = "no gyro north: {problem}"
AZIMUTH_NOW: Final = 'gyro azimuth {north} ±{interval}" (95 %)'
AZIMUTH_OPEN: Final = "gyro azimuth {north}, interval not known"
NEXT_PASSAGE: Final = "transit {way} in {time}"
NEXT_PASSAGE_NOW: Final = "transit {way} NOW ({time})"
PASSAGE_OVERDUE: Final = "transit {way} overdue: F5 for each point gone by"
NEXT_SPREAD: Final = " ±{seconds} s"
NEXT_READING_DIV: Final = "at {reading} div"
NEXT_POINT_DIV: Final = "{side} at {reading} div"
NEXT_INTERVAL_DIV: Final = " ±{interval}"
TIME_DIFFERENCES: Final = "dt E-W, s  {values}"
SCHULER_DIV: Final = "Schuler, div"
AFTER_TWO: Final = '±{interval}" after two more'
WANTED: Final = 'wanted ±{interval}"'
ENOUGH: Final = "ENOUGH"
RULE_TARGET: Final = 'rule book ±{interval}"'
TARGET_SOURCE: Final = 'm {sigma}" x 1.96: {book}, {clause}'
TARGET_UNCONFIRMED: Final = ", unconfirmed"
NO_TARGET_SET: Final = "no target set"
TARGET_NOT_IN_BOOK: Final = "no target in {book}"
TARGET_PROBLEM: Final = "no target: {problem}"
SCHULER: Final = "Schuler, without tape zero"
CHANNEL_MIDPOINT: Final = 'v" midpoint '
CHANNEL_AMPLITUDE: Final = 'v" amplitude'
CHANNEL_MIDPOINT_DIV: Final = "v div midpoint "
CHANNEL_AMPLITUDE_DIV: Final = "v div amplitude"
PLOT_EMPTY: Final = "The swing is drawn from the third turning point on."
DIVISIONS: Final = "{value} div"
WAYS: Final = {"R": ">", "L": "<", "": ""}

# strike
STRIKE_TITLE: Final = "Strike a reading: it stays in the book and no longer counts"
STRIKE_REASON: Final = "reason"
STRIKE_KEYS: Final = "Up and Down choose the row, Enter strikes it, Escape leaves it"
UNDO_REASON: Final = "undo"

KEY_HELP: Final = "Help"
KEY_KIND: Final = "Kind"
KEY_FACE: Final = "Face"
KEY_TARGET: Final = "Target"
KEY_MISSED: Final = "Missed"
KEY_STRIKE: Final = "Strike"
KEY_UNDO: Final = "Undo"
KEY_NEXT: Final = "Next"
KEY_PREVIOUS: Final = "Back"
KEY_LEAVE: Final = "Leave"
KEY_CLOSE: Final = "Close"

# result screen
RESULT_TITLE: Final = "{project}  {session}  result"
R_CHAIN: Final = "From the readings to the azimuth"
R_CHECKS: Final = "Checks"
R_BUDGET: Final = "What the sigma is made of"
R_HELPS: Final = 'Most helps: {advice}. Without this part ±{without}" instead of ±{sigma}".'
R_AT_CALIBRATION: Final = "at the calibration, {advice}"
IMPROVE: Final = {
    "centring": "centre more exactly, or take a longer line",
    "clamp reading": "read the clamped circle several times",
    "constant instability": "calibrate near the survey, before and after it",
    "damping": "read more turning points",
    "deflection": "have the deflection of the vertical determined there",
    "eccentricity": "measure the eccentric elements again, or set up on the mark",
    "known azimuth": "calibrate on a line whose azimuth is known better",
    "known constant": "calibrate on a known line, before and after",
    "rounds": "take more rounds",
    "run-to-run scatter": "repeat the session: runs differ by more than their readings tell",
    "sights": "sight the target more often in both faces",
    "tape zero": "read more turning points of the tape zero, before and after",
    "torsion ratio": "have the torsion ratio determined from T1 and T2",
    "turning points": "read more turning points",
    "unknown damping": "read at least four turning points",
}
R_CONSTANTS: Final = "Instrument constant through time"
R_WARNINGS: Final = "To know"
R_POINTS: Final = "Readings and their residuals"
R_DIVISIONS: Final = "{value} div"
R_LIMIT: Final = "limit {limit}"
R_NO_LINE: Final = "no gyro north from this session"
R_TRUE: Final = "true azimuth, {reference}"
S_POINTINGS: Final = "{count} pointings"
S_POINTS: Final = "{count} points"
S_ROUNDS: Final = "{count} round(s)"
S_DEFLECTION: Final = "of the station"
S_NO_DEFLECTION: Final = "unknown, 0 taken"
S_GRID: Final = "the grid, at {station}"
S_ENDS: Final = "both ends in the grid"
S_NO_ENDS: Final = "a position is missing"
S_CLOCKWISE: Final = "from grid north"
S_AXES: Final = "the grid's axes ask it"
S_COMPARE: Final = "for comparison only"
KEY_PDF: Final = "PDF"
KEY_OBSERVE: Final = "Observe"
KEY_NEW: Final = "New"
PDF_WRITTEN: Final = "written: {path}"
KEY_NEW_PROJECT: Final = "New project"
KEY_FOLDER: Final = "Folder"
KEY_PRACTISE: Final = "Practise"
KEY_MAKE: Final = "Make it"
KEY_FIELD: Final = "Next field"

# diagnosis screen
DIAGNOSIS_TITLE: Final = "{name}  what the model lacks"
DIAGNOSING: Final = "diagnosing ..."
NO_SUBJECTS: Final = "Nothing here can be diagnosed: it takes a reversal run or three sessions."
COL_SUBJECT: Final = "subject"
COL_ID: Final = "id"
COL_CANDIDATE: Final = "candidate"
COL_FAMILY: Final = "p family"
COL_BIC: Final = "BIC behind"
SUBJECT_RUN: Final = "run"
SUBJECT_CAMPAIGN: Final = "campaign"
SUBJECT_TRAVERSE: Final = "traverse"
CHANNEL_NAMES: Final = {
    "amplitude": "Amplitude channel (side times residual)",
    "midpoint": "Midpoint channel (Schuler mean of the residuals)",
    "residual": "Residuals",
}
D_BEFORE: Final = "before"
D_AFTER: Final = "after"
D_BEST: Final = "after, best member"
D_AVERAGED: Final = "averaged"
D_LEFT_OUT: Final = "left out"
D_VALUE: Final = "value"
KEY_DIAGNOSE: Final = "Diagnose"
KEY_ADOPT: Final = "Adopt"
KEY_YES: Final = "Yes"
NOTHING_TO_ADOPT: Final = "No effect is named here: there is nothing to adopt."
D_SENTENCE: Final = "· {sentence}\n"
ADOPT_ASK: Final = (
    "Adopt this?\n{names}\n\nIt is written into project.toml; the next result uses it."
)
CONFIRM_KEYS: Final = "Enter: yes   Escape: no"
ADOPTED: Final = "written: {place}"

# practice
PRACTICE_INSTRUMENT: Final = "instrument, {speed:g} x"
PRACTICE_CIRCLE: Final = "circle {reading}"
PRACTICE_SCALE: Final = "scale {div} div"
PRACTICE_AZIMUTH: Final = "shows {reading}"
PRACTICE_MEASURING: Final = "measuring ..."
PRACTICE_NOTHING: Final = "nothing to read"
PRACTICE_TRUTH: Final = 'Truth {truth}; yours is {error}" off: ±{interval}" {verdict}.'
PRACTICE_HOLDS: Final = "holds it"
PRACTICE_MISSES: Final = "does NOT hold it"
PRACTICE_CLEAN: Final = "Nothing was hidden in this run."
PRACTICE_HIDDEN: Final = "Hidden in this run: {effect}."
PRACTISE_TITLE: Final = "Practise on a simulated instrument"
PRACTISE_STATE: Final = "F8 begins"
F_SPEED: Final = "Time"
F_HIDDEN: Final = "Hidden"
KEY_BEGIN: Final = "Begin"
SPEEDS: Final = {
    "10": "10 x: a half swing takes 20 s",
    "1": "real time, as underground",
    "5": "5 x",
    "30": "30 x",
    "100": "100 x",
}
HIDDEN: Final = {
    "nothing": "nothing: a clean run",
    "something": "one disturbance, to be found",
    "lot": "perhaps: the lot decides",
}

# closing
SIGN_TITLE: Final = "Close and sign this session"
SIGN_MEANING: Final = (
    "Its book and its table are sealed in the ledger. Nothing is locked away:\n"
    "`surveyapp reopen` opens it again and keeps the reason."
)
SIGN_NAME: Final = "your name"
SIGN_KEYS: Final = "Enter signs   Escape does not"
SIGNED: Final = "closed and signed by {name}; files sealed: {files}"
CLOSED_SESSION: Final = "READING ONLY: closed and signed"
KEY_SIGN: Final = "Close and sign"

# traverses
TRAVERSE_TITLE: Final = "Traverses of {name}"
KEY_TRAVERSE: Final = "Traverses"
KEY_NEXT_TRAVERSE: Final = "Next traverse"
NO_TRAVERSE: Final = "This project has no [[traverse]]."
TAB_PLAN: Final = "1 Plan"
TAB_POINTS: Final = "2 Points"
TAB_OBSERVATIONS: Final = "3 Observations"
TAB_CLOSURES: Final = "4 Closures"
TAB_ALL_CHECKS: Final = "5 Checks"
NO_CLOSURES: Final = "No route closes: there is nothing to compare before the adjustment."
PLAN_EMPTY: Final = "There is no plan yet."
PLAN_LEGEND: Final = "{fixed} fixed  {free} adjusted, ellipses {factor} x  north is up"
PLAN_GYRO: Final = "  G gyro side"
FIXED_POINT: Final = "fixed"
SUSPECT: Final = "SUSPECT"
COL_POINT: Final = "Point"
COL_EASTING: Final = "E"
COL_NORTHING: Final = "N"
COL_HEIGHT: Final = "H"
COL_ELLIPSE: Final = "Ellipse mm"
COL_KIND: Final = "Kind"
COL_SIGHT: Final = "Sight"
COL_RESIDUAL: Final = "Residual"
COL_TEST: Final = "v / sigma"
COL_REDUNDANCY: Final = "Redundancy"
COL_ROUTE: Final = "Route"
COL_ANGLES: Final = "Angles"
COL_PLACE: Final = "Place"
COL_RELATIVE: Final = "Relative"
T_LONG_AXIS: Final = "long axis"
T_OBSERVED: Final = "Observed"
T_ADJUSTED: Final = "Adjusted"
T_BIAS: Final = "Smallest bias found"
T_BIAS_MOVES: Final = "An unseen one moves"
T_UNCONTROLLED: Final = "nothing controls it"
T_STATE: Final = "sigma0 {ratio}, dof {dof}: {word}"
