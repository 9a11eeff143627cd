"""What the size of a magnetometer's field tells where its attitude is not known.

Temperature and gradient have forms of their own there; a distortion must be one that iron makes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from surveyapp.core.sensors.compass_calibration import MOST_UNEQUAL
from surveyapp.diagnosis.sensors.loop import Candidate
from surveyapp.diagnosis.sensors.windows import Blocks, block_means
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.compass.temperature import datums


def possible_iron(elements: Floats) -> bool:
    """Whether a distortion S leaves m' (1 - 2 S) m a sphere that iron can bend.

    Where the attitudes are few, S = diag(1/2, 1/2, -1) with a hard iron along z makes a constant of
    any reading: the scales would differ by far more than iron can make them.
    """
    xx, yy, xy, xz, yz = elements
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, -xx - yy]])
    squares = 1.0 - 2.0 * np.linalg.eigvalsh(matrix)
    return bool(squares.min() > 0.0 and squares.max() <= MOST_UNEQUAL**2 * squares.min())


def size_candidates(
    columns: Mapping[str, Floats], missing: list[tuple[str, str]], m: Floats, block: Blocks
) -> list[Candidate]:
    """Temperature and gradient as the size of the field shows them."""
    found = []
    theta, place = columns.get("temperature_c"), columns.get("place_x")
    if theta is not None and np.all(np.isfinite(theta)) and np.ptp(theta) > 0.0:
        found.append(_warmer(columns, theta[::3], m, block))
    else:
        missing.append(("temperature", said("no temperature_c [degree Celsius] that varies")))
    if place is not None and np.all(np.isfinite(place)):
        at = np.column_stack([columns[f"place_{a}"][::3] for a in "xyz"])
        squares = np.column_stack([at, at**2, at[:, [0]] * at[:, [1]], at[:, [0]] * at[:, [2]],
                                   at[:, [1]] * at[:, [2]]])  # fmt: skip
        names = tuple(f"gradient_{s}" for s in ("x", "y", "z", "xx", "yy", "zz", "xy", "xz", "yz"))
        found.append(_plain("field_gradient", (squares[:, None, :], block), names, "uT/m"))
    else:
        missing.append(("field_gradient", said("no place (ref_px_m, ref_py_m, ref_pz_m)")))
    return found


def _warmer(columns: Mapping[str, Floats], theta: Floats, m: Floats, block: Blocks) -> Candidate:
    """Zeros by temperature, about every temperature at which they may be none."""

    def rows(point: Mapping[str, float]) -> Floats:
        warmer = (theta - point["datum_c"])[:, None, None]
        return np.concatenate([warmer * m, warmer**2], axis=2)

    points = [{"datum_c": float(t)} for t in datums(columns)]
    made = [(point, block_means(rows(point), block)) for point in points]
    names = (*(f"temperature_{a}" for a in "xyz"), "temperature_square")
    return Candidate("temperature", lambda _: made, names, "uT/K", 1, rows=rows)


def _plain(
    identity: str, rows: tuple[Floats, Blocks], names: tuple[str, ...], unit: str
) -> Candidate:
    design, block = rows
    means = block_means(design, block)

    def designs(residual: Floats) -> Sequence[tuple[dict[str, float], Floats]]:
        del residual
        return [({}, means)]

    return Candidate(identity, designs, names, unit, rows=lambda _: design)
