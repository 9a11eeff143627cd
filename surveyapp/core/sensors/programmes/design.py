"""What the readings so far determine: the rank of their design, parameter by parameter.

A design is linear in the parameters, or linearised where the estimator is not. A parameter is
determined when no change of the others can make up for a change of it: when its row of the null
space is zero.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.sensors.rate.needed import (
    CROSS_TOLERANCE,
    SCALE_TOLERANCE,
    ZERO_TOLERANCE,
    covariance_of,
)
from surveyapp.core.statistics.distributions import NORMAL_95
from surveyapp.domain.programme import Known, Programme, Row
from surveyapp.domain.sensor_log import STANDARD_GRAVITY_M_S2
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.deviation import COEFFICIENTS, deviation_basis

WEAKEST: Final = 1e-6
"""A combination of parameters that the design sees with less than this share of the strongest one
counts as not seen: rounding. Designs of settings are exact and have nothing between; attitudes of
hand-held stops do, and are judged by ``Part.needs``."""
STOP_NOISE: Final = 1e-3
"""Of the size of gravity at a stop by hand, relative: a centimetre per second squared."""
TURN_NOISE: Final = math.radians(0.2)
"""Of the direction of gravity after a turn by hand [rad]: the measured record of Tedaldi, Pretto
and Menegatti shows .13 degrees with everything modelled."""
NOTHING: Final = 1e-9
"""A column of the design this much smaller than the largest is rounding: sin 180 is not 0."""
AXES: Final = "xyz"
RANGE_OF: Final = {1.0: 90, 2.0: 30, 3.0: 15}
TRANSVERSE: Final = tuple((30.0 * k, float(flip)) for k in range(7) for flip in (0, 1))


@dataclass(frozen=True, slots=True)
class Part:
    """Some unknowns and what the readings say of them.

    Parameters
    ----------
    names : tuple of str
        Unknowns; a name that begins with ``_`` is a nuisance and is not shown.
    matrix : ndarray, shape (n, k)
    redundant : tuple of str
        What is told by residuals: determined when there are more readings than unknowns.
    whole : tuple of str
        What takes every unknown of the part.
    requires : tuple of str
        Parameters of other parts without which nothing here has a scale.
    needs : tuple of float
        Half the 95 % interval that each unknown needs, with rows of noise 1; empty = the rank of
        the design decides.
    """

    names: tuple[str, ...]
    matrix: Floats
    redundant: tuple[str, ...] = ()
    whole: tuple[str, ...] = ()
    requires: tuple[str, ...] = ()
    needs: tuple[float, ...] = ()


def known_of(programme: Programme, rows: Sequence[Row]) -> Known:
    """What the rows of a run determine.

    Parameters
    ----------
    programme : Programme
    rows : sequence of Row
        Readings, or stretches that were found in a log.
    """
    parts = DESIGNS[programme.id](rows)
    found: dict[str, bool] = {}
    rank = count = 0
    for part in parts:
        seen, part_rank = _determined(part)
        rank, count = rank + part_rank, count + len(part.names)
        full = part_rank == len(part.names)
        extra = full and part.matrix.shape[0] > part_rank
        found |= {n: seen[n] for n in part.names if not n.startswith("_")}
        found |= dict.fromkeys(part.redundant, extra) | dict.fromkeys(part.whole, full)
        for name in (*part.names, *part.redundant, *part.whole):
            if name in found and not all(found.get(other, False) for other in part.requires):
                found[name] = False
    shown = {name: known for name, known in found.items() if not name.startswith("_")}
    return Known(
        tuple(n for n, known in shown.items() if known),
        tuple(n for n, known in shown.items() if not known),
        rank,
        count,
    )


def _determined(part: Part) -> tuple[dict[str, bool], int]:
    """Which unknowns of a part are determined, and the rank."""
    k = len(part.names)
    if part.matrix.shape[0] == 0:
        return dict.fromkeys(part.names, False), 0
    if part.needs:
        half = NORMAL_95 * np.sqrt(np.diag(covariance_of(part.matrix)))
        known = {
            n: bool(h <= need) for n, h, need in zip(part.names, half, part.needs, strict=True)
        }
        return known, sum(known.values())
    size = np.linalg.norm(part.matrix, axis=0)
    size[size < NOTHING * float(size.max())] = 0.0
    scaled = part.matrix / np.where(size > 0.0, size, math.inf)
    _, values, basis = np.linalg.svd(scaled, full_matrices=True)
    values = np.append(values, np.zeros(max(k - values.size, 0)))[:k]
    seen = values > WEAKEST * max(float(values.max()), 1e-300)
    hidden = basis[~seen]
    free = np.zeros(k) if hidden.size == 0 else np.linalg.norm(hidden, axis=0)
    known = {name: bool(free[i] < WEAKEST) and size[i] > 0.0 for i, name in enumerate(part.names)}
    return known, int(np.count_nonzero(seen))


def _of(rows: Sequence[Row], **wanted: float | str) -> list[Row]:
    return [row for row in rows if all(row.get(key) == value for key, value in wanted.items())]


def _angles(rows: Sequence[Row]) -> Floats:
    return np.asarray(np.radians([float(row["angle_deg"]) for row in rows]), dtype=np.float64)


def _static(rows: Sequence[Row], numbers: Sequence[float]) -> list[Part]:
    parts = []
    for number in numbers:
        angle = _angles(_of(rows, test="static", set=number))
        first = number == 1.0
        span = RANGE_OF[number]
        names = ("zero", "sensitivity") if first else (f"_zero_{span}", f"_sensitivity_{span}")
        matrix = np.column_stack([np.ones(angle.size), np.sin(angle)])
        parts.append(Part(names, matrix, redundant=(f"linearity_{span}",)))
    return parts


def _reversal(rows: Sequence[Row]) -> Part:
    flips = np.array([1.0 - 2.0 * float(r["flip"]) for r in _of(rows, test="reversal")])
    matrix = np.column_stack([np.ones(flips.size), flips])
    return Part(("_bias", "tilt_reversal"), matrix, requires=("sensitivity",))


def _tilt_static(rows: Sequence[Row]) -> list[Part]:
    return [*_static(rows, (1.0, 2.0, 3.0)), _reversal(rows)]


def _tilt_transverse(rows: Sequence[Row]) -> list[Part]:
    here = _of(rows, test="transverse")
    cells = np.zeros((len(here), len(TRANSVERSE)))
    for index, row in enumerate(here):
        cells[index, TRANSVERSE.index((float(row["angle_deg"]), float(row["flip"])))] = 1.0
    phase = _angles(here) + math.pi * np.array([float(row["flip"]) for row in here])
    wave = np.column_stack([np.ones(phase.size), np.cos(phase), np.sin(phase)])
    names = tuple(f"_position_{k}" for k in range(len(TRANSVERSE)))
    scale = ("sensitivity",)
    return [
        *_static(rows, (1.0,)),
        Part(names, cells, whole=("transverse_seven_position",), requires=scale),
        Part(
            ("_mean", "_cosine", "_sine"),
            wave,
            whole=("transverse_sinusoid", "transverse_direction"),
            requires=scale,
        ),
        _reversal(rows),
    ]


def _tilt_zero(rows: Sequence[Row]) -> list[Part]:
    count = len(_of(rows, test="zero"))
    order = np.linspace(-1.0, 1.0, count) if count > 1 else np.zeros(count)
    scale = ("sensitivity",)
    return [
        *_static(rows, (1.0,)),
        Part(
            ("_level", "_drift"),
            np.column_stack([np.ones(count), order]),
            redundant=("zero_stability", "zero_stability_detrended"),
            requires=scale,
        ),
        _reversal(rows),
    ]


def _tilt_reversal(rows: Sequence[Row]) -> list[Part]:
    return [*_static(rows, (1.0,)), _reversal(rows)]


def _swing(rows: Sequence[Row]) -> list[Part]:
    psi = np.radians(np.array([float(row["heading_deg"]) for row in rows]))
    names = tuple(f"deviation_{letter}" for letter in COEFFICIENTS)
    return [Part(names, deviation_basis(psi))]


def _whole(rows: Sequence[Row]) -> list[Row]:
    """Stretches that hold a whole turn."""
    return [row for row in rows if float(row.get("turns", 0.0)) >= 1.0]


def _fog_station(rows: Sequence[Row]) -> list[Part]:
    """Sums S = 2nm (sense W (1 + scale) sin v + bias), linearised at two elevations.

    Between the passes the circle tells by how much the elevation changed.
    """
    start = {1.0: 0.1, 2.0: 0.0}
    cells = [
        [float(row["sense"]), float(row["sense"]) * start.get(float(row["pass"]), 0.0), 1.0]
        for row in _whole(rows)
    ]
    twice = len({row["pass"] for row in _whole(rows)}) > 1
    names = ("elevation", "scale_factor", "_bias")
    matrix = np.array(cells).reshape(-1, 3)
    circle = any(row.get("circle") for row in rows)
    told = ("instrument_constant",)
    untold = [] if circle else [Part(told, np.zeros((0, 1)))]
    whole = told if circle else ()
    if not twice:  # one pass: the nominal scale stands, and is told
        one = Part(("elevation", "_bias"), matrix[:, [0, 2]], whole=whole)
        return [one, *untold, Part(("scale_factor",), np.zeros((0, 1)))]
    return [Part(names, matrix, whole=whole), *untold]


def _positions(rows: Sequence[Row], names: Callable[[str], str]) -> list[Part]:
    """Scale factors, misalignments and biases from turns about each body axis.

    The slope of a pair of senses is a column of the matrix; the bias comes from the gyro's own
    axis up and down, where the vertical earth rate (one unknown a pair) cancels.
    """
    parts = []
    for a in AXES:
        here = [row for row in _whole(rows) if str(row["position"])[0] == a]
        column = tuple(
            names(f"scale_factor_{i}" if i == a else f"misalignment_{i}{a}") for i in AXES
        )
        cells = []
        for row in here:
            sense, up = float(row["sense"]), 1.0 if str(row["position"])[1] == "+" else -1.0
            place = f"_rest_{a}{'+' if up > 0.0 else '-'}"
            for i, name in enumerate(column):
                if AXES[i] == a:
                    cells.append({name: sense, names(f"bias_{a}"): 1.0, f"_vertical_{a}": up})
                else:
                    cells.append({name: sense, f"{place}_{i}": 1.0})
        unknowns = (*column, names(f"bias_{a}"), f"_vertical_{a}", *_rests(a))
        parts.append(Part(unknowns, _matrix(cells, unknowns)))
    return parts


def _rests(a: str) -> tuple[str, ...]:
    """What the other two gyros read at rest in a position: no bias is taken from it."""
    others = [i for i, b in enumerate(AXES) if b != a]
    return tuple(f"_rest_{a}{sign}_{i}" for sign in "+-" for i in others)


def _matrix(cells: Sequence[Mapping[str, float]], unknowns: Sequence[str]) -> Floats:
    found = np.zeros((len(cells), len(unknowns)))
    for r, row in enumerate(cells):
        for name, value in row.items():
            found[r, unknowns.index(name)] = value
    return found


def _six_position(rows: Sequence[Row]) -> list[Part]:
    return _positions(rows, lambda name: name)


def _temperature(rows: Sequence[Row]) -> list[Part]:
    """At each node one position per axis: with the latitude stated the bias needs no pair."""
    from surveyapp.core.sensors.programmes.catalogue import NODES_C

    parts = []
    for node in NODES_C:
        for a in AXES:
            at_node = [r for r in _whole(rows) if r["temperature_c"] == node]
            here = [r for r in at_node if str(r["position"])[:1] == a]
            names = (f"column_{a} at {node:g} C", f"bias_{a} at {node:g} C")
            matrix = np.array([[float(r["sense"]), 1.0] for r in here]).reshape(-1, 2)
            parts.append(Part(names, matrix))
    return parts


def _multi_position(rows: Sequence[Row]) -> list[Part]:
    """Size of gravity at the stops, and its direction from stop to stop.

    |a|^2 = g^2 linearised: u b + sum s_i u_i^2 + sum m_ij u_i u_j = 0, u the direction of a stop. A
    turn by the rotation vector t tells the two components of E t across the direction after it.
    """
    ups = np.array([[float(r[a]) for a in AXES] for r in rows]).reshape(-1, 3)
    x, y, z = ups.T
    design = np.column_stack([x, y, z, x * x, y * y, z * z, x * y, x * z, y * z])
    names = (
        *(f"accelerometer_bias_{a}" for a in AXES),
        *(f"accelerometer_scale_factor_{a}" for a in AXES),
        *(f"accelerometer_misalignment_{pair}" for pair in ("yx", "zx", "zy")),
    )
    cells = []
    for row, up in zip(rows, ups, strict=True):
        if "turn_x" not in row:
            continue
        turn = np.array([float(row[f"turn_{a}"]) for a in AXES])
        across = np.eye(3) - np.outer(up, up)
        cells += [np.kron(across[i], turn) for i in range(3)]
    matrix = np.array(cells).reshape(-1, 9)
    elements = tuple(
        f"scale_factor_{i}" if i == j else f"misalignment_{i}{j}" for i in AXES for j in AXES
    )
    biases = tuple(f"bias_{a}" for a in AXES)
    crosses = [SCALE_TOLERANCE if i == j else CROSS_TOLERANCE for i in AXES for j in AXES]
    zero = ZERO_TOLERANCE / STANDARD_GRAVITY_M_S2
    needs = (*(zero,) * 3, *(SCALE_TOLERANCE,) * 3, *(CROSS_TOLERANCE,) * 3)
    return [
        Part(names, design / STOP_NOISE, needs=needs),
        Part(elements, matrix / TURN_NOISE, needs=tuple(crosses)),
        Part(biases, np.vstack([np.eye(3)] * len(rows)) if len(rows) else np.zeros((0, 3))),
    ]


def _rotation(rows: Sequence[Row]) -> list[Part]:
    """Each phase tells its own: the rest the biases, the level phase the tilt, the run heading."""
    tells = {
        "filter": ("bias_x", "bias_y", "bias_z"),
        "level": ("pitch", "roll"),
        "run": ("heading",),
    }
    parts = []
    for phase, names in tells.items():
        seen = bool(_of(rows, phase=phase))
        parts.append(Part(names, np.eye(len(names)) if seen else np.zeros((0, len(names)))))
    return parts


DESIGNS: Final[Mapping[str, Callable[[Sequence[Row]], list[Part]]]] = {
    "tilt-static": _tilt_static,
    "tilt-transverse": _tilt_transverse,
    "tilt-zero": _tilt_zero,
    "tilt-reversal": _tilt_reversal,
    "compass-swing": _swing,
    "fog-station": _fog_station,
    "six-position": _six_position,
    "temperature": _temperature,
    "multi-position": _multi_position,
    "rotation": _rotation,
}
"""Programme to what its rows say of which unknowns."""
