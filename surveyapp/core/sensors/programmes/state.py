"""Where a run of a programme stands: which step is next, what is still undetermined."""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import datetime
from typing import Final

from surveyapp.core.sensors.programmes.catalogue import PROGRAMMES
from surveyapp.core.sensors.programmes.design import known_of
from surveyapp.domain.programme import (
    Programme,
    ProgrammeRun,
    ProgrammeState,
    ProgrammeStep,
    Row,
    StepState,
    StepStatus,
)
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said

BY_ID: Final = {programme.id: programme for programme in PROGRAMMES}
DONE: Final = "done"
_SEPARATORS: Final = str.maketrans({";": " ", "\t": " "})


def programme_of(identity: str) -> Programme:
    """A programme by its id.

    Raises
    ------
    SurveyError
        If there is none.
    """
    if identity not in BY_ID:
        hint = nearest_names(identity, BY_ID)
        raise SurveyError(Problem("there is no such programme", "programme", identity, hint=hint))
    return BY_ID[identity]


def read_value(step: ProgrammeStep, text: str) -> tuple[float, ...]:
    """Numbers of a typed reading, in the order of what the step asks.

    Raises
    ------
    SurveyError
        If they are not as many numbers.
    """
    words = text.translate(_SEPARATORS).split()
    values = []
    for word in words:
        try:
            values.append(float(word))
        except ValueError:
            values.append(math.nan)
    if len(values) != len(step.asks) or not all(math.isfinite(value) for value in values):
        expected = " ".join(step.asks)
        count = f"{len(step.asks)} numbers" if len(step.asks) > 1 else "a number"
        hint = "decimals are written with a point, several numbers with a blank between"
        raise SurveyError(
            Problem(said("this is not {number}", number=count), step.title, text, expected, hint)
        )
    return tuple(values)


def typed_rows(programme: Programme, run: ProgrammeRun) -> list[Row]:
    """Rows of a log from what was typed, in the order of the steps."""
    live = run.live
    rows: list[Row] = []
    for step in programme.steps:
        entry = live.get(step.id)
        if step.kind != "read" or entry is None:
            continue
        values = dict(zip(step.asks, read_value(step, entry.value), strict=True))
        seconds = (entry.time - run.entries[0].time).total_seconds()
        rows.append({**step.row, **values, "time_s": seconds})
    return rows


def state_of(
    programme: Programme,
    run: ProgrammeRun,
    *,
    now: datetime,
    seen: Sequence[Row] = (),
) -> ProgrammeState:
    """Where a run stands.

    Parameters
    ----------
    programme : Programme
    run : ProgrammeRun
    now : datetime.datetime
        For the minutes of a wait that is open.
    seen : sequence of Row
        What its log holds so far.
    """
    rows = typed_rows(programme, run) if programme.typed else list(seen)
    found: list[StepState] = []
    warnings: list[str] = []
    waits: float | None = None
    open_before = False
    for step in programme.steps:
        status, told = _status(step, run, rows)
        if status == "short":
            warnings.append(f"{step.title}: {told}")
        if status == "open" and not open_before:
            open_before, status = True, "here"
            waits = _left(step, run, now)
        found.append(StepState(step, status, told))
    return ProgrammeState(
        run, programme, tuple(found), known_of(programme, rows), tuple(warnings), waits
    )


def _status(step: ProgrammeStep, run: ProgrammeRun, rows: Sequence[Row]) -> tuple[StepStatus, str]:
    entry = run.live.get(step.id)
    if step.kind == "record":
        return _recorded(step, rows)
    if entry is None:
        return "open", ""
    if step.kind == "read":
        return "done", entry.value
    if step.kind == "wait":
        begun = run.live.get(step.since)
        if begun is None:
            return "short", f"the moment of {step.since} is not known, {step.minutes:g} min asked"
        passed = (entry.time - begun.time).total_seconds() / 60.0
        told = f"{passed:.1f} of {step.minutes:g} min"
        return ("done" if passed >= step.minutes else "short"), told
    return "done", entry.note


def _left(step: ProgrammeStep, run: ProgrammeRun, now: datetime) -> float | None:
    """Minutes left of a wait [min]."""
    begun = run.live.get(step.since)
    if step.kind != "wait" or begun is None:
        return None
    return max(step.minutes - (now - begun.time).total_seconds() / 60.0, 0.0)


def _recorded(step: ProgrammeStep, rows: Sequence[Row]) -> tuple[StepStatus, str]:
    """A step that the log must hold: how many turns of it are whole."""
    here = [row for row in rows if all(row.get(key) == value for key, value in step.row.items())]
    if not here:
        return "open", ""
    if "turns" in here[0]:
        turns = max(float(row["turns"]) for row in here)
        whole = math.floor(turns + 1e-3)
        told = f"{turns:.2f} turns, {whole} whole"
        return ("done" if whole >= 1 else "open"), told
    if "seconds" in here[0]:
        return "done", f"{float(here[0]['seconds']) / 60.0:.1f} min"
    return "done", f"at {float(here[0]['at_s']):.1f} s"
