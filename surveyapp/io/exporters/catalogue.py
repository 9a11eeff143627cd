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


@dataclass(frozen=True, slots=True)
class Stamp:
    """Who writes and when, for formats that want to know."""

    software: str
    now: datetime


@dataclass(frozen=True, slots=True)
class Exporter:
    """One format: its name, what it is, the usual ending, and what writes it."""

    id: str
    title: str
    ending: str
    write: Callable[[ExportedSurvey, Stamp], Written]


def _landxml(survey: ExportedSurvey, stamp: Stamp) -> Written:
    return landxml_text(survey, software=stamp.software, now=stamp.now)


EXPORTERS: Final[tuple[Exporter, ...]] = (
    Exporter("gsi", "points as Leica GSI-16", ".gsi", lambda survey, _: gsi_text(survey)),
    Exporter("sdr", "points as Sokkia SDR33", ".sdr", lambda survey, _: sdr_text(survey)),
    Exporter("starnet", "STAR*NET input", ".dat", lambda survey, _: starnet_text(survey)),
    Exporter("dxf", "a drawing, DXF R12", ".dxf", lambda survey, _: dxf_text(survey)),
    Exporter("landxml", "points as LandXML 1.2", ".xml", _landxml),
    Exporter("kml", "stations and lines for maps, KML", ".kml", lambda survey, _: kml_text(survey)),
    Exporter("geojson", "stations and lines, GeoJSON", ".geojson", lambda s, _: geojson_text(s)),
)
"""Formats made of an ``ExportedSurvey``; csv, json, zip and gkf are made elsewhere."""
