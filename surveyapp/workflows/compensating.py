"""``compensate``: a card applied to a log, where it holds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path
from typing import Any, Final

from surveyapp.core.sensors.adopted_effects import without_events
from surveyapp.core.sensors.card_fits import compass_doubts, tilt_doubts
from surveyapp.core.sensors.compensation import (
    Columns,
    Compensated,
    Declination,
    compensate_compass,
    compensate_head,
    compensate_rate,
    compensate_tilt,
    force_sigma,
)
from surveyapp.core.sensors.declination import told_unstated, unstated_sigma
from surveyapp.domain.advance import PartDone, stage
from surveyapp.domain.sensor_card import SensorCard
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.sensor_cards import read_sensor_card
from surveyapp.io.sensor_logs.blocks import room_for
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.io.sensor_logs.writing import write_parts
from surveyapp.languages import said
from surveyapp.workflows.adopted_effects import need_with_adopted, without_adopted

BLOCK_ROWS: Final = 50_000
"""Rows that are corrected at once: a log of any length takes the memory of one block."""

FORCE_ROWS: Final = 20_000
"""Rows that tell the noise of the specific force, of the whole log."""

READING: Final = 0.25
"""Share of the work that is reading; the rest is writing."""

KINDS: Final = ("compass", "tilt", "rate")
MAG: Final = ("mag_x_uT", "mag_y_uT", "mag_z_uT")
ACC: Final = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")
TILT: Final = ("tilt_along_arcsec", "tilt_across_arcsec")
TABLE_COLUMNS: Final = ("table_rate_deg_s", "table_angle_deg", "round", "temperature_c")
GYR: Final = ("gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s")


_Rest = tuple[Declination | None, str, float]
"""Declination, name of the card, noise of the specific force."""


@dataclass(frozen=True, slots=True)
class CompensationResult:
    """What was written, schema ``surveyapp.compensate/1``.

    Parameters
    ----------
    kind, source, card, path : str
    rows : int
    columns : tuple of str
        Of the file that was written.
    reference : str or None
        Of headings: MAGNETIC, or ASTRONOMIC where a declination was added.
    heading_sigma_deg : float or None
        Largest of the record.
    """

    kind: str
    source: str
    card: str
    path: str
    rows: int
    columns: tuple[str, ...]
    reference: str | None
    heading_sigma_deg: float | None
    warnings: tuple[ResultWarning, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "schema": "surveyapp.compensate/1",
            "kind": self.kind,
            "source": self.source,
            "card": self.card,
            "path": self.path,
            "rows": self.rows,
            "columns": list(self.columns),
            "reference": self.reference,
            "heading_sigma_deg": self.heading_sigma_deg,
            "warnings": [item.to_dict() for item in self.warnings],
        }


def compensate_log(
    kind: str,
    file: LogFile,
    card_path: Path,
    *,
    entry: SensorLogEntry | None = None,
    today: date | None = None,
    declination: Declination | None = None,
    progress: PartDone | None = None,
) -> tuple[Iterator[Compensated], SensorLog, SensorCard]:
    """Correct a log by a card, block by block.

    Parameters
    ----------
    kind : str
        compass, tilt or rate.
    file : LogFile
    card_path : Path
    entry : SensorLogEntry or None
        Its ``calibrated_on`` is the day of the record, where it is stated.
    today : datetime.date or None
        Day of a record whose day nobody stated.
    declination : Declination or None
    progress : callable, optional

    Raises
    ------
    SurveyError
        If the card does not hold for this record, and for what is wrong with the log.
    """
    if kind not in KINDS:
        raise SurveyError(
            Problem("nothing of this kind is compensated", "compensate", kind,
                    hint=nearest_names(kind, KINDS))
        )  # fmt: skip
    where = str(card_path)
    card = read_sensor_card(card_path, where=where)
    if card.kind != kind:
        raise SurveyError(Problem("the card is of another kind", where, card.kind, kind))
    if declination is not None and kind != "compass":
        found = said("a {kind} sensor", kind=kind)
        raise SurveyError(
            Problem("a declination is added to magnetic headings only", "declination", found)
        )
    log = file.read(_need(kind, file, card, entry), progress=stage(progress, 0.0, READING))
    if kind == "rate":
        log = without_adopted(log, entry)
    elif entry is not None and entry.effects:
        log, done = without_events(log, entry.effects, room=room_for)
        log = replace(log, warnings=(*log.warnings, *done))
    day = entry.calibrated_on if entry is not None and entry.calibrated_on else today
    problems = card.refusals(on=day, temperature_c=log.temperature_span_c(), where=where)
    problems += other_instrument(card, entry, where)
    if problems:
        raise SurveyError(problems)
    doubts = list(card.warnings)
    if kind == "compass":
        doubts += compass_doubts(log, card, where=where)
    elif kind == "tilt":
        doubts += tilt_doubts(log, card)
    log = replace(log, warnings=(*log.warnings, *doubts))
    few = log.every(max(log.size // FORCE_ROWS, 1))
    if declination is not None and declination.sigma is None:
        declination = replace(declination, sigma=unstated_sigma(few))
        told = told_unstated(declination.sigma or 0.0)
        log = replace(log, warnings=(*log.warnings, told))
    noise = force_sigma(few.vector("acc")) if kind == "compass" else 0.0
    rest = (declination, where, noise)
    return _parts(kind, log, card, (rest, stage(progress, READING, 1.0))), log, card


def _parts(
    kind: str, log: SensorLog, card: SensorCard, more: tuple[_Rest, PartDone | None]
) -> Iterator[Compensated]:
    """The corrected log block by block; what was written is told."""
    rest, progress = more
    done = 0
    for block in log.pieces(BLOCK_ROWS):
        yield _run(kind, block, card, rest)
        done += block.size
        if progress is not None:
            progress(done / log.size)


def _need(kind: str, file: LogFile, card: SensorCard, entry: SensorLogEntry | None) -> Need:
    if kind == "compass":
        acc = ACC if file.has(*ACC) else ()
        return Need(columns=(*MAG, *acc), optional=("temperature_c",))
    if kind == "rate":
        stops = entry.effects if entry is not None else ()
        optional = (*ACC, *TABLE_COLUMNS, "position") if stops else ("temperature_c",)
        return need_with_adopted(Need(columns=GYR, optional=optional), entry)
    columns = ("output",) if card.get("sensitivity") is not None else TILT
    return Need(columns=columns, optional=("temperature_c",), timed="optional")


def _run(kind: str, log: SensorLog, card: SensorCard, rest: _Rest) -> Compensated:
    declination, where, noise = rest
    if kind == "compass":
        return compensate_compass(
            log, card, declination=declination, where=where, force_noise=noise
        )
    if kind == "rate":
        return compensate_rate(log, card, where=where)
    if card.get("sensitivity") is not None:
        return compensate_head(log, card, where=where)
    return compensate_tilt(log, card, where=where)


def other_instrument(card: SensorCard, entry: SensorLogEntry | None, where: str) -> list[Problem]:
    """The card is of another instrument than the log, where both say whose they are."""
    if entry is None:
        return []
    problems = []
    for key, own in (("instrument", entry.instrument), ("serial", entry.serial)):
        stated = card.extra.get(key)
        if stated is not None and own is not None and str(stated) != own:
            what = "the card is of another instrument"
            problems.append(Problem(what, where, str(stated), f"{key} {own}"))
    return problems


def write_compensated(
    parts: Iterable[Compensated],
    log: SensorLog,
    card: SensorCard,
    *,
    kind: str,
    card_path: str,
    out: Path,
) -> CompensationResult:
    """Write the corrected columns and say what was written.

    Raises
    ------
    SurveyError
        If the file cannot be written.
    """
    names: list[str] = []
    references: list[str | None] = []
    sigmas: list[float] = []

    def columns() -> Iterator[Columns]:
        for part in parts:
            names[:] = part.columns
            references.append(part.reference)
            if part.heading_sigma_deg is not None:
                sigmas.append(part.heading_sigma_deg)
            yield part.columns

    write_parts(out, columns())
    warnings = list(log.warnings)
    span = log.temperature_span_c()
    if card.temperature_c is not None and span is None:
        text = "the log holds no temperature: whether the card holds was not judged by it"
        warnings.append(ResultWarning("temperature_unknown", text))
    if kind == "compass" and not log.has(*ACC):
        text = "no specific force: the headings are taken as level, not tilt-compensated"
        warnings.append(ResultWarning("not_tilt_compensated", text))
    if "restricted" in card.notes:
        warnings.append(
            ResultWarning("restricted", said("the card {value}", value=card.notes["restricted"]))
        )
    return CompensationResult(
        kind=kind,
        source=log.id,
        card=card_path,
        path=str(out),
        rows=log.size,
        columns=tuple(names),
        reference=references[0] if references else None,
        heading_sigma_deg=max(sigmas, default=None),
        warnings=tuple(warnings),
    )
