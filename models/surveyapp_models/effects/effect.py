"""What an effect is: one physical cause as a small value, the same for every subject.

An effect describes nature, not statistics: which columns it needs, which shape it has, how large
it can be, what the surveyor does about it. It must not fit, test or rank anything; that is done
once for all effects in ``surveyapp.diagnosis``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from surveyapp_models.arrays import Floats

Columns = Mapping[str, Floats]
SubjectId = str
"""Id of a subject: an identifier, equal to the file of ``diagnosis/subjects`` that describes it."""
SUBJECTS: tuple[SubjectId, ...] = (
    "reversal_run",
    "campaign",
    "traverse",
    "compass",
    "tilt",
    "rate",
)
"""Subjects that come with the program; a user's own may have any other id."""


class Basis(Protocol):
    """Columns of an effect: reading = base model + basis @ coefficients."""

    def __call__(self, columns: Columns, /, **grid: float) -> Floats:
        """Return the columns, shape (n, p), for one value of each non-linear parameter."""
        ...


class AmplitudeLaw(Protocol):
    """Amplitude of the swing at each turning point; every argument broadcasts."""

    def __call__(
        self,
        half_swing: Floats,
        first_amplitude: Floats,
        decay: Floats,
        coefficient: Floats,
        /,
        **grid: float | Floats,
    ) -> Floats:
        """Return the amplitude [unit of first_amplitude]; coefficient 0 = A exp(-k t)."""
        ...


class DatumRows(Protocol):
    """Rows of the basis at the state to which a result may be referred."""

    def __call__(
        self, columns: Columns, references: Mapping[str, float], /, **grid: float
    ) -> tuple[tuple[str, tuple[float, ...]], ...]:
        """Return (what the state is, row of p numbers) for each state."""
        ...


class ReferenceState(Protocol):
    """Where an adopted effect counts as nothing."""

    def __call__(
        self, columns: Columns, references: Mapping[str, float], /, **grid: float
    ) -> Mapping[str, float]:
        """Return the value of every needed column there, from the data that chose the effect."""
        ...


@dataclass(frozen=True, slots=True)
class Column:
    """A column that an effect reads.

    Parameters
    ----------
    name : str
        Key in the columns.
    unit : str
        Unit in which it is handed over.
    """

    name: str
    unit: str


@dataclass(frozen=True, slots=True)
class Coefficient:
    """A linear coefficient (of an amplitude law: its one parameter). Zero = effect absent.

    Parameters
    ----------
    name : str
        In the trade's words.
    unit : str
        Unit in which it is printed: ``arcsec``, ``arcsec/K``, ``1/half swing`` ...
    scale : float
        SI value of one printed unit (an arc-second in radians).
    low, high : float
        Plausible range in the printed unit.
    meaning : str
        What one unit does, with its sign.
    """

    name: str
    unit: str
    scale: float
    low: float
    high: float
    meaning: str


@dataclass(frozen=True, slots=True)
class GridParameter:
    """A non-linear parameter that is scanned; the scan is part of every test.

    Parameters
    ----------
    name : str
        Keyword of ``basis`` and ``law``.
    unit : str
    values : callable
        From the columns to the values to try.
    meaning : str
    continuous : bool
        Whether the basis is differentiable in it, so that its uncertainty enters the covariance.
    neutral : float or None
        A value at which it is not searched and so not paid for.
    """

    name: str
    unit: str
    values: Callable[[Columns], Floats]
    meaning: str
    continuous: bool = False
    neutral: float | None = None


