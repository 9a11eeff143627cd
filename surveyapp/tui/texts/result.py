"""The result of a session, and closing it."""

from __future__ import annotations

from typing import Final

# result screen
RESULT_TITLE: Final = "{project}  {session}  result"
R_CHAIN: Final = "From the readings to the azimuth"
R_CHECKS: Final = "Checks"
R_BUDGET: Final = "What the sigma is made of"
R_HELPS: Final = 'Most helps: {advice}. Without this part ±{without}" instead of ±{sigma}".'
R_HELPS_ALONE: Final = "Most helps: {advice}. Nothing else is in this sigma."
R_AT_CALIBRATION: Final = "at the calibration, {advice}"
IMPROVE: Final = {
    "adopted effect": "observe again without the disturbance, or longer with it",
    "adopted effect outside its range": "measure what the effect needs within its range",
    "centring": "centre more exactly, or take a longer line",
    "clamp reading": "read the clamped circle several times",
    "constant instability": "calibrate near the survey, before and after it",
    "constant: cause not known": "calibrate again as the diagnosis advises",
    "constant: scatter in the archive": "determine the constant four times and more",
    "constant: scatter of the determinations": "calibrate more often",
    "damping": "read more turning points",
    "deflection": "have the deflection of the vertical determined there",
    "eccentricity": "measure the eccentric elements again, or set up on the mark",
    "graduation": "shift the circle between the rounds",
    "known azimuth": "calibrate on a line whose azimuth is known better",
    "known constant": "calibrate on a known line, before and after",
    "lateral refraction": "keep the sight off the wall, or observe it from both ends",
    "latitude of the constant": "calibrate at the latitude of the survey",
    "levelling": "level again, read the level, or take a flatter sight",
    "linear form": "clamp nearer to north, or state the torsion ratio",
    "observer": "exchange the observers between two runs",
    "passages": "time more passages",
    "plan": "determine the coordinates of the ends better",
    "printed convergence": "name the crs, or have the convergence printed to more digits",
    "rotation of the mine grid": "determine the rotation of the mine grid on a longer line",
    "rounds": "take more rounds",
    "run-to-run scatter": "repeat the session: runs differ by more than their readings tell",
    "scale readings": "read more turning points on the scale",
    "scale readings and passages": "time more passages and read more turning points",
    "scatter of determinations": "repeat the calibration",
    "sights": "sight the target more often in both faces",
    "tape zero": "read more turning points of the tape zero, before and after",
    "tape zero change": "observe the tape zero again; adjust it if it moves",
    "temperature of the constant": "calibrate at the temperature of the survey",
    "torsion ratio": "have the torsion ratio determined from T1 and T2",
    "transit constant": "determine the transit constant by two clampings",
    "turning points": "read more turning points",
    "twist": "sight the target again after the swing",
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

# closing
SIGN_TITLE: Final = "Close and sign this session"
SIGN_MEANING: Final = (
    "Its book and its table are sealed in the ledger. Nothing is locked away:\n"
    "`surveyapp reopen` opens it again and keeps the reason."
)
SIGN_NAME: Final = "your name"
SIGN_KEYS: Final = "Enter signs   Escape does not"
SIGNED: Final = "closed and signed by {name}; files sealed: {files}; seal {head}"
PDF_AGAIN: Final = "PDF made again with the signature: {path}"
PDF_OUT_OF_DATE: Final = "the PDF on the disk is OUT OF DATE, it lacks the signature: {what}"
CLOSED_SESSION: Final = "READING ONLY: closed and signed"
KEY_SIGN: Final = "Close and sign"
