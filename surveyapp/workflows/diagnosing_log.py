"""``diagnose --sensor``: the loop on a log of a project."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Final

import numpy as np

from surveyapp.core.sensors.clipping import unclipped_rows, without_clipped
from surveyapp.diagnosis.sensors.diagnosis import SensorDiagnosis, diagnose_sensor
from surveyapp.diagnosis.sensors.records import SensorRecord, compass_record, tilt_record
from surveyapp.domain.advance import PartDone
from surveyapp.domain.columns import PIECE
from surveyapp.domain.project import Project
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import QUATERNION, SensorLog, kept_places
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.languages import said
from surveyapp.workflows.adopting import NotWritten, sensor_tables
from surveyapp.workflows.diagnosing_sensor import already_adopted, write_under
from surveyapp_models.effects.effect import Effect

MAG = ("mag_x_uT", "mag_y_uT", "mag_z_uT")
PLACE = ("ref_px_m", "ref_py_m", "ref_pz_m")
TILT = ("tilt_along_arcsec", "tilt_across_arcsec", "ref_along_arcsec", "ref_across_arcsec")
MOST_ROWS: Final = 100_000
"""A longer log is thinned: effects and switches are seen in it as well, and in bounded memory."""

FEWEST = 40
"""Rows below which no effect is told from noise."""


@dataclass(frozen=True, slots=True)
class SecondLog:
    """A second log of the same sensor: its name and its file."""

    identity: str
    file: LogFile


def diagnose_log(
    kind: str | None,
    identity: str,
    file: LogFile,
    *,
    own: Sequence[Effect] = (),
    confirm: SecondLog | None = None,
    progress: PartDone | None = None,
) -> SensorDiagnosis:
    """Diagnose a compass or a tilt log.

    Parameters
    ----------
    kind : str or None
        compass or tilt; None = by its columns.
    identity : str
    file : LogFile
    own : sequence of Effect
        The user's.
    confirm : SecondLog, optional
    progress : callable, optional

    Raises
    ------
    SurveyError
        If the log is of another kind or too short, and for what is wrong with it.
    """
    if kind is None:
        if not file.has(*MAG) and not file.has(*TILT):
            raise SurveyError(
                Problem(
                    "the kind of the log is not stated, and its columns are no compass or tilt",
                    f"[[sensor_log]] {identity}",
                    "no kind",
                    "compass | tilt | rate | fog-station",
                    'write kind = "rate" (or another) under the log in project.toml',
                )
            )
        kind = "compass" if file.has(*MAG) else "tilt"
    record, log = _record(kind, identity, file, own, progress=progress)
    second = None
    if confirm is not None:
        second, other = _record(kind, confirm.identity, confirm.file, own, progress=None)
        if other.sha256 == log.sha256:
            raise SurveyError(
                Problem(
                    "the second set is no second set: it would confirm whatever it chose",
                    said("confirm, {identity}", identity=confirm.identity),
                    said("the rows of {identity}", identity=identity),
                    "another log of the same sensor, taken independently",
                )
            )
        if second.mode != record.mode:
            raise SurveyError(
                Problem(
                    "the second log shows another thing",
                    said("confirm, {identity}", identity=confirm.identity),
                    said("the {mode} of the field", mode=second.mode),
                    said("the {mode}, as in {identity}", mode=record.mode, identity=identity),
                    "both need a reference attitude, or neither",
                )
            )
    return diagnose_sensor(
        record,
        identity=identity,
        n_log=log.size,
        warnings=log.warnings,
        second=second,
        data_sha256=log.sha256 or "",
    )


def adopt_log(
    found: SensorDiagnosis,
    project: Project,
    entry: SensorLogEntry,
    *,
    adopt: bool,
    software: str,
    now: datetime | None = None,
) -> SensorDiagnosis:
    """Append a diagnosis to the ledger and, where asked, write what it named under the log."""
    tables: list[dict[str, object]] = []
    refused: tuple[NotWritten, ...] = ()
    if adopt:
        tables, refused = sensor_tables(found.records, entry)
    written, more = write_under(project, entry, found.ledger, tables, software=software, now=now)
    notes = [*already_adopted(entry), *more]
    words = [n.text for n in notes] + list(found.words) + [f"Not written: {i}." for i in refused]
    warnings = [*found.document["warnings"], *(note.to_dict() for note in notes)]
    return replace(
        found,
        document={**found.document, "warnings": warnings},
        words=tuple(words),
        written=written,
        not_written=tuple(item.to_dict() for item in refused),
    )


def _record(
    kind: str, identity: str, file: LogFile, own: Sequence[Effect], *, progress: PartDone | None
) -> tuple[SensorRecord, SensorLog]:
    """A log as the loop takes it."""
    needed = tuple(need.name for effect in own for need in effect.needs if file.has(need.name))
    if kind == "compass":
        attitude = QUATERNION if file.has(*QUATERNION) else ()
        place = PLACE if file.has(*PLACE) else ()
        optional = ("temperature_c", *needed)
        log = file.read(
            Need(columns=(*MAG, *attitude, *place), varying=MAG, optional=optional),
            progress=progress,
        )
    elif kind == "tilt":
        need = Need(
            columns=TILT, varying=TILT, optional=("temperature_c", *needed), timed="optional"
        )
        log = file.read(need, progress=progress)
    else:
        what, expected = "logs of this kind are not diagnosed by themselves", "compass | tilt"
        raise SurveyError(Problem(what, identity, kind, expected))
    if log.size < FEWEST:
        found, expected = (
            said("{size} rows", size=log.size),
            said("{fewest} rows or more", fewest=FEWEST),
        )
        raise SurveyError(Problem("the log is too short to diagnose", log.path, found, expected))
    mine = tuple(effect for effect in own if effect.subject == kind)
    fitted = MAG if kind == "compass" else TILT[:2]
    used = without_clipped(log, fitted, most=MOST_ROWS)
    made = compass_record(used, mine) if kind == "compass" else tilt_record(used, mine)
    gross = _in_the_log(made.gross, unclipped_rows(log, fitted), log.size)
    return replace(made, gross=gross), replace(log, warnings=used.warnings)


def _in_the_log(
    gross: Sequence[tuple[int, float]], kept: np.ndarray | None, size: int
) -> tuple[tuple[int, float], ...]:
    """Rows of what was fitted as rows of the log, from which clipped and thinned ones are gone."""
    left = size if kept is None else int(np.count_nonzero(kept))
    every = -(-left // MOST_ROWS)
    if kept is None:
        return tuple((row * every, value) for row, value in gross)
    rows = np.concatenate([PIECE * k + places for k, places in enumerate(kept_places(kept, every))])
    return tuple((int(rows[row]), value) for row, value in gross)
