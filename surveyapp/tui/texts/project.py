"""The project's pages, its traverses and the diagnosis."""

from __future__ import annotations

from typing import Final

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
NO_SESSIONS: Final = (
    "This project has no orientation session yet: n makes one, i reads a field file of a total "
    "station or of an automatic gyro; l shows the logs and cards of its sensors."
)
BEING_OBSERVED: Final = "This session is still being observed: Enter goes on with it."
NO_LINES: Final = "No line is oriented yet: a line needs sights of a target and gyro north."
NO_CONSTANTS: Final = "No calibration session: there is no instrument constant from this project."
NO_CHECK_ROWS: Final = "There is nothing to check yet."
NO_WARNINGS: Final = "No warnings."

# details
CONSTANT_DAYS: Final = "days (UTC)"
CONSTANT_ORDER: Final = "in order"
CONSTANT_AXIS: Final = 'constant ", bars ±1 sigma; {axis}'
PURPOSES: Final = {"survey": "survey", "calibration": "calibration"}

# diagnosis screen
DIAGNOSIS_TITLE: Final = "{name}: what the model lacks"
DIAGNOSING: Final = "diagnosing ..."
NO_SUBJECTS: Final = "Nothing here can be diagnosed: it takes a reversal run or three sessions."
COL_SUBJECT: Final = "subject"
COL_ID: Final = "id"
SUBJECT_RUN: Final = "run"
SUBJECT_CAMPAIGN: Final = "campaign"
SUBJECT_TRAVERSE: Final = "traverse"
D_BEFORE: Final = "before"
D_AFTER: Final = "after"
KEY_DIAGNOSE: Final = "Diagnose"
KEY_ADOPT: Final = "Adopt"
KEY_YES: Final = "Yes"
NOTHING_TO_ADOPT: Final = "No effect is named here: there is nothing to adopt."
ADOPT_ASK: Final = (
    "Adopt this?\n{names}\n\nIt is written into project.toml; the next result uses it."
)
CONFIRM_KEYS: Final = "Enter: yes   Escape: no"
ADOPTED: Final = "written: {place}"

# traverses
TRAVERSE_TITLE: Final = "{name}: traverses"
KEY_TRAVERSE: Final = "Traverse"
KEY_NEXT_TRAVERSE: Final = "Next traverse"
NO_TRAVERSE: Final = "This project has no [[traverse]]."
TAB_PLAN: Final = "1 Plan"
TAB_ADJUSTMENT: Final = "2 Adjustment"
TAB_POINTS: Final = "3 Points"
TAB_OBSERVATIONS: Final = "4 Observations"
TAB_ALL_CHECKS: Final = "5 Checks"
PLAN_EMPTY: Final = "There is no plan yet."
PLAN_LEGEND: Final = "{fixed} fixed  {free} adjusted, ellipses {factor} x  north is up"
PLAN_GYRO: Final = "  G gyro side"
COL_KIND: Final = "kind"
T_UNCONTROLLED: Final = "nothing controls it"
T_STATE: Final = "sigma0 {ratio}, dof {dof}: {word}"
