"""What gyro sides of one network share: their errors as a constant and a covariance.

The constant of an instrument is an unknown of the network with a sigma of its own. Not all of its
errors are common to its sides: a deflection at the calibration line partly cancels with that of the
side, a torsion ratio works through the tape zero of each session. What every side of one constant
has alike, and no other side at all, is the error of the constant; everything else stands in one
covariance matrix of all sides, the deflections with the field that their stations share. Constant
and matrix together are the whole covariance of the grid azimuths.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.orientation.deflection_field import DeflectionField
from surveyapp.core.orientation.lines import OrientedLine
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp_models.arrays import Floats

ALIKE = 1e-9
"""Relative difference of two contributions of one source that count as the same."""


@dataclass(frozen=True, slots=True)
class SideErrors:
    """Errors of some gyro sides.

    Parameters
    ----------
    covariance : ndarray, shape (n, n)
        Of the sides, the constant that each shares with others of its name left out [rad^2].
    constants : mapping of str to float
        Variance of the constant of each name [rad^2]; a name that is missing has no known constant.
    """

    covariance: Floats
    constants: Mapping[str, float]


def side_errors(
    lines: Sequence[OrientedLine], names: Sequence[str], deflections: DeflectionField
) -> SideErrors:
    """Take the errors of gyro sides apart into constants and a covariance.

    Parameters
    ----------
    lines : sequence of OrientedLine
        With finite sigmas.
    names : sequence of str
        Of the constant that each line uses.
    deflections : DeflectionField
    """
    whole = deflections.jointly([_on_grid(line) for line in lines])
    common = _common(lines, names, whole)
    sources: dict[Source, int] = {}
    for item, name in zip(whole, names, strict=True):
        for source in item.parts:
            if source not in common.get(name, ()):
                sources.setdefault(source, len(sources))
    parts = np.zeros((len(lines), len(sources)))
    for row, (item, name) in enumerate(zip(whole, names, strict=True)):
        for source, part in item.parts.items():
            if source not in common.get(name, ()):
                parts[row, sources[source]] = part
    variances = {
        name: math.fsum(part * part for part in found.values()) for name, found in common.items()
    }
    return SideErrors(parts @ parts.T, variances)


def _on_grid(line: OrientedLine) -> Uncertain:
    """The grid azimuth; where there is no constant, everything but it."""
    return line.without_constant if line.grid is None else line.grid


def _common(
    lines: Sequence[OrientedLine], names: Sequence[str], whole: Sequence[Uncertain]
) -> dict[str, dict[Source, float]]:
    """Contributions that all sides of a name have alike, from the constant alone."""
    found: dict[str, dict[Source, float]] = {}
    used: dict[Source, set[str]] = {}
    for line, name, item in zip(lines, names, whole, strict=True):
        for source in item.parts:
            used.setdefault(source, set()).add(name)
        if line.grid is None or line.true is None:
            continue
        constant = line.true - line.gyro
        alike = found.get(name, dict(constant.parts))
        found[name] = {
            source: part
            for source, part in alike.items()
            if abs(constant.parts.get(source, 0.0) - part) <= ALIKE * abs(part)
            and abs(item.parts.get(source, 0.0) - part) <= ALIKE * abs(part)
        }
    return {
        name: {source: part for source, part in parts.items() if used.get(source) == {name}}
        for name, parts in found.items()
    }
