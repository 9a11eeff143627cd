"""Points as LandXML 1.2: units, application and CgPoints.

Source: LandXML-1.2 schema: the text of a CgPoint is north, east and, where known, elevation.
"""

from __future__ import annotations

from datetime import datetime
from xml.sax.saxutils import quoteattr

from surveyapp.domain.exported import ExportedSurvey, Written


def landxml_text(survey: ExportedSurvey, *, software: str, now: datetime) -> Written:
    """Points of a survey with their coordinates to 0.1 mm.

    Parameters
    ----------
    survey : ExportedSurvey
    software : str
        Name and version of this program.
    now : datetime
        Moment of writing, which the schema demands.
    """
    name, _, version = software.partition(" ")
    stamp = f'date="{now:%Y-%m-%d}" time="{now:%H:%M:%S}"'
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" '
        f'version="1.2" {stamp} language="English" readOnly="false">',
        '<Units><Metric linearUnit="meter" areaUnit="squareMeter" volumeUnit="cubicMeter" '
        'temperatureUnit="celsius" pressureUnit="HPA" angularUnit="decimal dd.mm.ss" '
        'directionUnit="decimal dd.mm.ss"/></Units>',
        f"<Project name={quoteattr(survey.name or 'survey')}/>",
        f"<Application name={quoteattr(name)} version={quoteattr(version)}/>",
        "<CgPoints>",
    ]
    if survey.crs and "\n" not in survey.crs:
        system = f"<CoordinateSystem name={quoteattr(survey.crs)}/>"
        lines.insert(3, system)
    for point in survey.points:
        height = "" if point.h is None else f" {point.h:.4f}"
        place = f"{point.n:.4f} {point.e:.4f}{height}"
        lines.append(f"<CgPoint name={quoteattr(point.name)}>{place}</CgPoint>")
    lines += ["</CgPoints>", "</LandXML>", ""]
    return Written("\n".join(lines), len(survey.points))
