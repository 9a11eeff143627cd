"""What scripts call for the office: records, forms; re-exported by ``surveyapp.api``.

A module of its own, because the reduction is one subject and what is filed another.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp import __version__
from surveyapp.domain.project import Project

if TYPE_CHECKING:
    from surveyapp.report.blocks import Document
    from surveyapp.report.record import Extra
    from surveyapp.report.written import ReportResult

Folder = str | os.PathLike[str]

SOFTWARE = f"surveyapp {__version__}"


def report(
    project: Project | Folder,
    output: Folder,
    *,
    font: Folder | None = None,
    extras: tuple[Extra, ...] = (),
) -> ReportResult:
    """Write the survey record as PDF; the same input gives the same bytes.

    Parameters
    ----------
    project : Project or path
    output : path
        PDF to be written, whole or not at all.
    font : path or None
        TrueType face for Chinese, Japanese and Korean; None: one found on the system, else the
        faces that PDF viewers bring.
    extras : tuple of surveyapp.report.record.Extra
        Sections from elsewhere, before the checks.

    Raises
    ------
    SurveyError
        If the project cannot be used, the face cannot be embedded or the file not be written.
    """
    document, sections = _record(project, extras)
    return _write_document(document, sections, Path(output), font)


def report_text(project: Project | Folder) -> str:
    """The survey record as text for a terminal."""
    from surveyapp.report.text import document_text

    return document_text(_record(project, ())[0])


def blank_form(method: str, output: Folder, *, font: Folder | None = None) -> ReportResult:
    """Write a blank field-book form (tracking, amplitude, transit, automatic) as PDF.

    Raises
    ------
    SurveyError
        If there is no such method, or the file cannot be written.
    """
    from surveyapp.report.forms import blank_form as form

    return _write_document(form(method, software=SOFTWARE), (method,), Path(output), font)


def _record(
    project: Project | Folder, extras: tuple[Extra, ...]
) -> tuple[Document, tuple[str, ...]]:
    from surveyapp import api
    from surveyapp.io.project_checks import project_rule_book
    from surveyapp.report.record import Record, record_document

    if not isinstance(project, Project):
        project = api.open_project(project)
    result = api.orient(project)
    return record_document(Record(project, result, project_rule_book(project), extras=extras))


def _write_document(
    document: Document, sections: tuple[str, ...], output: Path, font: Folder | None
) -> ReportResult:
    from surveyapp.io.tomltext import atomic_write
    from surveyapp.report.pdf import write_pdf
    from surveyapp.report.written import ReportResult

    written = write_pdf(document, face=None if font is None else Path(font))
    atomic_write(output, written.data)
    digest = hashlib.sha256(written.data).hexdigest()
    return ReportResult(str(output), written.pages, sections, digest)
