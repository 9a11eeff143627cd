"""The guided session: steps, entry, forecast, alarms; striking and practice."""

from __future__ import annotations

from typing import Final

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
OWNER_MISSING: Final = (
    "\nNot known of {instrument}: {values}.\n{without}\nKey c on the project's page enters it."
)
OWNER_WITHOUT: Final = {
    "tape-zero-before": "The tape zero cannot be taken off.",
    "tape-zero-after": "The tape zero cannot be taken off.",
    "observation": "The clamped swing gives no north.",
}
OWNER_NO_PERIOD: Final = "No moment is checked against it."
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
    "unstrike": "strike taken back",
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
REFUSED: Final = "not written: {what}"
REFUSED_EXPECTED: Final = "not written: {what}; expected {expected}"
RECORDED: Final = "on disk: row {seq}, {kind} {value}"
RECORDED_UNTIMED: Final = "; without a moment: typed too soon behind the point before"
STEP_COMPLETE: Final = "; complete: F8 goes on"
STRUCK: Final = "row {seq} struck: {reason}; it stays visible"
NOTHING_TO_STRIKE: Final = "there is no reading to strike"
MISSED_NOTED: Final = "on disk: row {seq}, turning point missed; the count goes on"
NOT_WRITTEN: Final = "NOT written: {what}. {hint}"
ASK_AGAIN: Final = "{question} Enter keeps it, typing replaces it."
PENDING: Final = (
    "not written: {text} ({kind}) is in the line. Enter writes it, Ctrl+Z clears it, then {key}"
)
PENDING_REFUSED: Final = (
    "not written: {text} ({kind}) is in the line. {reason}. Ctrl+Z clears it, then {key}"
)
PENDING_ASKED: Final = (
    "not written: {text} ({kind}) is in the line. {question} Enter keeps it, Ctrl+Z clears it, "
    "then {key}"
)
STRAYED: Final = (
    "not written: it was typed as {kind}, and {now} is asked for. Ctrl+Z clears the line"
)
CLEARED: Final = "line cleared, nothing written; Ctrl+Z again strikes the latest reading"
UNSTRUCK: Final = "row {seq} counts again: {reason}; strike and taking back stay visible"
NO_MOMENT: Final = "no moment"
BOOK_CHANGED: Final = "the book was changed by another hand: this is how it stands now"
BOOK_BROKEN: Final = "the book was changed by another hand and cannot be read. {what}"
DRAFT_KEPT: Final = "what you typed is kept; Escape again leaves, Enter writes it"
CLOSED_BEFORE: Final = "the swing has begun: what is read now counts as after it (F8 goes on)"
CLOSED_REFUSED: Final = (
    "not written: the swing has begun and this step stands before it. Ctrl+Z clears the line"
)
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
    "sight_face": "The other face reads so: F3 if it was.",
    "collimation_jump": "2c jumps by {difference}.",
    "zeniths_contradict": "Faces differ from 360° by {difference}.",
    "clamp_moved": "{difference} from the clamp reading before.",
    "outside_rounds": "{difference} from the rounds so far, ±{limit}.",
    "other_division": "A passage at {difference}? F2 if it is a scale point.",
    "off_scale": "{difference} beyond the scale's end at {limit}.",
    "outside_range": "{difference} is outside of {low} to {limit}.",
    "supply_jump": "{difference} from the supply before.",
    "zenith_face": "{difference} belongs to the other face (F3).",
    "before_last_row": "The moment lies {difference} before the last row.",
    "half_swing": "{difference} after the point before; the card's swing makes {limit}.",
}
ALERTS: Final = {
    "gross_error": "Point {number} stands out ({share:.0%} sure): strike it and repeat",
    "midpoint_step": "Midpoint jumps at point {number} ({share:.0%} sure): check the tripod",
    "midpoint_drift": "North drifts ({share:.0%} sure): tape, twist, sun on the tripod?",
    "warm_up": "North settles as in warm-up ({share:.0%} sure): go on till it stands",
    "damping_break": "Decay changes at point {number} ({share:.0%} sure): check follow-up",
    "unclear": "The run breaks, the cause is open (p {p:.4f}): observe further points",
    "passage_missed": "Transit {number} is off the count: strike it, F5 per point",
    "passage_mistimed": "Transit {number} is mistimed: strike it, take the next",
}
CLAMPED_ALERTS: Final = {
    "midpoint_step": "Midpoint jumps at point {number} ({share:.0%} sure): clamp, tripod",
    "damping_break": "Decay changes at point {number} ({share:.0%} sure): draught?",
}
ROUND_ALERT: Final = "Round {number} stands out: strike it and repeat (p {p:.4f})"
LEDGER_COLUMNS: Final = ("row", "time", "kind", "reading", "", 'v "')
LEDGER_COLUMNS_DIV: Final = ("row", "time", "kind", "reading", "", "v div")
LEDGER_STRUCK: Final = "struck"
NEXT_POINT: Final = "next {side} in {time}"
NEXT_NOW: Final = "next {side} NOW ({time})"
NEXT_LONG_PAST: Final = "next {side} overdue (F5: missed)"
NEXT_ANY: Final = "point"
NEXT_SIDE: Final = "next {side}"
NEXT_READING: Final = "at {reading}"
NEXT_INTERVAL: Final = ' ±{interval}"'
NORTH_NOW: Final = 'gyro north {north} ±{interval}" (95 %)'
NORTH_OPEN: Final = "gyro north {north}, interval not known"
NORTH_NONE: Final = "gyro north from two turning points on"
NORTH_NONE_SCALE: Final = "gyro north from three scale points on"
NORTH_NONE_TRANSIT: Final = "gyro north from three transits and two points on"
NORTH_NONE_ROUND: Final = "azimuth and interval from the first round on"
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
NEXT_ACTION: Final = 'next: {action}: ±{interval}", cause {share}'
ELSE_ACTION: Final = 'else: {action}: ±{interval}", cause {share}'
ACTIONS: Final = {
    "two_points": "two more points",
    "reversed_start": "2nd run now, other side",
    "second_run": "2nd run in 4 h, set up anew",
    "other_observer": "2nd run by another observer",
}
NEXT_CAMPAIGN: Final = 'next: {action}: line in 30 d ±{interval}", cause {share}'
ELSE_CAMPAIGN: Final = 'else: {action}: line in 30 d ±{interval}", cause {share}'
CAMPAIGN_ACTIONS: Final = {
    "repeat": "again now",
    "tomorrow": "again tomorrow",
    "warmer": "again 8 K warmer",
    "colder": "again 8 K colder",
    "other_line": "other known line",
    "month": "again in 30 d",
}
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
STRIKE_BACK: Final = "struck: Enter lets it count again"
STRIKE_REASON: Final = "reason"
STRIKE_WHY: Final = "The reason is missing: the book keeps it with the row."
STRIKE_KEYS: Final = "Up and Down choose the row, Enter strikes it, Escape leaves it"
UNDO_REASON: Final = "undo"

