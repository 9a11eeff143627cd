"""Every field format that can be read: one line each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import FieldFile
from surveyapp.io.importers.fieldfiles.gathering import ReadOptions
from surveyapp.io.importers.fieldfiles.gsi import read_gsi
from surveyapp.io.importers.fieldfiles.jobxml import read_jobxml
from surveyapp.io.importers.fieldfiles.sdr import read_sdr
from surveyapp.io.importers.fieldfiles.tablecsv import read_csv


@dataclass(frozen=True, slots=True)
class Importer:
    """One format: its name, what it is, the usual endings, and what reads it."""

    id: str
    title: str
    endings: tuple[str, ...]
    read: Callable[[Path, ReadOptions], FieldFile]


IMPORTERS: Final[tuple[Importer, ...]] = (
    Importer("gsi", "Leica GSI-8 and GSI-16", (".gsi", ".gsi8", ".gsi16"), read_gsi),
    Importer("sdr", "Sokkia SDR33 and SDR20", (".sdr", ".sdr33", ".sdr20"), read_sdr),
    Importer("jobxml", "Trimble JobXML", (".jxl", ".jobxml"), read_jobxml),
    Importer("csv", "a table with a map of its columns", (".csv", ".txt", ".tsv"), read_csv),
)
"""Traverse files by format; ``gyro-csv`` (azimuths of automatic gyros) is ``gyrocsv``."""
