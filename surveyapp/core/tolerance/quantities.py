"""What rule books limit: one line per quantity, with its dimension and what it takes to measure it.

A quantity is a name; how it is measured from an orientation stands in ``measures``, what a
traverse or a breakthrough yields is handed in by whoever computes those.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

_UNIT_FACTORS: Final[Mapping[str, Mapping[str, float]]] = {
    "angle": {"arcsec": 1.0, "arcmin": 60.0, "deg": 3600.0},
    "divisions": {"div": 1.0},
    "time": {"min": 60.0, "s": 1.0},
    "length": {"m": 1.0, "mm": 0.001},
    "count": {"rounds": 1.0, "observers": 1.0},
    "ratio": {"1 in": 1.0},
    "factor": {"times sigma": 1.0},
}
"""Size of each unit in the base unit of its dimension: arcsec, div, s, m, 1."""

UNITS: Final = tuple(unit for units in _UNIT_FACTORS.values() for unit in units)


@dataclass(frozen=True, slots=True)
class Quantity:
    """Something that a rule book limits.

    Parameters
    ----------
    id : str
    title : str
        In the trade's words.
    dimension : str
    needs : str
        What a project must hold for it, said where it is missing.
    subject : str
        orientation | traverse | plumbing | breakthrough: who measures it; parameter: nobody
        does, and a project may set it.
    """

    id: str
    title: str
    dimension: str
    needs: str
    subject: str = "orientation"

    @property
    def units(self) -> tuple[str, ...]:
        """Units in which a limit of this quantity may be given."""
        return tuple(_UNIT_FACTORS[self.dimension])

    def in_unit(self, value: float, unit: str) -> float:
        """Convert a value from the base unit of the dimension."""
        return value / _UNIT_FACTORS[self.dimension][unit]


_TRAVERSE, _PLUMBING, _BREAKTHROUGH = "traverse", "plumbing", "breakthrough"
PARAMETER: Final = "parameter"
"""Subject of what a rule book states and nobody measures: a project may set it, not below."""

QUANTITIES: Final[tuple[Quantity, ...]] = (
    Quantity(
        "rounds_difference",
        "largest difference of any two rounds on one side",
        "angle",
        "two rounds on one side",
    ),
    Quantity(
        "calibration_means_difference",
        "difference of two calibrations of one known side",
        "angle",
        "two calibrations of one known side",
    ),
    Quantity(
        "calibration_epochs_difference",
        "mean constant before against mean constant after",
        "angle",
        "calibrations before and after the survey",
    ),
    Quantity(
        "independent_difference",
        "difference of two independent orientations of one side",
        "angle",
        "two independent orientations of one side: another date, instrument or end of the side",
    ),
    Quantity(
        "independent_mean_sigma",
        "mean square error of the mean of two independent orientations",
        "angle",
        "two independent orientations of one side with an error budget",
    ),
    Quantity("tape_zero", "tape zero, absolute", "divisions", "tape_zero rows"),
    Quantity(
        "tape_zero_change",
        "tape zero after against before",
        "divisions",
        "tape_zero rows before and after",
    ),
    Quantity(
        "pre_orientation_tracking",
        "distance of the alidade from north before tracking",
        "angle",
        "a clamp row before the first turning point",
    ),
    Quantity(
        "pre_orientation_clamped",
        "distance of the clamped alidade from north",
        "angle",
        "a session by the transit or amplitude method with a clamp row",
    ),
    Quantity(
        "sights_difference",
        "sights after against sights before",
        "angle",
        "sights of the target before and after",
    ),
    Quantity(
        "rotor_rest",
        "pause between two rounds, in which the rotor rests",
        "time",
        "two rounds at one station with times",
    ),
    Quantity(
        "circle_spacing",
        "smallest distance of the circle readings of north of two rounds",
        "angle",
        "two rounds at one station, with circle readings of north or a stated circle_shift",
    ),
    Quantity(
        "rounds_before",
        "rounds on known sides before the survey",
        "count",
        "calibration sessions and a survey session",
    ),
    Quantity(
        "rounds_after",
        "rounds on known sides after the survey",
        "count",
        "calibration sessions and a survey session",
    ),
    Quantity("rounds_on_side", "rounds on the side to be oriented", "count", "survey sessions"),
    Quantity(
        "gyro_side_length",
        "length of a side that a gyro orients",
        "length",
        "survey sessions and the positions of both ends of the side",
    ),
    Quantity(
        "gyro_side_sigma",
        "mean square error of the direction of a side that a gyro orients",
        "angle",
        "survey sessions, a constant, and a sigma of both",
    ),
    Quantity(
        "observers",
        "observers of one instrument above and below",
        "count",
        "observer on every session of the instrument",
    ),
    Quantity(
        "level_excursion",
        "excursion of the level bubble",
        "divisions",
        "level rows, and level_division_arcsec of the session",
    ),
    Quantity(
        "gyro_against_traverse",
        "gyro azimuth against the azimuth that the traverse carries",
        "angle",
        "a traverse that ends on an oriented side",
        _TRAVERSE,
    ),
    Quantity(
        "angular_closure_closed",
        "angular closure of a closed traverse",
        "angle",
        "a closed traverse",
        _TRAVERSE,
    ),
    Quantity(
        "angular_closure_repeated",
        "difference of a traverse measured twice, n angles together",
        "angle",
        "an open traverse measured twice",
        _TRAVERSE,
    ),
    Quantity("shortest_side", "length of the shortest side", "length", "a traverse", _TRAVERSE),
    Quantity("longest_side", "length of the longest side", "length", "a traverse", _TRAVERSE),
    Quantity(
        "relative_closure_closed",
        "relative linear closure of a closed traverse",
        "ratio",
        "a closed traverse",
        _TRAVERSE,
    ),
    Quantity(
        "relative_closure_repeated",
        "relative linear closure of an open traverse measured twice",
        "ratio",
        "an open traverse measured twice",
        _TRAVERSE,
    ),
    Quantity(
        "repeated_length",
        "difference of two measurements of one length, L the length in metres",
        "length",
        "a length measured twice",
        _TRAVERSE,
    ),
    Quantity(
        "last_angle_again",
        "last angle measured again before a traverse is extended",
        "angle",
        "an angle measured again",
        _TRAVERSE,
    ),
    Quantity(
        "control_ellipse",
        "semi-major axis of the relative error ellipse of two control points",
        "length",
        "an adjusted network",
        _TRAVERSE,
    ),
    Quantity(
        "one_shaft_twice",
        "two orientations through one shaft",
        "angle",
        "two plumbings of one shaft",
        _PLUMBING,
    ),
    Quantity(
        "two_shaft_twice",
        "two orientations through two shafts",
        "angle",
        "two plumbings of two shafts",
        _PLUMBING,
    ),
    Quantity(
        "plumbed_direction",
        "mean square error of a direction carried below by plumbing",
        "angle",
        "a shaft with its wires",
        _PLUMBING,
    ),
    Quantity(
        "plumbed_point",
        "mean square error of the position of a point below the plumbing",
        "length",
        "a shaft with its wires and points below",
        _PLUMBING,
    ),
    Quantity(
        "wire_distance_surface",
        "distance of the wires, measured against computed, on the surface",
        "length",
        "a plumbing triangle on the surface",
        _PLUMBING,
    ),
    Quantity(
        "wire_distance_underground",
        "distance of the wires, measured against computed, underground",
        "length",
        "a plumbing triangle underground",
        _PLUMBING,
    ),
    Quantity(
        "height_transfer",
        "two transfers of height through a shaft, L its depth in kilometres",
        "length",
        "two transfers of height",
        _PLUMBING,
    ),
    Quantity(
        "lateral",
        "lateral error at the meeting point",
        "length",
        "a prediction or a measured breakthrough",
        _BREAKTHROUGH,
    ),
    Quantity(
        "vertical",
        "vertical error at the meeting point",
        "length",
        "a prediction or a measured breakthrough",
        _BREAKTHROUGH,
    ),
    Quantity(
        "penetration_factor",
        "factor from the standard deviation to the predicted error at the meeting point",
        "factor",
        "nothing: the rule book states it",
        PARAMETER,
    ),
)


def quantity(identity: str) -> Quantity:
    """Quantity by id; the reader of a rule book has made sure that it exists."""
    return next(item for item in QUANTITIES if item.id == identity)
