"""What is plotted of a result: curves with their labels, the same for a screen and for paper.

A chart holds values and knows neither characters nor millimetres.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Literal

Style = Literal["line", "dots", "bound", "guide"]

MOST_POINTS: Final = 1200
"""Points of a curve that a chart holds: more cannot be told apart on a page."""


@dataclass(frozen=True, slots=True)
class Series:
    """One curve of a chart.

    Parameters
    ----------
    name : str
    points : tuple of (x, y)
    style : str
        ``line``; ``dots`` for readings; ``bound`` for an end of an interval; ``guide`` for a line
        to compare with.
    """

    name: str
    points: tuple[tuple[float, float], ...]
    style: Style = "line"

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"name": self.name, "style": self.style, "points": [list(p) for p in self.points]}


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves over one pair of axes.

    Parameters
    ----------
    title, x_label, y_label : str
    series : tuple of Series
    log_x, log_y : bool
        Whether an axis is logarithmic; then its values are above zero.
    square : bool
        Whether both axes have one scale, as a path on a map.
    y_names : tuple of str
        Words for y = 0, 1, 2 ... where y is no number.
    note : str
        One line below.
    """

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    log_x: bool = False
    log_y: bool = False
    square: bool = False
    y_names: tuple[str, ...] = ()
    note: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "title": self.title,
            "x_label": self.x_label,
            "y_label": self.y_label,
            "log_x": self.log_x,
            "log_y": self.log_y,
            "square": self.square,
            "y_names": list(self.y_names),
            "note": self.note,
            "series": [item.to_dict() for item in self.series],
        }


@dataclass(frozen=True, slots=True)
class Coverage:
    """How many readings lie in each cell of the sphere of directions, or of the circle.

    Parameters
    ----------
    title : str
    cells : tuple of tuple of int
        Bands of equal area from up to down, each with its azimuths; one band: a circle.
    note : str
    """

    title: str
    cells: tuple[tuple[int, ...], ...]
    note: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"title": self.title, "cells": [list(row) for row in self.cells], "note": self.note}


Picture = Chart | Coverage


@dataclass(frozen=True, slots=True)
class SensorPictures:
    """The pictures of one result of a sensor log, schema ``surveyapp.sensor_pictures/1``."""

    source: str
    pictures: tuple[Picture, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "schema": "surveyapp.sensor_pictures/1",
            "source": self.source,
            "charts": [p.to_dict() for p in self.pictures if isinstance(p, Chart)],
            "coverages": [p.to_dict() for p in self.pictures if isinstance(p, Coverage)],
        }
