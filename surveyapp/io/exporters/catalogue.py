"""Every format in which a survey is handed to other programs: one line each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from typing import Final

from surveyapp.domain.exported import ExportedSurvey, Written
from surveyapp.io.exporters.dxf import dxf_text
from surveyapp.io.exporters.landxml import landxml_text
from surveyapp.io.exporters.maps import geojson_text, kml_text
from surveyapp.io.exporters.pointfiles import gsi_text, sdr_text
from surveyapp.io.exporters.starnet import starnet_text
from surveyapp.languages import said


@dataclass(frozen=True, slots=True)
class Stamp:
    """Who writes and when, for formats that want to know."""

    software: str
    now: datetime


@dataclass(frozen=True, slots=True)
class Exporter:
    """One format: its name, what it is, the usual ending, and what writes it.

    ``write`` is None where no survey is written but results, a network or the whole project: what
    makes these stands in ``surveyapp.api`` under ``export_<id>``.
    """

    id: str
    title: str
    ending: str
    write: Callable[[ExportedSurvey, Stamp], Written] | None = None


def _landxml(survey: ExportedSurvey, stamp: Stamp) -> Written:
    return landxml_text(survey, software=stamp.software, now=stamp.now)


EXPORTERS: Final[tuple[Exporter, ...]] = (
    Exporter("csv", said("results as a table"), ".csv"),
    Exporter("gkf", said("traverses as a GNU Gama network"), ".gkf"),
    Exporter("json", said("result with cards, rule book and hashes, for a later compare"), ".json"),
    Exporter("gsi", said("points as Leica GSI-16"), ".gsi", lambda survey, _: gsi_text(survey)),
    Exporter("sdr", said("points as Sokkia SDR33"), ".sdr", lambda survey, _: sdr_text(survey)),
    Exporter(
        "starnet",
        said("points and observations as STAR*NET input"),
        ".dat",
        lambda survey, _: starnet_text(survey),
    ),
    Exporter("dxf", said("a drawing, DXF R12"), ".dxf", lambda survey, _: dxf_text(survey)),
    Exporter("landxml", said("points as LandXML 1.2"), ".xml", _landxml),
    Exporter(
        "kml", said("stations and lines for maps, KML"), ".kml", lambda survey, _: kml_text(survey)
    ),
    Exporter(
        "geojson",
        said("stations and lines for maps, GeoJSON"),
        ".geojson",
        lambda survey, _: geojson_text(survey),
    ),
    Exporter("zip", said("the whole project for hand-over"), ".zip"),
)
"""Every format, in the order of the help."""