KEY_HELP: Final = "Help"
KEY_KIND: Final = "Kind"
KEY_FACE: Final = "Face"
KEY_TARGET: Final = "Target"
KEY_MISSED: Final = "Missed"
KEY_INSTRUMENT: Final = "Read"
KEY_FOLLOW: Final = "Follow"
INSTRUMENT_NONE: Final = (
    "No instrument is known: surveyapp instrument PROTOCOL:PORT --remember names one."
)
INSTRUMENT_ASKED: Final = "The instrument is asked ..."
INSTRUMENT_FOLLOWING: Final = "Follow the mark through the turn: {seconds:.0f} s ..."
INSTRUMENT_NO_ANGLE: Final = "No angle is asked for here: nothing was taken over."
INSTRUMENT_NO_ZENITH: Final = "The instrument gave no zenith angle: nothing was taken over."
INSTRUMENT_FACE: Final = (
    "The instrument stands in face {read}, face {asked} is asked for: F3 changes it, or turn the "
    "telescope. Nothing was taken over."
)
INSTRUMENT_READ: Final = "{source}: circle {hz}, zenith {v}, distance {length}. Enter confirms."
INSTRUMENT_TURN: Final = 'Turn from {readings} readings, ±{sigma:.1f}". Enter confirms.'
INSTRUMENT_BUSY: Final = "Something stands in the line: Enter it or clear it, then read."
KEY_STRIKE: Final = "Strike"
KEY_UNDO: Final = "Undo"
KEY_NEXT: Final = "Next"
KEY_PREVIOUS: Final = "Back"
KEY_LEAVE: Final = "Leave"
KEY_REMARK: Final = "Remark"
KEY_TYPING_UP: Final = "Typing up"
REMARK_TITLE: Final = "A remark for the book"
REMARK_MEANING: Final = (
    "It stands in the field book and in the record, with its time.\n"
    "Say what it is, as in: observer M. Weber   booker A. Li   weather draught, 14 C"
)
REMARK_KEYS: Final = "Enter writes it   Escape does not"
REMARK_OF_STEP: Final = "remark: {text}"
PASSAGE_TYPED_UP: Final = "not written: a passage that is typed up needs its moment: 0@08:15:30"
REMARK_NOTED: Final = "on disk: row {seq}, note {text}"
TYPING_UP_ON: Final = "typing up a book: readings have no moment but one behind @ (Ctrl+O ends it)"
TYPING_UP_OFF: Final = "readings have the moment of typing again"
KEY_CLOSE: Final = "Close"

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
