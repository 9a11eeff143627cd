"""What can be observed next: an action as a value, the same for every subject.

An action says which rows it would add to the record; how much they would tell is computed once for
all subjects in ``next_observation``. Nothing here knows the observations.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Effect

POSITION = "position"
"""Key under which an action hands over where its rows stand in time or order."""


Point = Mapping[str, float]
"""Values of the scanned parameters of an effect."""


class Rows(Protocol):
    """Columns of the observations that an action adds."""

    def __call__(self, columns: Mapping[str, Floats], /) -> Mapping[str, Floats] | None:
        """Return the columns of k new rows, each of shape (k,); None = not possible here.

        ``columns`` are those of the record with its ``position``; what is returned has the same
        names. Those that are left out are taken as at the last observation.
        """
        ...


@dataclass(frozen=True, slots=True)
class Action:
    """Something that a surveyor can do next.

    Parameters
    ----------
    id : str
    text : str
        In the imperative, without a full stop: ``repeat it tomorrow``.
    rows : callable
    """

    id: str
    text: str
    rows: Rows


def last_rows(columns: Mapping[str, Floats], count: int = 1) -> dict[str, Floats]:
    """The last observation of a record, ``count`` times: what an action changes something of."""
    return {name: np.full(count, values[-1]) for name, values in columns.items() if values.size}


def completed(columns: Mapping[str, Floats], rows: Mapping[str, Floats]) -> dict[str, Floats]:
    """Rows of an action with what it does not say taken from the last observation."""
    count = next(iter(rows.values())).size
    return {**last_rows(columns, count), **rows}


@dataclass(frozen=True, slots=True)
class Linear:
    """Rows of a record and of an action, in sigmas of a reading.

    Parameters
    ----------
    flat : ndarray, shape (n + k, p)
        Columns of which nothing is known beforehand.
    first : int
        n.
    wanted : ndarray, shape (p,)
        What is wanted, as a linear function of their coefficients.
    """

    flat: Floats
    first: int
    wanted: Floats


@dataclass(frozen=True, slots=True)
class Kept:
    """A member that counts.

    Parameters
    ----------
    unit : str
        Cause that it stands for.
    effect : Effect or None
        None = the base model.
    point : mapping
    scale : ndarray, shape (q,)
        What one prior standard deviation is of each coefficient.
    log_prior, weight : float
    mean : ndarray, shape (q,)
        Its coefficients by the record, in prior standard deviations.
    """

    unit: str
    effect: Effect | None
    point: Point
    scale: Floats
    log_prior: float
    weight: float
    mean: Floats


@dataclass(frozen=True, slots=True)
class Plan:
    """An action as rows.

    Parameters
    ----------
    id, text : str
    y : ndarray, shape (n,)
        The record, in sigmas.
    rows : Linear
    columns : tuple of ndarray, shape (n + k, q)
        Of each kept member, without its scale.
    adds : tuple of ndarray, shape (q,)
        What each kept member adds to what is wanted.
    """

    id: str
    text: str
    y: Floats
    rows: Linear
    columns: tuple[Floats, ...]
    adds: tuple[Floats, ...]


class Planner(Protocol):
    """A record in rows of unit sigma, and what its actions add."""

    @property
    def y(self) -> Floats:
        """The record, shape (n,)."""
        ...

    @property
    def flat(self) -> Floats:
        """Columns of which nothing is known beforehand, shape (n, p)."""
        ...

    @property
    def wanted_name(self) -> str:
        """What is wanted, followed by its interval."""
        ...

    @property
    def unit(self) -> str:
        """Printed unit of what is wanted; empty = that of the record."""
        ...

    @property
    def scale(self) -> float:
        """SI value of one printed unit."""
        ...

    @property
    def sigma(self) -> float:
        """What is wanted has this unit in the rows [SI]."""
        ...

    def columns(self, effect: Effect, point: Point, /) -> Floats:
        """Columns of an effect in the record, shape (n, q)."""
        ...

    def largest(self, effect: Effect, point: Point, /) -> float:
        """What a coefficient of 1 does to the observation that it changes most, in its sigmas."""
        ...

    def plans(self, kept: Sequence[Kept], /) -> Sequence[Plan]:
        """Every action that is worth computing."""
        ...
