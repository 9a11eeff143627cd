"""Oriented lines of the sessions as gyro sides of a network.

The constant is taken apart from the gyro azimuth again, because in a network all sides of one
instrument share it: as an unknown with its own sigma, not as independent noise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from surveyapp.domain.project import ResultWarning
from surveyapp.domain.results import LineResult
from surveyapp.domain.traverse import GyroConstant, OrientedLine


def _name(line: LineResult) -> str:
    """Lines of one instrument with one choice of constant share it."""
    return f"{line.instrument} {line.constant_choice}" if line.constant_choice else line.instrument


def _own_sigma(line: LineResult) -> float:
    """Standard deviation without the constant: azimuth, sights and deflection."""
    total = line.grid_azimuth or line.true_azimuth
    own = line.gyro_azimuth.sigma
    if total is None or line.constant_sigma is None:
        return own
    return math.sqrt(max(total.sigma**2 - line.constant_sigma**2, own**2))


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
    for line in lines:
        name, sight = _name(line), f"{line.station}-{line.target}"
        sigma = _own_sigma(line)
        if not 0.0 < sigma < math.inf:
            text = f"gyro line {sight}: its sigma is not known, it is not used in the traverse"
            warnings.append(ResultWarning("gyro_sigma_unknown", text))
            continue
        if line.convergence is None:
            text = f"gyro line {sight}: without a CRS its convergence is taken as 0"
            warnings.append(ResultWarning("convergence_unknown", text))
        reduction = (line.convergence or 0.0) + line.deflection + (line.arc_to_chord or 0.0)
        sides.append(
            OrientedLine(line.station, line.target, line.gyro_azimuth.value, sigma, name, reduction)
        )
        known = line.constant is not None and line.constant_sigma is not None
        usable = known and 0.0 < (line.constant_sigma or 0.0) < math.inf
        constants[name] = GyroConstant(
            name, line.constant or 0.0, line.constant_sigma if usable else None
        )
    return tuple(sides), tuple(constants.values()), tuple(warnings)
