"""The instrument did not stand above the mark of one station."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """What a shift of the instrument does to everything observed there, east and north."""
    here = columns["station"] == grid["station"]
    both = (columns["by_station_east"], columns["by_station_north"])
    return np.column_stack([np.where(here, part, 0.0) for part in both])


def stations(columns: Columns) -> Floats:
    """Stations where two rows and more of anything else than heights were observed."""
    moved = (columns["by_station_east"] != 0.0) | (columns["by_station_north"] != 0.0)
    names, counts = np.unique(columns["station"][moved], return_counts=True)
    return np.asarray(names[(counts > 1) & (names > 0.0)])


EFFECT = Effect(
    id="station_centring",
    title="Instrument not above the mark",
    subject="traverse",
    needs=(
        Column("station", "number of the occupied point, 0 = none"),
        Column("by_station_east", "change of the observation per metre east, rad/m or 1"),
        Column("by_station_north", "change of the observation per metre north, rad/m or 1"),
    ),
    coefficients=(
        Coefficient("east", "mm", 1e-3, -200.0, 200.0, "instrument east of the mark"),
        Coefficient("north", "mm", 1e-3, -200.0, 200.0, "instrument north of the mark"),
    ),
    grid=(GridParameter("station", "number", stations, "where the instrument stood off"),),
    basis=basis,
    datum="the coordinates with the instrument's place at that station free",
    source="Ghilani 2010, Adjustment Computations, 7.4 (centring of the instrument)",
    remedy="Look at the plumbing of that set-up; occupy the station again.",
    symptom="everything observed at one station came from a place beside its mark",
    separate_by="the station occupied a second time, centred anew",
    confusable_with=("gross_error", "fixed_point", "angle_bias"),
    event=True,
)
