"""Stations and lines for maps: KML 2.2 and GeoJSON (RFC 7946), longitude before latitude.

Positions are those of the grid's own datum; a shift to WGS 84 is not applied, and that is told.
Heights of a mine are no ellipsoidal heights: they are properties, never altitudes.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from xml.sax.saxutils import escape

from surveyapp.domain.exported import ExportedPoint, ExportedSurvey, Written
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said


def _degrees(point: ExportedPoint) -> tuple[float, float] | None:
    """Longitude and latitude [degrees], nine decimals: 0.1 mm."""
    if point.latitude is None or point.longitude is None:
        return None
    return round(math.degrees(point.longitude), 9), round(math.degrees(point.latitude), 9)


def _placed(survey: ExportedSurvey) -> tuple[dict[str, tuple[float, float]], list[ResultWarning]]:
    places = {p.name: at for p in survey.points if (at := _degrees(p)) is not None}
    if not places:
        raise SurveyError(
            Problem(
                "no station has a place on the earth",
                "project.toml",
                "neither a crs with coordinates nor lat and lon",
                "a crs, or lat and lon of the stations",
            )
        )
    text = said(
        "positions are those of the grid's own datum{crs}: no shift to WGS 84 is applied, on old "
        "datums maps are some hundred metres off",
        crs=f" ({survey.crs})" if survey.crs and "\n" not in survey.crs else "",
    )
    warnings = [ResultWarning("datum", text)]
    lost = [p.name for p in survey.points if p.name not in places]
    if lost:
        left_out = said("no position on the earth: {names}", names=", ".join(lost))
        warnings.append(ResultWarning("station_left_out", left_out))
    return places, warnings


def _lines(
    survey: ExportedSurvey, places: dict[str, tuple[float, float]]
) -> Iterator[tuple[str, str, str]]:
    gyro = {frozenset(line) for line in survey.gyro}
    for a, b in survey.gyro:
        if a in places and b in places:
            yield "gyro", a, b
    for a, b in survey.sides:
        if a in places and b in places and frozenset((a, b)) not in gyro:
            yield "side", a, b


def geojson_text(survey: ExportedSurvey) -> Written:
    """Stations as points, sides and gyro lines as lines.

    Raises
    ------
    SurveyError
        If no station has a place on the earth.
    """
    places, warnings = _placed(survey)
    features: list[dict[str, object]] = []
    for point in survey.points:
        if point.name not in places:
            continue
        properties = {"name": point.name, "e": round(point.e, 4), "n": round(point.n, 4)}
        properties |= {"h": None if point.h is None else round(point.h, 4), "fixed": point.fixed}
        geometry = {"type": "Point", "coordinates": list(places[point.name])}
        features.append({"type": "Feature", "geometry": geometry, "properties": properties})
    for kind, a, b in _lines(survey, places):
        geometry = {"type": "LineString", "coordinates": [list(places[a]), list(places[b])]}
        named = {"name": f"{a}-{b}", "kind": kind}
        features.append({"type": "Feature", "geometry": geometry, "properties": named})
    document = {"type": "FeatureCollection", "features": features}
    text = json.dumps(document, ensure_ascii=False, indent=1, allow_nan=False) + "\n"
    return Written(text, len(features), tuple(warnings))


def kml_text(survey: ExportedSurvey) -> Written:
    """Stations as placemarks, sides and gyro lines as lines.

    Raises
    ------
    SurveyError
        If no station has a place on the earth.
    """
    places, warnings = _placed(survey)
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<kml xmlns="http://www.opengis.net/kml/2.2"><Document>',
        f"<name>{escape(survey.name)}</name>",
        f"<description>{escape(warnings[0].text)}</description>",
        '<Style id="gyro"><LineStyle><color>ffff0000</color><width>3</width></LineStyle></Style>',
        '<Style id="side"><LineStyle><color>ff808080</color><width>1</width></LineStyle></Style>',
    ]
    count = 0
    for point in survey.points:
        if point.name not in places:
            continue
        count += 1
        longitude, latitude = places[point.name]
        height = "" if point.h is None else f", h {point.h:.4f}"
        lines.append(
            f"<Placemark><name>{escape(point.name)}</name><description>e {point.e:.4f}, n "
            f"{point.n:.4f}{height}</description><Point><coordinates>{longitude:.9f},"
            f"{latitude:.9f}</coordinates></Point></Placemark>"
        )
    for kind, a, b in _lines(survey, places):
        count += 1
        ends = " ".join(f"{places[name][0]:.9f},{places[name][1]:.9f}" for name in (a, b))
        lines.append(
            f"<Placemark><name>{escape(f'{a}-{b}')}</name><styleUrl>#{kind}</styleUrl>"
            f"<LineString><coordinates>{ends}</coordinates></LineString></Placemark>"
        )
    lines += ["</Document></kml>", ""]
    return Written("\n".join(lines), count, tuple(warnings))
