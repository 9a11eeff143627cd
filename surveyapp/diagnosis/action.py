"""What can be observed next: an action as a value, the same for every subject.

An action says which rows it would add to the record; how much they would tell is computed once for
all subjects in ``next_observation``. Nothing here knows the observations.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from surveyapp_models.arrays import Floats

POSITION = "position"
"""Key under which an action hands over where its rows stand in time or order."""


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
