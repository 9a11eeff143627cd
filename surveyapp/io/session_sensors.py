"""``levelling`` and ``pre_orientation`` of an ``[[orientation]]``: a sensor log with its card."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from surveyapp.core.geodesy.mine import grid_of
from surveyapp.core.geodesy.position import position_of
from surveyapp.core.sensors.adopted_effects import without_events
from surveyapp.core.sensors.card_fits import range_doubts, resting_doubts
from surveyapp.core.sensors.compensation import compensate_compass, compensate_tilt
from surveyapp.core.sensors.declination import model_declination, unstated_sigma
from surveyapp.core.swing.levelling import ASIDE
from surveyapp.domain.project import OrientationSession, Project, Station
from surveyapp.domain.readings import FieldBook, Reading, ReadingKind
from surveyapp.domain.sensor_card import SensorCard
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import TRIPLES, SensorLog
from surveyapp.domain.session_sensors import BlockTilt, LogLevelling, PreOrientation
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.findings import Findings
from surveyapp.io.project_files import ProjectFiles, inside
from surveyapp.io.sensor_cards import read_sensor_card
from surveyapp.io.sensor_logs.reading import Need, open_log
from surveyapp.io.sensor_logs.tables import request_of
from surveyapp.io.tables import Table
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, AngleUnit
from surveyapp_models.arrays import Floats

TILTS: Final = ("tilt_along_arcsec", "tilt_across_arcsec")
BLOCKS: Final = 10
"""Contiguous parts of a record whose means tell how well its mean is known."""
EPOCH_S: Final = 1e8
"""Times beyond this count from 1970 and are compared with the times of the book."""


@dataclass(frozen=True, slots=True)
class _Source:
    entry: SensorLogEntry
    card: SensorCard
    name: str
    where: str


def with_sensors(
    sessions: Sequence[OrientationSession],
    tables: Sequence[Table],
    files: ProjectFiles,
    logs: Sequence[SensorLogEntry],
    *,
    unit: AngleUnit,
) -> list[OrientationSession]:
    """Sessions with what their logs say; problems go to the findings.

    Parameters
    ----------
    sessions : sequence of OrientationSession
        With their books.
    tables : sequence of Table
        Their tables, in the same order.
    files : ProjectFiles
    logs : sequence of SensorLogEntry
    unit : AngleUnit
    """
    found = []
    for session, table in zip(sessions, tables, strict=True):
        levelling, aimed = table.table("levelling"), table.table("pre_orientation")
        try:
            if levelling is not None:
                source = _source(levelling, files, logs, kind="tilt")
                levelling.warn_unknown("log", "card")
                if source is not None:
                    session = replace(session, levelling=_levelling(session, source, files))
        except SurveyError as error:
            _absorb(error, files, session)
        try:
            if aimed is not None:
                made = _aimed(session, aimed, files, logs, unit=unit)
                session = replace(session, pre_orientation=made)
        except SurveyError as error:
            _absorb(error, files, session)
        found.append(session)
    return found


def _absorb(error: SurveyError, files: ProjectFiles, session: OrientationSession) -> None:
    """A problem; while a session is observed its log may still be growing: a warning."""
    if not files.observing:
        files.findings.absorb(error)
        return
    subject = Subject.session(session.id)
    text = error.problems[0].what
    files.findings.warnings.append(ResultWarning("sensor_log_unusable", text, subject))


def _source(
    table: Table, files: ProjectFiles, logs: Sequence[SensorLogEntry], *, kind: str
) -> _Source | None:
    """The log and the card that a table names; None with problems noted."""
    name, path = table.text("log", required=True), table.text("card", required=True)
    ids = [entry.id for entry in logs]
    entry = next((item for item in logs if item.id == name), None)
    if name and entry is None:
        expected = said("an id of [[sensor_log]]")
        table.problem(said("there is no such sensor log"), name, expected, nearest_names(name, ids))
    if entry is not None and entry.kind not in (None, kind):
        table.problem(said("the log is of another kind"), entry.kind, kind)
        entry = None
    if not path or not inside(path, table) or files.read(path, table.where) is None:
        return None
    card = read_sensor_card(files.path / path, where=path)
    files.findings.warnings += card.warnings
    if card.kind != kind:
        table.problem(said("the card is of another kind"), card.kind, kind)
        return None
    return None if entry is None else _Source(entry, card, path, table.where)


def _read(source: _Source, files: ProjectFiles, columns: tuple[str, ...]) -> SensorLog:
    file = open_log(request_of(source.entry, files.path))
    acc = TRIPLES["acc"] if source.card.kind == "compass" and file.has(*TRIPLES["acc"]) else ()
    log = file.read(Need(columns=(*columns, *acc), optional=("temperature_c",)))
    log, told = without_events(log, source.entry.effects)
    _tell(told, source, files)
    return log


def _tell(told: Sequence[ResultWarning], source: _Source, files: ProjectFiles) -> None:
    """Warnings of a log as warnings of the project."""
    files.findings.warnings += [
        ResultWarning(
            item.code, said("sensor_log {id}: {text}", id=source.entry.id, text=item.text)
        )
        for item in told
    ]


def _refusals(
    session: OrientationSession, source: _Source, log: SensorLog, keep: np.ndarray
) -> tuple[str, ...]:
    """Why the card does not hold on the session's day at the temperatures of the record."""
    values = log.columns.get("temperature_c")
    span = None
    if values is not None and np.any(np.isfinite(values[keep])):
        span = (float(np.nanmin(values[keep])), float(np.nanmax(values[keep])))
    day = session.day or source.entry.calibrated_on
    problems = source.card.refusals(on=day, temperature_c=span, where=source.name)
    for key, own in (("instrument", source.entry.instrument), ("serial", source.entry.serial)):
        stated = source.card.extra.get(key)
        if stated is not None and own is not None and str(stated) != own:
            what = said("the card is of another instrument")
            problems.append(Problem(what, source.name, str(stated), f"{key} {own}"))
    return tuple(
        said(
            "{what}: {found}, expected {expected}", what=p.what, found=p.found, expected=p.expected
        )
        for p in problems
    )


