"""Oriented lines of the sessions as gyro sides of a network.

The constant is taken apart from the gyro azimuth again, because in a network all sides of one
instrument share it: as an unknown with its own sigma, not as independent noise. What else sides
share, the deflection of neighbouring stations above all, is a covariance of theirs.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

from surveyapp.core.orientation.deflection_field import DeflectionField
from surveyapp.core.orientation.lines import OrientedLine as Line
from surveyapp.core.orientation.side_errors import SideErrors, side_errors
from surveyapp.domain.results import LineResult
from surveyapp.domain.traverse import GyroConstant, OrientedLine
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said

NOTHING = 1e-12
"""Correlation of two sides that is rounding of the arithmetic."""
LEAST_SHARE = 1e-4
"""Of a side's sigma: a constant known so well is known exactly, and the equations stay regular."""


Constant = tuple[str, str | None]
"""Lines of one instrument with one choice of constant share it."""


def _constant(line: LineResult) -> Constant:
    return line.instrument, line.constant_choice or None


def _names(lines: Sequence[LineResult]) -> dict[Constant, str]:
    """A name of its own for every constant: an instrument may be called ``G1 pooled``."""
    names: dict[Constant, str] = {}
    for key in map(_constant, lines):
        name = " ".join(filter(None, key))
        while key not in names and name in names.values():
            name += "'"
        names.setdefault(key, name)
    return names


def _own_sigma(line: LineResult) -> float:
    """Standard deviation without the constant: azimuth, sights and deflection."""
    total = line.grid_azimuth or line.true_azimuth
    own = line.gyro_azimuth.sigma
    if total is None or line.constant_sigma is None:
        return own
    return math.sqrt(max(total.sigma**2 - line.constant_sigma**2, own**2))


def _shared(lines: Sequence[LineResult]) -> dict[Constant, tuple[float, float]]:
    """The constant that lines share: value of the surest, and its sigma.

    Constants that are predicted for each line differ; the difference is part of the reduction of
    the line, and what its sigma has beyond the common one belongs to the line.
    """
    found: dict[Constant, tuple[float, float]] = {}
    for line in lines:
        if line.constant is None or line.constant_sigma is None:
            continue
        known = found.get(_constant(line))
        if known is None or line.constant_sigma < known[1]:
            found[_constant(line)] = (line.constant, line.constant_sigma)
    return found


def oriented_lines(
    lines: Sequence[LineResult],
) -> tuple[tuple[OrientedLine, ...], tuple[GyroConstant, ...], tuple[ResultWarning, ...]]:
    """Turn the lines of an orientation into gyro sides and the constants that they share.

    Parameters
    ----------
    lines : sequence of LineResult

    Returns
    -------
    lines, constants, warnings
        A line whose sigma nothing tells (no degrees of freedom, no card) is left out with a
        warning. Without a CRS there is no convergence: 0 is taken and said.
    """
    sides: list[OrientedLine] = []
    constants: dict[str, GyroConstant] = {}
    warnings: list[ResultWarning] = []
    shared, names = _shared(lines), _names(lines)
    for line in lines:
        name, sight = names[_constant(line)], f"{line.station}-{line.target}"
        sigma = _own_sigma(line)
        if not 0.0 < sigma < math.inf:
            text = said(
                "gyro line {sight}: its sigma is not known, it is not used in the traverse",
                sight=sight,
            )
            warnings.append(ResultWarning("gyro_sigma_unknown", text, line.subject))
            continue
        if line.convergence is None:
            text = said(
                "gyro line {sight}: without a CRS its convergence is taken as 0", sight=sight
            )
            warnings.append(ResultWarning("convergence_unknown", text, line.subject))
        reduction = (line.convergence or 0.0) + line.deflection + (line.arc_to_chord or 0.0)
        value, common = shared.get(_constant(line), (line.constant or 0.0, line.constant_sigma))
        if line.constant is not None and line.constant_sigma is not None and common is not None:
            reduction -= line.constant - value
            sigma = math.sqrt(sigma**2 + max(line.constant_sigma**2 - common**2, 0.0))
        sides.append(
            OrientedLine(line.station, line.target, line.gyro_azimuth.value, sigma, name, reduction)
        )
        usable = common is not None and 0.0 < common < math.inf
        constants[name] = GyroConstant(name, value, common if usable else None)
    return tuple(sides), tuple(constants.values()), tuple(warnings)


Oriented = tuple[tuple[OrientedLine, ...], tuple[GyroConstant, ...]]


def with_shared_errors(
    found: Oriented,
    lines: Sequence[Line],
    deflections: DeflectionField,
    sides: Collection[tuple[str, str]],
) -> Oriented:
    """Gyro sides and constants with the covariance of what the sides of a network share.

    Parameters
    ----------
    found : tuple of (sides, constants)
        Of ``oriented_lines``.
    lines : sequence of OrientedLine
        With their error contributions apart.
    deflections : DeflectionField
    sides : collection of (station, target)
        Those that stand in a traverse; the others stay as they are.

    Returns
    -------
    tuple of (sides, constants)
        The sigma of a constant becomes that of what all its sides have alike.
    """
    names_of = _names([item.result for item in lines])
    by_key = {(x.result.station, x.result.target, names_of[_constant(x.result)]): x for x in lines}
    used = [
        place
        for place, item in enumerate(found[0])
        if (item.station, item.target) in sides or (item.target, item.station) in sides
    ]
    if not used:
        return found
    names = [found[0][place].constant for place in used]
    chosen = [by_key[found[0][p].station, found[0][p].target, found[0][p].constant] for p in used]
    errors = side_errors(chosen, names, deflections)
    oriented = list(found[0])
    for row, place in enumerate(used):
        oriented[place] = _with_row(oriented[place], errors, row, used)
    constants = tuple(_with_sigma(item, errors, oriented) for item in found[1])
    return tuple(oriented), constants


def _with_row(
    side: OrientedLine, errors: SideErrors, row: int, places: Sequence[int]
) -> OrientedLine:
    variances = errors.covariance.diagonal()
    shared = tuple(
        (place, float(value))
        for other, (place, value) in enumerate(zip(places, errors.covariance[row], strict=True))
        if other != row and abs(value) > NOTHING * math.sqrt(variances[row] * variances[other])
    )
    return replace(side, sigma=math.sqrt(float(variances[row])), covariance=shared)


def _with_sigma(
    constant: GyroConstant, errors: SideErrors, sides: Sequence[OrientedLine]
) -> GyroConstant:
    """A constant of which its sides share nothing stays known: free it would take their azimuth."""
    variance = errors.constants.get(constant.name)
    if variance is None or constant.sigma is None:
        return constant
    least = LEAST_SHARE * min(side.sigma for side in sides if side.constant == constant.name)
    return replace(constant, sigma=max(math.sqrt(variance), least))
