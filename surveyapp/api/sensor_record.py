"""Sections of the record on sensor logs: what each is for decides what is printed of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from surveyapp.errors import SurveyError
from surveyapp.languages import said

if TYPE_CHECKING:
    from surveyapp.domain.calibration import Calibration
    from surveyapp.domain.motion import Motion
    from surveyapp.domain.north import NorthResult
    from surveyapp.domain.sensor_entry import SensorLogEntry
    from surveyapp.report.blocks import Block
    from surveyapp.report.record import Extra
    from surveyapp.workflows.computing import Computed


def sensor_sections(found: Computed) -> tuple[Extra, ...]:
    """A section for every sensor log of the folder; one that cannot be used says why."""
    from surveyapp.report.blocks import Heading, Paragraph
    from surveyapp.report.record import Extra
    from surveyapp.report.sections.sensor_results import adopted_blocks
    from surveyapp.report.sections.sensors import title_of

    extras = []
    used = _used(found)
    for entry in found.project.sensor_logs:
        try:
            body, verdict = used.get(entry.id) or _body(found.project.path, entry)
        except SurveyError as error:
            body = tuple(Paragraph(problem.text, "warning") for problem in error.problems)
            verdict = said("cannot be used: see its section")
        blocks = (Heading(title_of(entry.id)), *_note(entry), *body, *adopted_blocks(entry))
        extras.append(Extra(said("sensor log {identity}", identity=entry.id), blocks, verdict))
    return tuple(extras)


def _used(found: Computed) -> dict[str, tuple[tuple[Block, ...], str]]:
    """Logs that a session applies a card to: what they gave stands with the session.

    Such a log is no record for a calibration: it has no reference and need not vary.
    """
    from surveyapp.report.blocks import Paragraph

    told: dict[str, tuple[tuple[Block, ...], str]] = {}
    for session in found.project.sessions:
        for used in (session.levelling, session.pre_orientation):
            if used is not None:
                text = said(
                    "used by session {session} with card {card}; its result stands there",
                    session=session.id,
                    card=used.card,
                )
                before = told.get(used.log, ((), ""))
                told[used.log] = ((*before[0], Paragraph(text)), said("used by a session"))
    return told


def _note(entry: SensorLogEntry) -> tuple[Block, ...]:
    """By which procedure the log was made, where the project says so."""
    from surveyapp.report.blocks import Paragraph

    note = entry.options.get("note")
    return (Paragraph(note),) if isinstance(note, str) and note else ()


def _body(folder: str, entry: SensorLogEntry) -> tuple[tuple[Block, ...], str]:
    """Blocks, and what the first page says of them."""
    from surveyapp.workflows.motion import PROGRAMME

    if entry.options.get("method"):
        return _north(folder, entry)
    if entry.programme == PROGRAMME:
        return _motion(folder, entry)
    if entry.kind is None or (entry.kind == "rate" and entry.programme is None):
        return _noise(folder, entry)
    blocks, verdict = _calibration(folder, entry)
    return (*blocks, *_diagnosis(folder, entry)), verdict


def _noise(folder: str, entry: SensorLogEntry) -> tuple[tuple[Block, ...], str]:
    """Nothing to calibrate is stated: its noise is told."""
    from surveyapp.api.sensors import allan
    from surveyapp.report.sections.sensors import allan_blocks

    blocks = allan_blocks(entry.id, allan(folder, sensor=entry.id))[1:]
    return blocks, said("its noise is told, nothing is judged")


def _north(folder: str, entry: SensorLogEntry) -> tuple[tuple[Block, ...], str]:
    from surveyapp.api.rate import north
    from surveyapp.report.sections.sensor_results import north_blocks

    result = north(folder, sensor=entry.id)
    met = said("north is determined")
    blocks = (*north_blocks(result), *_pictures(result))
    return blocks, met if result.met else said("NOT MET: north is not determined")


def _motion(folder: str, entry: SensorLogEntry) -> tuple[tuple[Block, ...], str]:
    from surveyapp.api.rate import motion
    from surveyapp.report.sections.sensor_results import motion_blocks

    result = motion(folder, sensor=entry.id)
    blocks = (*motion_blocks(result), *_pictures(result))
    if result.met:
        return blocks, said("its state of motion is told, nothing is judged")
    return blocks, said("NOT MET: the motion contradicts itself, see its warnings")


def _pictures(result: Motion | NorthResult) -> tuple[Block, ...]:
    from surveyapp.api.sensor_files import sensor_pictures
    from surveyapp.report.sections.pictures import picture_blocks

    return picture_blocks(sensor_pictures(result).pictures)


def _calibration(folder: str, entry: SensorLogEntry) -> tuple[tuple[Block, ...], str]:
    from surveyapp.api.sensor_files import sensor_pictures
    from surveyapp.api.sensors import calibrate
    from surveyapp.report.sections.pictures import picture_blocks
    from surveyapp.report.sections.sensor_checks import HEADING_LIMIT_DEG, check_blocks
    from surveyapp.report.sections.sensors import calibration_blocks

    result = calibrate(entry.kind or "", folder, sensor=entry.id)
    stated = entry.options.get("heading_limit_deg")
    limit = float(stated) if isinstance(stated, int | float) else HEADING_LIMIT_DEG
    pictures = sensor_pictures(result, folder, sensor=entry.id).pictures
    blocks = (
        *calibration_blocks(entry.id, result)[1:],
        *check_blocks(result, heading_limit_deg=limit),
        *picture_blocks(pictures),
    )
    return blocks, _judged(result)


def _judged(result: Calibration) -> str:
    """A calibration in one line."""
    if result.geometry.verdict == "refused":
        return said("NOT MET: the calibration is refused, no card comes of it")
    if not result.met:
        return said("NOT MET: not determined or inconsistent, no card comes of it")
    if result.geometry.verdict == "restricted":
        return said("calibrated, restricted to tilts like those of the record")
    return said("calibrated")


def _diagnosis(folder: str, entry: SensorLogEntry) -> tuple[Block, ...]:
    """What the calibration lacks; a log that has no diagnosis has none here."""
    from surveyapp.api.sensor_diagnosis import diagnose_log, diagnose_sensor
    from surveyapp.report.sections.sensor_results import diagnosis_blocks

    try:
        if entry.kind in ("rate", "fog-station"):
            made = diagnose_sensor(folder, entry.id, log=False)
            return diagnosis_blocks(made.to_dict(), made.words)
        found = diagnose_log(folder, sensor=entry.id)
    except SurveyError:
        return ()
    return diagnosis_blocks(found.to_dict(), found.words)