def _levelling(session: OrientationSession, source: _Source, files: ProjectFiles) -> LogLevelling:
    log = _read(source, files, TILTS)
    times = log.columns["time_s"]
    run, zero = _masks(session.book, times)
    if not np.any(run):
        raise SurveyError(
            Problem(
                "the tilt log has no sample during the session",
                source.where,
                f"time_s {times.min():g} to {times.max():g} s",
                _span(session.book, epoch=float(times.max()) > EPOCH_S),
                "time_s counts as elapsed_s of the book, or in seconds since 1970",
            )
        )
    result = LogLevelling(source.entry.id, source.name)
    refusals = _refusals(session, source, log, run | zero)
    if refusals:
        return replace(result, refusals=refusals)
    _tell(range_doubts(log.chosen(run | zero), source.card), source, files)
    true = compensate_tilt(log, source.card, where=source.name).columns
    fixed = {k: v for k, v in source.card.constants.items() if k != "reading_sigma_arcsec"}
    calibration = compensate_tilt(
        log, replace(source.card, constants=fixed), where=source.name
    ).columns
    noise = source.card.constants.get("reading_sigma_arcsec", 0.0)

    def block(keep: Floats) -> BlockTilt | None:
        values = [np.asarray(true[name])[keep] for name in TILTS]
        keeps = np.isfinite(values[0]) & np.isfinite(values[1])
        if not np.any(keeps):
            return None
        own = [np.asarray(calibration[f"sigma_{a}_arcsec"])[keep] for a in ("along", "across")]
        sigma = max(
            math.hypot(float(o[keeps].max()), _mean_sigma(v[keeps], noise))
            for v, o in zip(values, own, strict=True)
        )
        along, across = (float(v[keeps].mean()) * ARCSEC for v in values)
        return BlockTilt(along, across, sigma * ARCSEC, int(keeps.sum()))

    return replace(result, run=block(run), tape_zero=block(zero))


def _mean_sigma(values: Floats, noise: float) -> float:
    """Sigma of a mean: from the means of contiguous parts, not below independent readings."""
    least = noise / math.sqrt(values.size)
    count = min(BLOCKS, values.size)
    if count < 2:
        return least
    means = np.array([part.mean() for part in np.array_split(values, count)])
    return max(least, float(means.std(ddof=1)) / math.sqrt(count))


def _seconds(book: FieldBook, row: Reading, *, epoch: bool) -> float | None:
    if epoch:
        return None if row.time is None else row.time.timestamp()
    if row.elapsed_s is not None:
        return row.elapsed_s
    first = next((r.time for r in book.live if r.time is not None), None)
    return None if row.time is None or first is None else (row.time - first).total_seconds()


def _moments(book: FieldBook, *, epoch: bool) -> list[tuple[float, bool]]:
    """Times of the rows that observe something, and whether they are tape zeros."""
    rows = [row for row in book.live if row.kind not in ASIDE]
    timed = [(_seconds(book, row, epoch=epoch), row.kind) for row in rows]
    return [(t, kind is ReadingKind.TAPE_ZERO) for t, kind in timed if t is not None]


