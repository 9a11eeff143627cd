"""Sensor logs, cards, results and guided programmes."""

from __future__ import annotations

from typing import Final

KEY_SENSORS: Final = "Sensors"
LONG_SENSORS: Final = "Sensors: logs, calibrations, cards, guided programmes"
SENSORS_TITLE: Final = "{name}: sensors"
TAB_LOGS: Final = "1 Logs"
TAB_CARDS: Final = "2 Cards"
TAB_PROGRAMMES: Final = "3 Programmes"
LONG_OPEN_LOG: Final = "Open what is under the cursor"
KEY_ADD_LOG: Final = "Add log"
LONG_ADD_LOG: Final = "Add a log: choose a file, say which column is what"
COL_LOG: Final = "log"
COL_PROGRAMME: Final = "programme"
COL_CARD: Final = "card"
COL_VALID: Final = "holds"
COL_CALIBRATED: Final = "calibrated"
SENSOR_NO_LOGS: Final = "No log yet. A adds one; page 3 guides through a calibration."
SENSOR_NO_CARDS: Final = "No card yet. A log that was calibrated writes one with K."
SENSOR_CARD_HOLDS: Final = "to {day}"
SENSOR_CARD_OVER: Final = "no"
SENSOR_CARD_BROKEN: Final = "unreadable"
SENSOR_ANY: Final = "any"
SENSOR_DAYS: Final = "{first} to {last}"
SENSOR_TEMPERATURES: Final = "{low:g} to {high:g} °C"
SENSOR_FACTS_LOG: Final = {
    "file": "file",
    "columns": "columns",
    "units": "units",
    "scale": "scale",
    "rate": "rate",
    "instrument": "instrument",
    "latitude": "latitude",
    "calibrated_on": "recorded on",
    "sha256": "sha256",
    "effects": "adopted",
}
SENSOR_FACTS_CARD: Final = {
    "title": "title",
    "source": "source",
    "days": "valid",
    "temperatures": "temperatures",
    "notes": "note",
}

LOG_TITLE: Final = "Sensor log {log}"
TAB_RESULT: Final = "1 Result"
TAB_PICTURES: Final = "2 Pictures"
KEY_CALIBRATE: Final = "Calibrate"
KEY_ALLAN: Final = "Allan"
KEY_FILTER: Final = "Filter"
KEY_SPECTRUM: Final = "Spectrum"
KEY_MOTION: Final = "Motion"
KEY_NORTH: Final = "North"
KEY_STOPS: Final = "Plan"
KEY_SAVE_CARD: Final = "Card"
KEY_CANCEL: Final = "Cancel"
KEY_PICTURE: Final = "Picture"
LONG_CALIBRATE: Final = "Calibrate: parameters with sigma, before and after"
LONG_ALLAN: Final = "Allan deviation with the five coefficients"
LONG_FILTER: Final = "Filter: raw and filtered curves, and the lag of a step"
LONG_SPECTRUM: Final = "Spectrum with interference lines"
LONG_MOTION: Final = "State of motion, and the path"
LONG_NORTH: Final = "North or heading from this log"
LONG_STOPS: Final = "Plan of stops: what a bias leaves of the heading"
LONG_DIAGNOSE_LOG: Final = "Diagnose: which effect the calibration lacks"
LONG_SAVE_CARD: Final = "Save the card of this calibration"
LONG_ADOPT_SENSOR: Final = "Adopt what the diagnosis has named"
LONG_CANCEL: Final = "Cancel what is being computed"
LONG_PICTURE: Final = "Next picture"
LOG_OPTIONS: Final = "options"
LOG_OPTIONS_HINT: Final = "key=value ..., Tab comes here, Enter computes again"
LOG_BEGIN: Final = """\
C  calibrate        parameters with sigma, before and after, a card
D  diagnose         which effect the calibration lacks; A adopts it
L  Allan deviation  the five coefficients and their slopes
F  filter           raw and filtered curves, the lag of a step
S  spectrum         interference lines
M  motion           states, and the path with: path
N  north            with: method=indexing latitude=...
P  plan of stops    with: latitude=...

Options stand in the line below (Tab), key=value each, as on the
command line: latitude=47.1 programme=six-position map.time_s=t
unit.out=LSB scale.out=0.001 rate-hz=100
"""
TASK_NAMES: Final = {
    "calibrate": "calibration",
    "diagnose": "diagnosis",
    "allan": "Allan deviation",
    "filter": "filter",
    "spectrum": "spectrum",
    "motion": "motion",
    "north": "north",
    "plan": "plan of the stops",
}
TASK_RUNNING: Final = "{task}: reading {share:.0%}"
TASK_COMPUTING: Final = "{task}: computing"
TASK_CANCELLED: Final = "cancelled; nothing was written"
TASK_NAMED: Final = "{task}: done; A adopts what is named"
TASK_DONE: Final = "{task}: done"
TASK_NOT_MET: Final = "{task}: not determined or inconsistent"
TASK_REFUSED: Final = "refused"
NO_CARD_YET: Final = "Calibrate first (C): a card is written from a calibration."
CARD_SAVED: Final = "card written: {path}"
CARD_ASK: Final = "Write the card {path} of this calibration?"
CARD_REPLACE: Final = "A card stands at {path}. Write this one in its place?"
PICTURE_OF: Final = "picture {place} of {count}, V shows the next"
PICTURE_NONE: Final = "This result has no picture."

