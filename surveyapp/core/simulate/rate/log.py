"""A simulated sensor log: columns as they stand in a file, and the truth behind them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from surveyapp_models.arrays import Floats

_DECIMALS = {"time_s": 4, "table_angle_deg": 6, "temperature_c": 3, "odometer_m": 4}


@dataclass(frozen=True, slots=True)
class SimulatedLog:
    """One log.

    Parameters
    ----------
    columns : mapping of str to ndarray, shape (n,)
        Canonical names and units.
    texts : mapping of str to sequence of str
    truth : mapping
        Ready for JSON; parameters under their names in ``calibrate``.
    """

    columns: Mapping[str, Floats]
    texts: Mapping[str, Sequence[str]] = field(default_factory=dict)
    truth: Mapping[str, object] = field(default_factory=dict)

    def csv(self) -> str:
        """The log as text, one line of names and one line a row."""
        names = [*self.columns, *self.texts]
        parts = [_cells(name, values) for name, values in self.columns.items()]
        parts += [list(values) for values in self.texts.values()]
        lines = [",".join(row) for row in zip(*parts, strict=True)]
        return "\n".join([",".join(names), *lines]) + "\n"


def _cells(name: str, values: Floats) -> list[str]:
    decimals = _DECIMALS.get(name)
    if decimals is not None:
        return [f"{v:.{decimals}f}" for v in values.tolist()]
    return [f"{v:.9g}" for v in values.tolist()]


def joined(parts: Sequence[SimulatedLog], truth: Mapping[str, object]) -> SimulatedLog:
    """Several stretches with the same columns, one after the other."""
    columns = {k: np.concatenate([p.columns[k] for p in parts]) for k in parts[0].columns}
    texts = {k: [w for p in parts for w in p.texts[k]] for k in parts[0].texts}
    return SimulatedLog(columns, texts, truth)
