"""Traverse and gyro sheets as CSV and HTML for scripts, re-exported by ``surveyapp.api``."""

from __future__ import annotations

from pathlib import Path

from surveyapp.api.network import adjust
from surveyapp.api.orientation import Source, compute
from surveyapp.api.project import SOFTWARE, Folder
from surveyapp.errors import SurveyError
from surveyapp.languages import in_language, said
from surveyapp.report.written import SheetsResult


def _file_part(identity: str, taken: set[str]) -> str:
    """Part of a file name, each of its own also where capitals do not count."""
    base = "".join(c if c.isalnum() or c in "-_." else "_" for c in identity)
    name, number = base, 1
    while name.casefold() in taken:
        number += 1
        name = f"{base}-{number}"
    taken.add(name.casefold())
    return name


def write_sheets(source: Source, output: Folder, *, language: str = "en") -> SheetsResult:
    """Write the sheets of a project beside a record, as CSV and as HTML.

    Parameters
    ----------
    source : Project, path or Computed
    output : path
        Of the record: ``record.pdf`` has ``record-gyro.csv``, ``record-traverse-main.html`` ...
    language : str
        Of the HTML: ``en``, ``de``, ``ru`` or ``zh``; the CSV is English in every language.

    Returns
    -------
    SheetsResult

    Raises
    ------
    SurveyError
        If the project cannot be used or a file not be written.
    """
    from surveyapp.io.outputs import write_output
    from surveyapp.report.sheets import gyro_sheet, sheet_csv, sheet_html, traverse_sheet

    found = compute(source)
    unit = found.project.angle_unit
    sheets = [gyro_sheet(found.result, unit)] if found.result.lines else []
    problems = []
    for traverse in found.project.traverses:
        try:
            result = adjust(found, traverse=traverse.name)
        except SurveyError as error:
            problems.append(said("traverse {name}: {text}", name=traverse.name, text=error.text))
            continue
        sheets.append(traverse_sheet(traverse.name, result, unit))
    paths = []
    base = Path(output)
    taken: set[str] = set()
    for sheet in sheets:
        name = _file_part(sheet.id, taken)
        with in_language(language):
            page = sheet_html(sheet, project=found.project.name, software=SOFTWARE)
        for ending, text in ((".csv", sheet_csv(sheet)), (".html", page)):
            path = base.with_name(f"{base.stem}-{name}{ending}")
            write_output(path, text.encode("utf-8"))
            paths.append(str(path))
    return SheetsResult(tuple(paths), tuple(problems))
