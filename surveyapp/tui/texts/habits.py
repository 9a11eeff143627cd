"""Habits of the hand: clamp and brake, values of a step, own editor, corrections."""

from __future__ import annotations

from typing import Final

CARE: Final = {
    "set-up": "Gyro CLAMPED while the instrument is moved or turned.",
    "sights-before": "Gyro clamped. Turn the alidade gently.",
    "tape-zero-before": "Rotor at rest: UNCLAMP gently. CLAMP again at the end.",
    "run-up": "CLAMP, start the rotor, wait. Then UNCLAMP gently.",
    "observation": "",
    "tape-zero-after": "CLAMP, BRAKE, wait until the rotor stands. UNCLAMP.",
    "sights-after": "CLAMP the gyro before the alidade is turned.",
    "result": "CLAMP and let the rotor stop before it is carried.",
}
CARE_AUTOMATIC: Final = {
    "set-up": "Lock the sensor while the instrument is moved.",
    "sights-before": "",
    "observation": "Nobody touches the instrument while it measures.",
    "sights-after": "",
    "result": "Lock the sensor before it is carried.",
}
CARE_END: Final = "Enough? CLAMP, then BRAKE the rotor; F8 goes on."
VALUE_SIGHT: Final = '{target}  mean {mean}  2c {two_c}"'
VALUE_SIGHT_ONE: Final = "{target}  {mean}  in one face: 2c stays in"
VALUE_SIGHT_CHANGE: Final = '{target}  after minus before {change}"'
VALUE_ZENITH: Final = '{target}  zenith {mean}  index {index}"'
VALUE_ZERO: Final = "tape zero {mean} div from {points} points"
VALUE_ZERO_CHANGE: Final = "tape zero after minus before {change} div"

# the surveyor's own editor
KEY_EDIT: Final = "Edit"
LONG_EDIT: Final = "Edit the book of this session, or the project file, in $EDITOR"
LONG_EDIT_PROJECT: Final = "Edit project.toml in $EDITOR"
EDIT_UNCHANGED: Final = "{file} was not changed."
EDIT_APPENDED: Final = "{file}: lines were added; it has been read again."
EDIT_CHANGED: Final = "{file} was changed and has been read again; as it was: {copy}"
EDIT_ELSEWHERE: Final = "The project is open elsewhere, or read-only: nothing was edited."
EDIT_NO_TERMINAL: Final = "This terminal cannot step back for an editor: nothing was edited."
EDIT_FAILED: Final = "{editor} could not be started: {reason}. Set EDITOR to a text editor."
EDIT_CODE: Final = "({editor} ended with {code}.)"

# the record on the disk
RECORD_OLD: Final = "The PDF in results/ is OUT OF DATE: F4 makes it again."

# corrections in a form
KEY_CORRECT: Final = "Correct"
LONG_CORRECT: Final = "Correct a station, an instrument or a session"
CORRECT_TITLE: Final = "What is to be corrected? Enter opens it."
CORRECT_NOTHING: Final = "There is no station, instrument or session yet."
CORRECT_FORM: Final = "Correct {kind} {name}"
CORRECT_STATE: Final = "F8 writes it"
CORRECTED: Final = "written to project.toml: {names}"
CORRECTED_NOTHING: Final = "nothing was changed"
CORRECT_UNWRITTEN: Final = "Not written yet: F8 writes it, Escape again leaves it as it was."
TABLE_KINDS: Final = {
    "station": "station",
    "instrument": "instrument",
    "orientation": "session",
}
CLOSED_MARK: Final = "{id} (closed)"
YES_NO: Final = {"": "no", "yes": "yes"}
CORRECT_LABELS: Final = {
    "e": "E m",
    "n": "N m",
    "y_west": "y west m",
    "x_south": "x south m",
    "lat": "Latitude deg",
    "lon": "Longitude deg",
    "h": "Height m",
    "sigma_m": "Sigma m",
    "fixed": "Fixed",
    "deflection-xi_arcsec": "Deflection xi",
    "deflection-eta_arcsec": 'eta "',
    "deflection-sigma_arcsec": 'its sigma "',
    "note": "Note",
    "card": "Card",
    "serial": "Serial no.",
    "constant-arcsec": 'Constant "',
    "constant-sigma_arcsec": 'its sigma "',
    "constant_choice": "Choice",
    "scale_value_arcsec": 'Scale value "',
    "period-latitude_deg": "Period at lat",
    "period-tracking_s": "T1 tracked s",
    "period-clamped_s": "T2 clamped s",
    "torsion-lambda": "Torsion ratio",
    "station": "Station",
    "target": "Target",
    "instrument": "Instrument",
    "observer": "Observer",
    "date": "Date",
    "azimuth_known": "Known azimuth",
    "azimuth_known_sigma_arcsec": 'its sigma "',
    "wanted_interval_arcsec": 'Wanted 95 % "',
    "circle_shift": "Circle shift",
}