COL_RUN: Final = "run"
COL_DONE_STEPS: Final = "steps"
RUN_NEW: Final = "(new)"
RUN_STEPS: Final = "{done} of {count}"
RUN_RECORDED: Final = "from a log"
RUN_FACTS: Final = {"standard": "follows", "begun": "begun", "file": "file", "log": "log"}
PROGRAMME_MARKS: Final = {"open": " ", "here": ">", "done": "+", "short": "!"}
PROGRAMME_LINE: Final = "line"
PROGRAMME_NEXT: Final = "{part}: {title}"
PROGRAMME_WAIT: Final = "{left:.1f} min left; Enter goes on now and is told if it is too early"
PROGRAMME_DONE_WITH: Final = "Enter: done"
PROGRAMME_READ: Final = "type {asks}, Enter"
PROGRAMME_FROM_LOG: Final = "found in the log; F5 looks again"
PROGRAMME_NO_LOG: Final = "log=FILE names the log that is being recorded"
PROGRAMME_ALL: Final = "Every step is done. F8 calibrates."
PROGRAMME_ALL_NORTH: Final = "Every step is done. F8 finds north."
PROGRAMME_NEEDS: Final = "Before F8, in this line or none: {needs}"
PROGRAMME_RANK: Final = "rank {rank} of {of}"
PROGRAMME_KNOWN: Final = "determined"
PROGRAMME_UNKNOWN: Final = "still undetermined"
PROGRAMME_NOTHING: Final = "nothing yet"
PROGRAMME_EVERYTHING: Final = "nothing: all of it is determined"
PROGRAMME_TOLD: Final = "in the record"
PROGRAMME_COUNT: Final = "{done} of {count} steps"
PROGRAMME_WRITTEN: Final = "{step}: {value}"
PROGRAMME_UNDONE: Final = "the latest entry was struck; it stays in the file"
PROGRAMME_UNDO_WHY: Final = "undone on the screen"
PROGRAMME_MORE: Final = "... and {count} more"
KEY_UNDO_ENTRY: Final = "Undo"
LONG_UNDO_ENTRY: Final = "Undo: strike the latest entry; it stays in the file"
KEY_FINISH: Final = "Finish"
LONG_FINISH: Final = "Finish: calibrate, or find north, and write the card"
KEY_LOOK: Final = "Look"
LONG_LOOK: Final = "Look at the log again"
LONG_STEP_UP: Final = "The step above"
LONG_STEP_DOWN: Final = "The step below"

CHART_NONE: Final = "There is nothing to draw."
CHART_SMALL: Final = "A picture needs 30 columns and 8 lines."
CHART_UP: Final = "up"
CHART_DOWN: Final = "down"
CHART_DEGREES: Final = "degrees"
CHART_SHADES: Final = "blank: none   {signs}: few to many, at most {most} readings a cell"

ADD_LOG_TITLE: Final = "A sensor log into {name}"
ADD_LOG_CHOOSE: Final = (
    "Choose a file with Enter. The preview shows which column was taken for what, in which unit, "
    "and what is wrong. What was not understood is told in the line below:"
)
ADD_LOG_OPTIONS: Final = {
    "map.mag_x_uT=mx": "the column mx is the field along x",
    "unit.mx=mG": "in milligauss",
    "scale.mx=0.1": "the value of one count",
    "rate-hz=100": "where there is no time",
    "id=swing kind=compass": "name and kind of the log",
}
ADD_LOG_TAKE: Final = "F8 takes the log: it is copied into sensors/ and entered."
ADD_LOG_HINT: Final = "id= kind= map.CANON=COLUMN unit.COLUMN= scale.COLUMN= rate-hz="
ADD_LOG_HEAD: Final = "{rows} rows{rate}"
ADD_LOG_RATE: Final = " at {rate:.4g} Hz"
ADD_LOG_WRONG: Final = "To be mended"
ADD_LOG_TOLD: Final = "To be known"
ADD_LOG_COLUMNS: Final = ("column", "taken for", "unit", "from", "to", "first cells")
ADD_LOG_NOT_KNOWN: Final = "-"
ADD_LOG_ASSUMED: Final = "{unit} ?"
ADD_LOG_FACTOR: Final = "{unit} x{factor:.4g}"
ADD_LOG_TAKEN: Final = "taken: {path}"
ADD_LOG_GOOD: Final = "F8 takes it"
ADD_LOG_BAD: Final = "not to be taken yet"