@dataclass(frozen=True, slots=True)
class Effect:
    """One physical cause.

    Parameters
    ----------
    id : str
        Unique within its subject, equal to the file's name, never renamed.
    title : str
        For people.
    subject : str
    needs : tuple of Column
        Without them the effect is not applicable.
    coefficients : tuple of Coefficient
    basis : callable
        ``basis(columns, **grid) -> (n, p)``, pure. For an amplitude law the derivative of the
        reading with respect to the coefficient where that is 0.
    datum : str
        What the result means with the effect in the model.
    source : str
    remedy : str
        What the surveyor does about it.
    symptom : str
        What it looks like in the readings, one clause that follows "as if".
    separate_by : str
        The observation that would tell it from its partners.
    grid : tuple of GridParameter
    per : str or None
        session | instrument | line: what a coefficient belongs to; None = the one record.
    confusable_with : tuple of str
        Ids of the same subject.
    law : callable or None
        How it multiplies or replaces the exponential amplitude law of a swing; such an effect has
        exactly one coefficient.
    acts_on : str
        ``midpoint`` (added to the observation), ``amplitude`` (through ``law``), ``observation``
        (a single faulty value).
    one_sided : bool
        Whether the coefficient can only be positive (a loss).
    at_datum : callable or None
        Rows of the basis at the states of ``value_at_datum``; None = the effect has no datum.
    midpoint : callable or None
        The part of the basis that moves the result, where that is not all of it (a step inside a
        half swing changes the amplitude too); None = all of a midpoint effect.
    reference : callable or None
        State at which an adopted effect corrects nothing and to which it reduces everything else;
        None = where the basis is zero, and then each row of the basis depends on itself alone.
    event : bool
        Whether it happens once (a step, a slip): it does not recur in a second record, has no
        coefficient that records share, and is not pooled.
    course : tuple of tuple of float
        Of a course of north that was saved without a name: rows of half swings, the shift
        there (1 at its largest) and its errors (``recurrent.Course``); empty = a cause of its own.
    run : str
        The run that such a course was saved from.
    """

    id: str
    title: str
    subject: SubjectId
    needs: tuple[Column, ...]
    coefficients: tuple[Coefficient, ...]
    basis: Basis
    datum: str
    source: str
    remedy: str
    symptom: str
    separate_by: str
    grid: tuple[GridParameter, ...] = ()
    per: Literal["session", "instrument", "line"] | None = None
    confusable_with: tuple[str, ...] = ()
    law: AmplitudeLaw | None = None
    acts_on: Literal["midpoint", "amplitude", "observation"] = "midpoint"
    one_sided: bool = False
    at_datum: DatumRows | None = None
    midpoint: Basis | None = None
    reference: ReferenceState | None = None
    event: bool = False
    course: tuple[tuple[float, ...], ...] = ()
    run: str = ""

    def __post_init__(self) -> None:
        if self.law is not None and len(self.coefficients) != 1:
            raise ValueError(f"effect {self.id}: an amplitude law has exactly one coefficient")
        if (self.law is not None) != (self.acts_on == "amplitude"):
            raise ValueError(f"effect {self.id}: acts_on='amplitude' and law belong together")
        if not self.subject.isidentifier():
            raise ValueError(f"effect {self.id}: unknown subject {self.subject!r}")
        if not self.coefficients:
            raise ValueError(f"effect {self.id}: at least one coefficient")

    def grid_points(self, columns: Columns) -> tuple[dict[str, float], ...]:
        """Every combination of the scanned parameters; one empty point where there is none."""
        points: tuple[dict[str, float], ...] = ({},)
        for parameter in self.grid:
            values = parameter.values(columns)
            points = tuple({**p, parameter.name: float(v)} for p in points for v in values)
        return points

    def searched(self, point: Mapping[str, float]) -> int:
        """How many parameters were searched to arrive at this grid point."""
        return sum(1 for g in self.grid if g.neutral is None or point[g.name] != g.neutral)


HALF_SWING = Column("half_swing", "half swings since the first turning point")
SIDE = Column("side", "+1 right (east), -1 left")
RELATIVE_AMPLITUDE = Column("relative_amplitude", "amplitude / amplitude of the first point")
FIRST_AMPLITUDE = Column("first_amplitude", "rad")
DECAY = Column("decay", "1/half swing")


def mean_loss_time(half_swing: Floats, decay: Floats) -> Floats:
    """(1 - exp(-k t)) / k, the time t as the damping shortens it, also for k = 0."""
    product = np.asarray(half_swing * decay, dtype=np.float64)
    small = np.abs(product) < 1e-6
    safe = np.where(small, 1.0, product)
    ratio = np.where(small, 1.0 - 0.5 * product, -np.expm1(-safe) / safe)
    return np.asarray(half_swing * ratio)
