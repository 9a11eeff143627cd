"""A shaft plumbing as surveyed: ``[[shaft]]``, its book, and the checks of the plumbing.

Lengths in metres, angles clockwise and in radians; swings of wires in millimetres, as they are read
and as they are reported. The orientation is computed in ``surveyapp.core.shafts``.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Literal

from surveyapp.errors import Problem

if TYPE_CHECKING:
    from surveyapp.domain.warning import ResultWarning

Place = Literal["surface", "underground"]


class ShaftRowKind(StrEnum):
    """What a row of a shaft book holds."""

    ANGLE = "angle"
    DISTANCE = "distance"
    SWING = "swing"
    DEPTH = "depth"
    AZIMUTH = "azimuth"


CHECK_IDS = ("signal_ring", "free_hang", "fans_off", "damping", "second_centring")
"""Checks of plumbing (sensors.md 000-22)."""


@dataclass(frozen=True, slots=True)
class ShaftRow:
    """One row of a shaft book.

    Parameters
    ----------
    kind : ShaftRowKind
    place : str
        ``surface`` or ``underground``; empty where it does not matter.
    at, back, to : str
    value : float
        [rad], [m]; a swing in mm.
    sigma : float or None
        In the unit of the value; None: that of the shaft.
    set : str
        Axis of a swing, number of a depth.
    note : str
    line : int
    """

    kind: ShaftRowKind
    place: Place | Literal[""]
    at: str
    back: str
    to: str
    value: float
    sigma: float | None
    set: str = ""
    note: str = ""
    line: int = 0


@dataclass(frozen=True, slots=True)
class PlumbingCheck:
    """A check of the plumbing as recorded."""

    id: str
    done_at: str = ""
    by: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True)
class Shaft:
    """One ``[[shaft]]`` with its book.

    Parameters
    ----------
    id : str
    kind : str
        ``one``: two wires in one shaft; ``two``: one wire in each of two shafts.
    depth_m : float
    wires : tuple of str
        Two names.
    orient : tuple of str
        at and to of the side that is oriented.
    sigma_plumb_m : float
        Each wire, each axis, air current included [m].
    sigma_angle : float or None
        [rad].
    sigma_mm, sigma_ppm : float or None
        Of a distance.
    radius_m : float
        Of the earth.
    rows : tuple of ShaftRow
    checks : tuple of PlumbingCheck
    """

    id: str
    kind: Literal["one", "two"]
    depth_m: float
    wires: tuple[str, str]
    orient: tuple[str, str]
    sigma_plumb_m: float
    sigma_angle: float | None = None
    sigma_mm: float | None = None
    sigma_ppm: float | None = None
    radius_m: float = 6_371_000.0
    rows: tuple[ShaftRow, ...] = ()
    checks: tuple[PlumbingCheck, ...] = ()

    def of_kind(self, kind: ShaftRowKind, place: str | None = None) -> tuple[ShaftRow, ...]:
        """Rows of one kind, at one place or anywhere."""
        return tuple(
            row for row in self.rows if row.kind is kind and (place is None or row.place == place)
        )


@dataclass(frozen=True, slots=True)
class ShaftTables:
    """Every ``[[shaft]]`` with its book as read, and everything that is wrong with them.

    What is wrong keeps nobody from orienting sides: it is told by whoever uses the shafts.

    Parameters
    ----------
    shafts : tuple of Shaft
    problems : tuple of Problem
    warnings : tuple of ResultWarning
    """

    shafts: tuple[Shaft, ...]
    problems: tuple[Problem, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()
