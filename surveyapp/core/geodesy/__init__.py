"""Grid and Earth: convergence, arc-to-chord, deflection of the vertical, references of azimuths.

The only importer of pyproj, which is imported on first use and never asks the network.
"""

from surveyapp.core.geodesy.azimuths import (
    MAX_LATITUDE_DEG,
    WARN_LATITUDE_DEG,
    Azimuth,
    DeflectionTerm,
    deflection_term,
    latitude_problem,
)
from surveyapp.core.geodesy.grid import Frame, Grid
from surveyapp.core.geodesy.mine import grid_of, open_mine_grid
from surveyapp.core.geodesy.position import Position, arc_to_chord, position_of
from surveyapp.core.geodesy.register import find_projected, open_grid

__all__ = [
    "MAX_LATITUDE_DEG",
    "WARN_LATITUDE_DEG",
    "Azimuth",
    "DeflectionTerm",
    "Frame",
    "Grid",
    "Position",
    "arc_to_chord",
    "deflection_term",
    "find_projected",
    "grid_of",
    "latitude_problem",
    "open_grid",
    "open_mine_grid",
    "position_of",
]
