"""The grid of a project: its CRS, or the mine's own grid against one, or against true north."""

from __future__ import annotations

import math
from dataclasses import replace

from surveyapp.core.geodesy.grid import Frame, Grid
from surveyapp.core.geodesy.register import open_grid
from surveyapp.domain.mine_grid import MineGrid
from surveyapp.domain.project import Project
from surveyapp.errors import Problem, SurveyError


def grid_of(project: Project) -> Grid | None:
    """The grid in which the stations of a project are given, None where it names none.

    Raises
    ------
    SurveyError
        If the grid cannot be opened.
    """
    if project.grid is not None:
        return open_mine_grid(project.grid)
    return None if project.crs is None else open_grid(project.crs)


def open_mine_grid(mine: MineGrid) -> Grid:
    """A mine's own grid, ready to compute.

    Without a base CRS, true north at the origin is the direction that rotation counts from: the
    base is then a transverse Mercator through the origin, whose convergence away from it is that
    of the meridians (difference of longitude times sin of the latitude).

    Raises
    ------
    SurveyError
        If the base cannot be opened, or if the origin does not lie in it.
    """
    try:
        base = open_grid(mine.base if mine.base is not None else _at_origin(mine))
    except SurveyError as error:
        where = "project.toml, grid, base"
        raise SurveyError([replace(problem, where=where) for problem in error.problems]) from error
    base_e, base_n = _origin(mine, base)
    frame = Frame(
        rotation=mine.rotation,
        e=mine.e,
        n=mine.n,
        base_e=base_e,
        base_n=base_n,
        scale=mine.scale,
        sigma=mine.rotation_sigma,
    )
    turned = f"mine grid turned by {math.degrees(mine.rotation):.6f} degrees against "
    name = turned + (base.name if mine.base is not None else "true north")
    return replace(base, text=name, name=name, frame=frame, directions_from_south=False)


def _at_origin(mine: MineGrid) -> str:
    if mine.latitude is None or mine.longitude is None:
        raise SurveyError(
            Problem(
                "a mine grid without a base needs the place of its origin",
                "project.toml, grid",
                "",
                "origin = { lat = ..., lon = ... } in degrees",
            )
        )
    latitude, longitude = math.degrees(mine.latitude), math.degrees(mine.longitude)
    return (
        f"+proj=tmerc +lat_0={latitude:.12f} +lon_0={longitude:.12f} +k=1 +x_0=0 +y_0=0 "
        "+ellps=GRS80 +units=m +type=crs"
    )


def _origin(mine: MineGrid, base: Grid) -> tuple[float, float]:
    if mine.base_e is not None and mine.base_n is not None:
        return mine.base_e, mine.base_n
    if mine.latitude is not None and mine.longitude is not None:
        return base.projected(latitude=mine.latitude, longitude=mine.longitude)
    raise SurveyError(
        Problem(
            "a mine grid needs its origin in the base grid",
            "project.toml, grid",
            "",
            "origin = { e, n, base_e, base_n }, or lat and lon instead of the last two",
        )
    )
