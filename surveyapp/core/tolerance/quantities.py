"""What rule books limit: one line per quantity, with its dimension and what it takes to measure it.

A quantity is a name; how it is measured from an orientation stands in ``measures``, what a
traverse or a breakthrough yields is handed in by whoever computes those.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from surveyapp.languages import said

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
        said("largest difference of any two rounds on one side"),
        "angle",
        said("two rounds on one side"),
    ),
    Quantity(
        "calibration_means_difference",
        said("difference of two calibrations of one known side"),
        "angle",
        said("two calibrations of one known side"),
    ),
    Quantity(
        "calibration_epochs_difference",
        said("mean constant before against mean constant after"),
        "angle",
        said("calibrations before and after the survey"),
    ),
    Quantity(
        "independent_difference",
        said("difference of two independent orientations of one side"),
        "angle",
        said(
            "two independent orientations of one side: another date, instrument or end of the side"
        ),
    ),
    Quantity(
        "independent_mean_sigma",
        said("mean square error of the mean of two independent orientations"),
        "angle",
        said("two independent orientations of one side with an error budget"),
    ),
    Quantity("tape_zero", said("tape zero, absolute"), "divisions", said("tape_zero rows")),
    Quantity(
        "tape_zero_change",
        said("tape zero after against before"),
        "divisions",
        said("tape_zero rows before and after"),
    ),
    Quantity(
        "pre_orientation_tracking",
        said("distance of the alidade from north before tracking"),
        "angle",
        said("a clamp row before the first turning point"),
    ),
    Quantity(
        "pre_orientation_clamped",
        said("distance of the clamped alidade from north"),
        "angle",
        said("a session by the transit or amplitude method with a clamp row"),
    ),
    Quantity(
        "sights_difference",
        said("sights after against sights before"),
        "angle",
        said("sights of the target before and after"),
    ),
    Quantity(
        "rotor_rest",
        said("pause between two rounds, in which the rotor rests"),
        "time",
        said("two rounds at one station with times"),
    ),
    Quantity(
        "circle_spacing",
        said("smallest distance of the circle readings of north of two rounds"),
        "angle",
        said("two rounds at one station, with circle readings of north or a stated circle_shift"),
    ),
    Quantity(
        "rounds_before",
        said("rounds on known sides before the survey"),
        "count",
        said("calibration sessions and a survey session"),
    ),
    Quantity(
        "rounds_after",
        said("rounds on known sides after the survey"),
        "count",
        said("calibration sessions and a survey session"),
    ),
    Quantity(
        "rounds_on_side",
        said("rounds on the side to be oriented"),
        "count",
        said("survey sessions"),
    ),
    Quantity(
        "gyro_side_length",
        said("length of a side that a gyro orients"),
        "length",
        said("survey sessions and the positions of both ends of the side"),
    ),
    Quantity(
        "gyro_side_sigma",
        said("mean square error of the direction of a side that a gyro orients"),
        "angle",
        said("survey sessions, a constant, and a sigma of both"),
    ),
    Quantity(
        "observers",
        said("observers of one instrument above and below"),
        "count",
        said("observer on every session of the instrument"),
    ),
    Quantity(
        "level_excursion",
        said("excursion of the level bubble"),
        "divisions",
        said("level rows, and level_division_arcsec of the session"),
    ),
    Quantity(
        "gyro_against_traverse",
        said("gyro azimuth against the azimuth that the traverse carries"),
        "angle",
        said("a traverse that ends on an oriented side"),
        _TRAVERSE,
    ),
    Quantity(
        "angular_closure_closed",
        said("angular closure of a closed traverse"),
        "angle",
        said("a closed traverse"),
        _TRAVERSE,
    ),
    Quantity(
        "angular_closure_repeated",
        said("difference of a traverse measured twice, n angles together"),
        "angle",
        said("an open traverse measured twice"),
        _TRAVERSE,
    ),
    Quantity(
        "shortest_side",
        said("length of the shortest side"),
        "length",
        said("a traverse"),
        _TRAVERSE,
    ),
    Quantity(
        "longest_side", said("length of the longest side"), "length", said("a traverse"), _TRAVERSE
    ),
    Quantity(
        "relative_closure_closed",
        said("relative linear closure of a closed traverse"),
        "ratio",
        said("a closed traverse"),
        _TRAVERSE,
    ),
    Quantity(
        "relative_closure_repeated",
        said("relative linear closure of an open traverse measured twice"),
        "ratio",
        said("an open traverse measured twice"),
        _TRAVERSE,
    ),
    Quantity(
        "repeated_length",
        said("difference of two measurements of one length, L the length in metres"),
        "length",
        said("a length measured twice"),
        _TRAVERSE,
    ),
    Quantity(
        "last_angle_again",
        said("last angle measured again before a traverse is extended"),
        "angle",
        said("an angle measured again"),
        _TRAVERSE,
    ),
    Quantity(
        "control_ellipse",
        said("semi-major axis of the relative error ellipse of two control points"),
        "length",
        said("an adjusted network"),
        _TRAVERSE,
    ),
    Quantity(
        "one_shaft_twice",
        said("two orientations through one shaft"),
        "angle",
        said("two plumbings of one shaft"),
        _PLUMBING,
    ),
    Quantity(
        "two_shaft_twice",
        said("two orientations through two shafts"),
        "angle",
        said("two plumbings of two shafts"),
        _PLUMBING,
    ),
    Quantity(
        "plumbed_direction",
        said("mean square error of a direction carried below by plumbing"),
        "angle",
        said("a shaft with its wires"),
        _PLUMBING,
    ),
    Quantity(
        "plumbed_point",
        said("mean square error of the position of a point below the plumbing"),
        "length",
        said("a shaft with its wires and points below"),
        _PLUMBING,
    ),
    Quantity(
        "wire_distance_surface",
        said("distance of the wires, measured against computed, on the surface"),
        "length",
        said("a plumbing triangle on the surface"),
        _PLUMBING,
    ),
    Quantity(
        "wire_distance_underground",
        said("distance of the wires, measured against computed, underground"),
        "length",
        said("a plumbing triangle underground"),
        _PLUMBING,
    ),
    Quantity(
        "height_transfer",
        said("two transfers of height through a shaft, L its depth in kilometres"),
        "length",
        said("two transfers of height"),
        _PLUMBING,
    ),
    Quantity(
        "lateral",
        said("lateral error at the meeting point"),
        "length",
        said("a prediction or a measured breakthrough"),
        _BREAKTHROUGH,
    ),
    Quantity(
        "vertical",
        said("vertical error at the meeting point"),
        "length",
        said("a prediction or a measured breakthrough"),
        _BREAKTHROUGH,
    ),
    Quantity(
        "penetration_factor",
        said("factor from the standard deviation to the predicted error at the meeting point"),
        "factor",
        said("nothing: the rule book states it"),
        PARAMETER,
    ),
)


def quantity(identity: str) -> Quantity:
    """Quantity by id; the reader of a rule book has made sure that it exists."""
    return next(item for item in QUANTITIES if item.id == identity)
