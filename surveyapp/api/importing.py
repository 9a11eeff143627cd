"""Field files into projects and out of them for scripts, re-exported by ``surveyapp.api``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path

from surveyapp.api.project import SOFTWARE, Folder, open_project
from surveyapp.domain.fieldfile import ImportResult
from surveyapp.domain.filing import ExportResult
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import told_about
from surveyapp.errors import Problem, SurveyError, nearest_names


def import_file(
    form: str,
    file: Folder,
    folder: Folder,
    *,
    traverse: str | None = None,
    instrument: str | None = None,
    station_code: str | None = None,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    fixed: Sequence[str] = (),
    sigma_angle_arcsec: float | None = None,
    sigma_distance: tuple[float, float] | None = None,
    skip_damaged: bool = False,
    lines: tuple[int, int] | None = None,
    preview: bool = False,
    progress: Callable[[float], None] | None = None,
) -> ImportResult:
    """Read a field file of another program into a project: all of it or nothing.

    Parameters
    ----------
    form : str
        One of ``surveyapp import --help``: ``gsi``, ``csv``, ``gyro-csv`` ...
    file, folder : path
        The file, and the project folder.
    traverse : str or None
        Name of the traverse and its book; the name of the file without it.
    instrument : str or None
        Of azimuths of a gyro: its id.
    station_code : str or None
        ``gsi``: code of the blocks that open a station.
    columns, units : mapping or None
        ``csv`` and ``gyro-csv``: column and unit of each quantity; ``foot`` = ``us``.
    fixed : sequence of str
        New stations that are fixed at the coordinates of the file.
    sigma_angle_arcsec : float or None
        Standard deviation of an angle; estimated from the faces, or assumed and told, without it.
    sigma_distance : tuple of float or None
        Millimetres and ppm.
    skip_damaged : bool
        Leave damaged lines out and list them.
    lines : tuple of int or None
        First and last line whose readings are taken: a large file in parts.
    preview : bool
        Say what would be written, write nothing.
    progress : callable or None
        Told from time to time which part has been read.

    Returns
    -------
    ImportResult

    Raises
    ------
    SurveyError
        Every damaged line; a book of that name; whatever else is wrong. Nothing is written then.
    """
    from surveyapp.io.importers.fieldfiles.catalogue import importer_of
    from surveyapp.io.importers.fieldfiles.gathering import ReadOptions
    from surveyapp.io.importing.gyro import plan_gyro
    from surveyapp.io.importing.traverse import ImportOptions, plan_traverse
    from surveyapp.io.importing.writing import write_additions

    importer = importer_of(form)
    project = open_project(folder)
    read = ReadOptions(skip_damaged, station_code, columns or {}, units or {}, progress, lines)
    options = ImportOptions(traverse, tuple(fixed), sigma_angle_arcsec, sigma_distance, read)
    if importer.azimuths is None:
        planned = plan_traverse(project, form, Path(file), options)
    elif instrument is None:
        raise SurveyError(
            Problem("the gyro is not named", "instrument", "", "the id of an instrument")
        )
    else:
        planned = plan_gyro(project, form, Path(file), options, instrument=instrument)
    if importer.azimuths is None:
        subject = Subject.of("traverse", planned.result.traverse)
    else:
        subject = Subject.of("instrument", instrument or "")
    result = told_about(planned.result, subject)
    if preview:
        return result
    write_additions(Path(folder), planned.additions)
    return replace(result, written=True)


def _local_now() -> datetime:
    return datetime.now().astimezone()


def export_survey(
    form: str,
    folder: Folder,
    output: Folder,
    *,
    now: Callable[[], datetime] = _local_now,
) -> ExportResult:
    """Write points, observations and lines of a project for another program.

    Parameters
    ----------
    form : str
        One of ``surveyapp export --help`` that holds a survey: ``gsi``, ``landxml``, ``kml`` ...
    folder, output : path
        The project, and the file to be written.
    now : callable
        Clock, for formats that demand a moment.

    Returns
    -------
    ExportResult
        ``warnings`` tell what was left out.

    Raises
    ------
    SurveyError
        If the project cannot be read, or the format has no words for something in it.
    """
    from surveyapp.api.network import network
    from surveyapp.io.exporters.catalogue import EXPORTERS, Stamp
    from surveyapp.io.importing.writing import sha256
    from surveyapp.io.outputs import write_output
    from surveyapp.workflows.exporting import exported_survey

    writers = {item.id: item.write for item in EXPORTERS if item.write is not None}
    if form not in writers:
        hint = nearest_names(form, writers)
        raise SurveyError(Problem("there is no such format", "export", form, "", hint))
    project = open_project(folder)
    survey = exported_survey(project, network(project) if project.traverses else None)
    written = writers[form](survey, Stamp(SOFTWARE, now()))
    data = written.text.encode("utf-8")
    write_output(Path(output), data)
    warnings = (*survey.warnings, *written.warnings)
    result = ExportResult(form, str(output), written.items, sha256(data), warnings)
    return told_about(result, Subject.project())
