"""Guided programmes of sensors for scripts, re-exported by ``surveyapp.api``."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.api.project import SOFTWARE, Folder
from surveyapp.api.sensors import LogOptions
from surveyapp.domain.programme import LOG, ProgrammeState
from surveyapp.domain.records import Listing

if TYPE_CHECKING:
    from surveyapp.domain.advance import PartDone
    from surveyapp.domain.programme import Programme, ProgrammeResult
    from surveyapp.io.sensor_logs.reading import LogRequest


def programmes() -> Listing[Programme]:
    """Every guided programme with its steps."""
    from surveyapp.core.sensors.programmes.catalogue import PROGRAMMES

    return Listing("surveyapp.programmes/1", "programmes", PROGRAMMES)


def begin_programme(
    folder: Folder, programme: str, identity: str, *, now: datetime | None = None
) -> ProgrammeState:
    """Begin a run of a programme in a project.

    Parameters
    ----------
    folder : path
        Of the project.
    programme : str
        Id, of ``programmes()``.
    identity : str
        Of the run; the sensor log that comes of it has it too.
    now : datetime.datetime, optional
        With its offset.

    Raises
    ------
    SurveyError
        If there is no such programme, or the id is taken.
    """
    from surveyapp.workflows.guided import begin_run

    begin_run(Path(folder), programme, identity, moment=_moment(now), software=SOFTWARE)
    return programme_state(folder, identity, now=now)


def programme_state(
    folder: Folder,
    identity: str,
    *,
    log: LogOptions | None = None,
    now: datetime | None = None,
) -> ProgrammeState:
    """Where a run stands: which step is next, what is still undetermined.

    Parameters
    ----------
    folder : path
    identity : str
    log : LogOptions, optional
        How the columns of its log are to be understood; the log may still be growing.
    now : datetime.datetime, optional

    Raises
    ------
    SurveyError
        If the run or its log cannot be read.
    """
    from surveyapp.io.programmes import read_run
    from surveyapp.workflows.guided import run_state

    run = read_run(Path(folder), identity)
    request = None if run.log is None else _request(Path(folder), run.log, log or LogOptions())
    return run_state(Path(folder), identity, moment=_moment(now), request=request)


def record_programme(
    folder: Folder,
    identity: str,
    step: str,
    value: str = "",
    *,
    note: str = "",
    log: LogOptions | None = None,
    now: datetime | None = None,
) -> ProgrammeState:
    """Write down that a step was done, what was read in it, or which log belongs to the run.

    Parameters
    ----------
    folder : path
    identity : str
        Of the run.
    step : str
        Of the programme; ``log`` names a file, which may still be growing; ``strike`` strikes the
        latest entry, whose reason is the note.
    value : str
        Numbers of a reading separated by blanks; the path of a log.
    note : str
    log : LogOptions, optional
    now : datetime.datetime, optional

    Raises
    ------
    SurveyError
        If nothing is typed in this step, or the reading is none; nothing is written then.
    """
    from surveyapp.domain.programme import STRIKE
    from surveyapp.workflows.guided import give_log, record_entry, strike_entry

    place, moment = Path(folder), _moment(now)
    if step == LOG:
        give_log(place, identity, value, options=note, moment=moment)
    elif step == STRIKE:
        strike_entry(place, identity, note=note, moment=moment)
    else:
        record_entry(place, identity, step, value, note=note, moment=moment)
    return programme_state(folder, identity, log=log, now=now)


def finish_programme(
    folder: Folder,
    identity: str,
    *,
    options: Mapping[str, object] | None = None,
    log: LogOptions | None = None,
    card: Folder | None = None,
    now: datetime | None = None,
    progress: PartDone | None = None,
) -> ProgrammeResult:
    """End a run: its readings become a sensor log of the project, which is calibrated.

    Parameters
    ----------
    folder : path
    identity : str
    options : mapping, optional
        Of the calibration, or of north.
    log : LogOptions, optional
        How the columns of a recorded log are to be understood.
    card : path, optional
        Where the sensor card is written, if everything is determined.
    now : datetime.datetime, optional
    progress : callable, optional

    Raises
    ------
    SurveyError
        If nothing was read or recorded, and for input that cannot be used.
    """
    from surveyapp.workflows.guided_end import end_run

    state = programme_state(folder, identity, log=log, now=now)
    request = None
    if state.run.log is not None:
        request = _request(Path(folder), state.run.log, log or LogOptions())
    return end_run(
        Path(folder),
        state,
        request,
        options=options or {},
        card=None if card is None else Path(card),
        moment=_moment(now),
        software=SOFTWARE,
        progress=progress,
    )


def _moment(now: datetime | None) -> datetime:
    return datetime.now(UTC).astimezone() if now is None else now


def _request(folder: Path, name: str, log: LogOptions) -> LogRequest:
    from surveyapp.io.sensor_logs.reading import LogRequest

    path = folder / name  # an absolute name stands for itself
    return LogRequest(
        path=path,
        where=name,
        id=path.name,
        columns=log.columns,
        units=log.units,
        scale=log.scale,
        rate_hz=log.rate_hz,
        header_rows=log.header_rows,
    )
