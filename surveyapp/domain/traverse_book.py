"""A traverse as a project states it: its table, and the rows of its book in radians and metres.

What a gyro row is worth comes from the sessions; nothing here knows an azimuth.
"""

from __future__ import annotations

from dataclasses import dataclass

from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.subject import Subject


@dataclass(frozen=True, slots=True)
class TraverseRow:
    """One row of a traverse book.

    Parameters
    ----------
    kind : ObservationKind
    at, back, to : str
    value : float or None
        [rad] or [m]; None for gyro rows, whose value comes from the sessions.
    sigma : float or None
        As stated in the row [rad] or [m].
    set : str
    hi, ht : float
        [m].
    note : str
    line : int
    """

    kind: ObservationKind
    at: str
    back: str
    to: str
    value: float | None
    sigma: float | None
    set: str
    hi: float
    ht: float
    note: str
    line: int
    length_m: float | None = None


@dataclass(frozen=True, slots=True)
class Traverse:
    """A ``[[traverse]]`` table with its book.

    Parameters
    ----------
    name, book, traverse_class : str
        ``book``: its path as written; ``traverse_class``: the rule book's own word.
    sigma_angle : float or None
        One angle [rad].
    sigma_zenith : float or None
        One zenith angle [rad]; that of an angle without it.
    sigma_mm, sigma_ppm : float or None
        Of a distance.
    instrument_m, target_m : float
        Centring, each component [m].
    atmosphere_applied, constant_applied : bool or None
        Whether the instrument has corrected the distances; None where nobody says.
    height_m : tuple of float
        Standard deviations of instrument and target height, which a set-up's rounds share [m].
    sigma_dof : tuple of (str, float)
        Degrees of freedom of sigmas that were estimated: ``angle``, ``zenith``, ``distance``, and
        ``circles`` where one estimate stands for angles and zenith angles.
    centring_assumed : bool
        Whether centring and heights are a mere assumption.
    rows : tuple of TraverseRow
        Of its book, every station known.
    """

    name: str
    book: str
    traverse_class: str = ""
    sigma_angle: float | None = None
    sigma_mm: float | None = None
    sigma_ppm: float | None = None
    instrument_m: float = 0.0
    target_m: float = 0.0
    atmosphere_applied: bool | None = None
    constant_applied: bool | None = None
    height_m: tuple[float, float] = (0.0, 0.0)
    sigma_zenith: float | None = None
    sigma_dof: tuple[tuple[str, float], ...] = ()
    centring_assumed: bool = False
    rows: tuple[TraverseRow, ...] = ()

    @property
    def subject(self) -> Subject:
        """The traverse as a value."""
        return Subject.of("traverse", self.name)
