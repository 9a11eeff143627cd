"""Every field format that can be read: one line each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import FieldFile
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.files import shown
from surveyapp.io.importers.fieldfiles.gathering import ReadOptions
from surveyapp.io.importers.fieldfiles.gsi import read_gsi
from surveyapp.io.importers.fieldfiles.gyrocsv import GyroFile, read_gyro_csv
from surveyapp.io.importers.fieldfiles.jobxml import read_jobxml
from surveyapp.io.importers.fieldfiles.sdr import read_sdr
from surveyapp.io.importers.fieldfiles.tablecsv import read_csv


@dataclass(frozen=True, slots=True)
class Importer:
    """One format, and what reads it: pointings of a total station, or azimuths of a gyro.

    Parameters
    ----------
    id : str
        As typed after ``surveyapp import``.
    title : str
        What it is; stands in the help and in the reference.
    endings : tuple of str
        Usual endings of its files; a file chooser takes the first format that has an ending.
    pointings : callable or None
        From the file to its pointings.
    azimuths : callable or None
        From the file to azimuths of an automatic gyro; one of the two is given.
    """

    id: str
    title: str
    endings: tuple[str, ...]
    pointings: Callable[[Path, ReadOptions], FieldFile] | None = None
    azimuths: Callable[[Path, ReadOptions], GyroFile] | None = None


IMPORTERS: Final[tuple[Importer, ...]] = (
    Importer("gsi", "Leica GSI-8 and GSI-16", (".gsi", ".gsi8", ".gsi16"), read_gsi),
    Importer("sdr", "Sokkia SDR33 and SDR20", (".sdr", ".sdr33", ".sdr20"), read_sdr),
    Importer("jobxml", "Trimble JobXML", (".jxl", ".jobxml"), read_jobxml),
    Importer(
        "csv",
        "a table of pointings, its columns told by map and unit",
        (".csv", ".txt", ".tsv"),
        read_csv,
    ),
    Importer(
        "gyro-csv",
        "a table of azimuths of an automatic gyro, told by map and unit",
        (".csv",),
        azimuths=read_gyro_csv,
    ),
)
"""Every format, in the order of the help."""


def importer_of(form: str) -> Importer:
    """The importer of a format.

    Raises
    ------
    SurveyError
        For a format that is not known.
    """
    found = next((item for item in IMPORTERS if item.id == form), None)
    if found is None:
        hint = nearest_names(form, [item.id for item in IMPORTERS])
        raise SurveyError(Problem("there is no such format", "import", shown(form), "", hint))
    return found
