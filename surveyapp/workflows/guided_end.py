"""The end of a guided programme: a sensor log of the project, its calibration or north, a card."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from pathlib import Path

from surveyapp.domain.advance import PartDone
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.north import NorthResult
from surveyapp.domain.programme import ProgrammeResult, ProgrammeState
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.project import read_project
from surveyapp.io.sensor_logs.reading import LogRequest, open_log
from surveyapp.io.sensor_logs.tables import request_of
from surveyapp.workflows.calibrating import CalibrationRequest, run_calibration
from surveyapp.workflows.calibrating.cards import write_card
from surveyapp.workflows.guided import procedure_note, write_typed_log
from surveyapp.workflows.north import NorthRequest, find_north
from surveyapp.workflows.registering_log import LogEntryWish, register_log


def end_run(
    folder: Path,
    state: ProgrammeState,
    request: LogRequest | None,
    *,
    options: Mapping[str, object],
    card: Path | None,
    moment: datetime,
    software: str,
    progress: PartDone | None = None,
) -> ProgrammeResult:
    """Enter the log of a run, and calibrate it or find north from it.

    A run that was ended before is calibrated again from what it holds now.

    Raises
    ------
    SurveyError
        If nothing was read or recorded, and for input that cannot be used.
    """
    programme, identity = state.programme, state.run.id
    if programme.typed:
        write_typed_log(folder, state)
    elif request is None:
        what = "the run has no log yet"
        raise SurveyError(Problem(what, state.run.path, "", "the file that is being recorded"))
    elif identity not in {entry.id for entry in read_project(folder).sensor_logs}:
        register_log(folder, request, _wish(state, options), progress=progress)
    entry = next(e for e in read_project(folder).sensor_logs if e.id == identity)
    if programme.ends_in == "north":
        found = _north(folder, entry, state, options, moment=moment, progress=progress)
        return ProgrammeResult(state, identity, north=found)
    asked = CalibrationRequest(
        kind=programme.kind,
        file=open_log(request_of(entry, folder)),
        entry=entry,
        options=options,
        folder=folder,
        today=moment.date(),
        progress=progress,
    )
    result = run_calibration(asked)
    written = _card(card, result, asked, software)
    return ProgrammeResult(state, identity, calibration=result, card=written)


def _card(
    card: Path | None, result: Calibration, asked: CalibrationRequest, software: str
) -> str | None:
    nothing = all(item.value is None for item in result.parameters)
    if card is None or not result.met or nothing:
        return None
    card.parent.mkdir(parents=True, exist_ok=True)
    write_card(card, result, asked, software=software)
    return str(card)


def _wish(state: ProgrammeState, options: Mapping[str, object]) -> LogEntryWish:
    latitude = options.get("latitude")
    return LogEntryWish(
        id=state.run.id,
        kind=state.programme.kind,
        programme=state.programme.log_programme,
        latitude_deg=latitude if isinstance(latitude, float) else None,
        calibrated_on=state.run.entries[0].time.date(),
        more={"note": procedure_note(state)},
    )


def _north(
    folder: Path,
    entry: SensorLogEntry,
    state: ProgrammeState,
    options: Mapping[str, object],
    *,
    moment: datetime,
    progress: PartDone | None,
) -> NorthResult:
    return find_north(
        NorthRequest(
            method=state.programme.method or "",
            file=open_log(request_of(entry, folder)),
            entry=entry,
            options=options,
            folder=folder,
            today=moment.date(),
            progress=progress,
        )
    )
