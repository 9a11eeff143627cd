"""What scripts call for the office, re-exported by ``surveyapp.api``: records, closing, exports.

A module of its own, because the reduction is one subject and what is filed another.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.api.closing import no_password, secret_of
from surveyapp.api.judgement import diagnose, subjects
from surveyapp.api.network import adjust, network
from surveyapp.api.orientation import Source, compute, orient
from surveyapp.api.project import SOFTWARE, Folder
from surveyapp.domain.advance import Advance, silent
from surveyapp.errors import SurveyError
from surveyapp.languages import in_language, said

if TYPE_CHECKING:
    from surveyapp.core.differences import Snapshot
    from surveyapp.domain.filing import ComparisonResult, ExportResult
    from surveyapp.domain.project import Project
    from surveyapp.report.blocks import Block, Document
    from surveyapp.report.record import Extra
    from surveyapp.report.written import ReportResult
    from surveyapp.workflows.computing import Computed


def report(
    source: Source,
    output: Folder,
    *,
    font: Folder | None = None,
    extras: tuple[Extra, ...] = (),
    diagnosis: bool = False,
    language: str = "en",
    key: Folder | None = None,
    password: Callable[[], str] = no_password,
    advance: Advance = silent,
) -> ReportResult:
    """Write the survey record as PDF; the same input gives the same bytes.

    Parameters
    ----------
    source : Project, path or Computed
    output : path
        PDF to be written, whole or not at all.
    font : path or None
        TrueType face for Chinese, Japanese and Korean; None: one found on the system, else the
        faces that PDF viewers bring.
    extras : tuple of surveyapp.report.record.Extra
        Sections from elsewhere, before the checks.
    diagnosis : bool
        Diagnose every run and campaign of the project and show what was found.
    language : str
        Of the record: en | de | ru | zh.
    key : path or None
        Secret key in the format of minisign; the signature stands beside the PDF then.
    password : callable
        Asked for the password of an encrypted key.
    advance : callable
        Told how far it is.

    Raises
    ------
    SurveyError
        If the project cannot be used, the face cannot be embedded or the file not be written.
    """
    secret = None if key is None else secret_of(key, password)
    found = compute(source, advance=advance)
    if diagnosis:
        extras = (*extras, *_diagnoses(found, advance))
    document, sections = _record(found, extras)
    with in_language(language):
        made = _write_document(document, sections, Path(output), font, advance=advance)
    if secret is None:
        return made
    from surveyapp.io.filing.signatures import sign_file

    path = Path(made.path)
    return replace(made, signature=sign_file(path, path.read_bytes(), secret))


def _traverses(found: Computed) -> tuple[Extra, ...]:
    """A section for every traverse; one that cannot be adjusted says why."""
    from surveyapp.report.blocks import Heading, Paragraph
    from surveyapp.report.record import Extra
    from surveyapp.report.sections import traverse as section

    extras = []
    for traverse in found.project.traverses:
        identity = f"traverse {traverse.name}"
        try:
            result = adjust(found, traverse=traverse.name)
        except SurveyError as error:
            reasons = [Paragraph(problem.text, "warning") for problem in error.problems]
            extras.append(Extra(identity, (Heading(f"Traverse {traverse.name}"), *reasons)))
            continue
        made = section.blocks(traverse.name, result, unit=found.project.angle_unit)
        extras.append(Extra(identity, made))
    return tuple(extras)


def _shafts(found: Computed) -> tuple[Extra, ...]:
    """A section for the shafts; what cannot be oriented says why."""
    from surveyapp.api.shafts import shaft
    from surveyapp.report.record import Extra
    from surveyapp.report.sections import shafts as section

    if found.project.shafts is None:
        return ()
    try:
        made = section.blocks(shaft(found.project), unit=found.project.angle_unit)
    except SurveyError as error:
        made = _refused("Shafts", error)
    return (Extra("shafts", made),)


def _breakthrough(found: Computed) -> tuple[Extra, ...]:
    """A section for the breakthrough; one that cannot be predicted says why."""
    from surveyapp.api.penetration import predict
    from surveyapp.report.record import Extra
    from surveyapp.report.sections import penetration as section

    if found.project.penetration is None:
        return ()
    try:
        made = section.blocks(predict(found))
    except SurveyError as error:
        made = _refused("Breakthrough", error)
    return (Extra("breakthrough", made),)


def _refused(title: str, error: SurveyError) -> tuple[Block, ...]:
    """A section that says why there is nothing in it."""
    from surveyapp.report.blocks import Heading, Paragraph

    return (Heading(title), *(Paragraph(p.text, "warning") for p in error.problems))


def _diagnoses(found: Computed, advance: Advance) -> tuple[Extra, ...]:
    """A section for every subject that can be diagnosed; too few observations are passed over."""
    from surveyapp.report.record import Extra
    from surveyapp.report.sections import diagnosis as section

    unit = found.project.angle_unit
    extras = []
    chosen = subjects(found)
    for place, (option, identity) in enumerate(chosen):
        advance("subjects diagnosed", place, len(chosen))
        try:
            if option == "session":
                made = diagnose(found, session=identity, log=False)
            elif option == "traverse":
                made = diagnose(found, traverse=identity, log=False)
            else:
                made = diagnose(found, campaign=identity, log=False)
        except SurveyError:
            continue
        if made.diagnosis is None:
            continue
        shown = {name: (before, after) for name, before, after in made.channels}
        made_blocks = section.blocks(made.diagnosis, made.words, shown, unit=unit)
        extras.append(Extra(f"diagnosis of {identity}", made_blocks))
    return tuple(extras)


def report_text(source: Source, *, language: str = "en") -> str:
    """The survey record as text for a terminal, in one of the languages en, de, ru, zh."""
    from surveyapp.report.text import document_text

    document = _record(compute(source), ())[0]
    with in_language(language):
        return document_text(document)


def blank_form(
    method: str, output: Folder, *, font: Folder | None = None, language: str = "en"
) -> ReportResult:
    """Write a blank field-book form (tracking, amplitude, transit, automatic) as PDF.

    Raises
    ------
    SurveyError
        If there is no such method, or the file cannot be written.
    """
    from surveyapp.report.forms import blank_form as form

    document = form(method, software=SOFTWARE)
    with in_language(language):
        return _write_document(document, (method,), Path(output), font)


def _record(found: Computed, extras: tuple[Extra, ...]) -> tuple[Document, tuple[str, ...]]:
    from surveyapp.api.sensor_record import sensor_sections
    from surveyapp.io.files import visible
    from surveyapp.report.record import Record, SealShown, record_document

    extras = (
        *_shafts(found),
        *_traverses(found),
        *_breakthrough(found),
        *sensor_sections(found),
        *extras,
    )
    seals = tuple(
        SealShown(item.at, visible(item.by), item.head, item.seal, visible(item.session))
        for item in found.project.filing.closings
    )
    return record_document(Record(found.project, found.result, found.project.rules, seals, extras))


def undrawn_text(project: Project) -> str:
    """What the record cannot print as it is written, in words; empty where it prints all.

    Asked before a record is signed: names of project, stations and sessions, observers and notes.
    """
    from surveyapp.report.pdf.fonts import undrawn
    from surveyapp.report.written import missing_text

    texts = [project.name, *(station.name for station in project.stations)]
    for session in project.sessions:
        texts += [session.id, session.observer or "", *(row.note for row in session.book.rows)]
    missing = undrawn(texts)
    return missing_text(missing) if missing else ""


def _write_document(
    document: Document,
    sections: tuple[str, ...],
    output: Path,
    font: Folder | None,
    *,
    advance: Advance = silent,
) -> ReportResult:
    from surveyapp.io.outputs import write_output
    from surveyapp.report.pdf import write_pdf
    from surveyapp.report.written import ReportResult

    written = write_pdf(document, face=None if font is None else Path(font), advance=advance)
    write_output(output, written.data)
    digest = hashlib.sha256(written.data).hexdigest()
    return ReportResult(
        str(output),
        written.pages,
        sections,
        digest,
        written.missing,
        referred=written.referred,
    )


def export_zip(folder: Folder, output: Folder, *, allow_outside: bool = False) -> ExportResult:
    """Write a project as one zip file for hand-over: same project, same bytes.

    Parameters
    ----------
    folder, output : path
    allow_outside : bool
        Whether sensor logs that lie outside of the folder, pinned by their sha256, are packed too.

    Raises
    ------
    SurveyError
        If the folder is no project folder, or a file cannot be read or is another than the pinned.
    """
    from surveyapp.domain.warning import ResultWarning
    from surveyapp.io.exporters.archive import archive, logs_outside

    data, count = archive(Path(folder), allow_outside=allow_outside)
    made = _write_export("zip", data, Path(output), count)
    left = () if allow_outside else logs_outside(Path(folder))
    if not left:
        return made
    text = said(
        "{size} sensor logs outside of the folder are not packed: --allow-outside does",
        size=len(left),
    )
    return replace(made, warnings=(ResultWarning("logs_outside", text),))


def export_csv(source: Source, output: Folder, *, table: str = "lines") -> ExportResult:
    """Write a table of the results as CSV (lines, sessions, constants, checks, all)."""
    from surveyapp.io.exporters.results_csv import results_csv

    text, count = results_csv(orient(source), table)
    return _write_export("csv", text.encode("utf-8"), Path(output), count)


def export_gkf(source: Source, output: Folder) -> ExportResult:
    """Write the traverses of a project, gyro sides included, as a GNU Gama file.

    Raises
    ------
    SurveyError
        If there is no traverse, or the format has no words for something in it.
    """
    from dataclasses import replace

    from surveyapp.core.network.setups import without_setup_blocks
    from surveyapp.io.exporters.gkf import gkf_text

    found, warnings = without_setup_blocks(network(source))
    data = gkf_text(found).encode("utf-8")
    result = _write_export("gkf", data, Path(output), len(found.observations))
    return replace(result, warnings=warnings)


def export_json(source: Source, output: Folder) -> ExportResult:
    """Write the result with its files, cards and rule book, for a later ``compare``."""
    snapshot = _snapshot(source)
    data = json.dumps(snapshot.to_dict(), ensure_ascii=False, indent=1, allow_nan=False) + "\n"
    return _write_export("json", data.encode("utf-8"), Path(output), len(snapshot.files or ()))


def _write_export(name: str, data: bytes, output: Path, items: int) -> ExportResult:
    from surveyapp.domain.filing import ExportResult
    from surveyapp.io.outputs import write_output

    write_output(output, data)
    return ExportResult(name, str(output), items, hashlib.sha256(data).hexdigest())


def compare(a: Folder, b: Folder) -> ComparisonResult:
    """Tell what changed between two results: input, software, card, rule book, numbers.

    Parameters
    ----------
    a, b : path
        Project folders, or files of ``orient --json`` and ``export json``.

    Raises
    ------
    SurveyError
        If one of them cannot be used.
    """
    from surveyapp.core.differences import compare_snapshots

    return compare_snapshots(_side(Path(a)), _side(Path(b)))


def _side(path: Path) -> Snapshot:
    from surveyapp.io.filing.snapshots import read_snapshot

    return read_snapshot(path) if path.is_file() else _snapshot(path)


def _snapshot(source: Source) -> Snapshot:
    from surveyapp.io.filing.snapshots import folder_snapshot

    found = compute(source)
    return folder_snapshot(found.project, found.result, found.project.rules)
