"""Words that several screens share: verdicts, columns, keys."""

from __future__ import annotations

from typing import Final

APP_TITLE: Final = "surveyapp"
NOT_DETERMINED: Final = "-"

# verdicts: words, never colour alone
MET: Final = "met"
NOT_MET: Final = "NOT MET"
OPEN: Final = "open"

# problems
LINE_MISSING: Final = "The line is empty."
FOUND: Final = "found: {text}"
EXPECTED: Final = "expected: {text}"

# columns
COL_NORTH: Final = "gyro north"
COL_AZIMUTH: Final = "gyro azimuth"
COL_GRID: Final = "grid azimuth"
COL_VERDICT: Final = "verdict"
COL_WARNING: Final = "warning"

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
LONG_INSTRUMENT: Final = "Read the total station on the cable"
LONG_FOLLOW: Final = "Follow a turning point by the total station"
LONG_REMARK: Final = "A remark: observer, booker, weather"
LONG_TYPING_UP: Final = "Type up a book: readings without moments"
LONG_STRIKE: Final = "Strike a reading, with a reason"
LONG_UNDO: Final = "Undo: strike the latest reading"
LONG_PREVIOUS: Final = "Back to the step before"
LONG_NEXT: Final = "Next step"
LONG_LEAVE: Final = "Leave; everything is on the disk"
LONG_PASSAGE: Final = "A passage now (Space in the empty line)"
LONG_PDF: Final = "PDF: write the record"
LONG_TRAVERSES: Final = "Traverses: adjusted, with plan and ellipses"
LONG_ADOPT: Final = "Adopt what was named"