def _span(book: FieldBook, *, epoch: bool) -> str:
    times = [t for t, _ in _moments(book, epoch=epoch)]
    if not times:
        return said("a book with times of its rows")
    return said(
        "samples from {times:.12g} to {times2:.12g} s of the book",
        times=min(times),
        times2=max(times),
    )


def _masks(book: FieldBook, times: Floats) -> tuple[np.ndarray, np.ndarray]:
    """Samples during the run with its sights, and during the tape zeros.

    Between two blocks the border lies in the middle.
    """
    moments = sorted(_moments(book, epoch=float(times.max()) > EPOCH_S))
    run, zero = np.zeros(times.size, dtype=bool), np.zeros(times.size, dtype=bool)
    for (start, first), (end, second) in pairwise(moments):
        middle = end if first == second else 0.5 * (start + end)
        inside_first = (times >= start) & (times <= middle)
        inside_second = (times > middle) & (times <= end)
        (zero if first else run)[inside_first] = True
        (zero if second else run)[inside_second] = True
    return run & ~zero, zero


def _aimed(
    session: OrientationSession,
    table: Table,
    files: ProjectFiles,
    logs: Sequence[SensorLogEntry],
    *,
    unit: AngleUnit,
) -> PreOrientation | None:
    source = _source(table, files, logs, kind="compass")
    declination = table.number("declination_deg", low=-180.0, high=180.0)
    stated = table.number("sigma_deg", low=0.0, high=90.0)
    circle = table.angle("circle", unit)
    if stated is not None and declination is None:
        table.problem(
            said("sigma_deg stands without declination_deg"), stated, said("both or none")
        )
    table.warn_unknown()
    if source is None:
        return None
    log = _read(source, files, TRIPLES["mag"])
    everything = np.ones(log.size, dtype=bool)
    refusals = _refusals(session, source, log, everything)
    result = PreOrientation(
        source.entry.id,
        source.name,
        declination=None if declination is None else math.radians(declination),
        circle=circle,
        refusals=refusals,
    )
    if refusals:
        return result
    _tell(resting_doubts(log, source.card, where=source.name), source, files)
    columns = compensate_compass(
        log, source.card, declination=None, where=source.name, one_reading=False
    ).columns
    headings = np.radians(np.asarray(columns["heading_deg"], dtype=np.float64))
    within = np.isfinite(headings)
    if not within.any():
        text = said("no row is tilted as little as the calibration of the card")
        return replace(result, refusals=(text,))
    headings = headings[within]
    mean = float(np.angle(np.exp(1j * headings).mean()))
    spread = np.angle(np.exp(1j * (headings - mean)))
    calibration = math.radians(float(np.nanmax(np.asarray(columns["heading_sigma_deg"]))))
    added = 0.0
    if declination is not None:
        added = unstated_sigma(log) if stated is None else math.radians(stated)
    sigma = math.hypot(calibration, _mean_sigma(spread, 0.0), added)
    return replace(
        result,
        heading=mean % (2.0 * math.pi),
        sigma=sigma,
        declination_sigma=None if declination is None else added,
    )


def with_declinations(project: Project, findings: Findings) -> Project:
    """The same with the declination of the World Magnetic Model where none is stated.

    For the place of the station, through the project's grid where it has no latitude and longitude,
    and the day of the session.
    """
    places = {station.name: station for station in project.stations}
    sessions = []
    for session in project.sessions:
        aimed = session.pre_orientation
        if aimed is not None and aimed.declination is None and aimed.heading is not None:
            made = _with_model(aimed, session, places.get(session.station), (project, findings))
            session = replace(session, pre_orientation=made)
        sessions.append(session)
    return replace(project, sessions=tuple(sessions))


def _with_model(
    aimed: PreOrientation,
    session: OrientationSession,
    place: Station | None,
    around: tuple[Project, Findings],
) -> PreOrientation:
    project, findings = around
    day = session.day
    if place is None or day is None:
        return aimed
    try:
        known = place.latitude is not None and place.longitude is not None
        at = position_of(place, None if known else grid_of(project))
        if at.latitude is None or at.longitude is None:
            return aimed
        declination, sigma = model_declination(
            latitude_deg=math.degrees(at.latitude),
            longitude_deg=math.degrees(at.longitude),
            height_m=at.h or 0.0,
            day=day,
        )
    except SurveyError as error:
        text = said(
            "session {id}: no declination by the model: {what}",
            id=session.id,
            what=error.problems[0].what,
        )
        warning = ResultWarning("no_model_declination", text, Subject.session(session.id))
        findings.warnings.append(warning)
        return aimed
    return replace(
        aimed,
        declination=math.radians(declination),
        declination_sigma=math.radians(sigma),
        sigma=math.hypot(aimed.sigma or 0.0, math.radians(sigma)),
        modelled=True,
    )
