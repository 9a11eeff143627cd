"""Sensor logs as records of the loop: block means, base model, and the designs of the effects.

Compass with a reference attitude: the field vector in the body; without: |m|^2 / 2F, which is
exactly linear in hard and soft iron. Tilt: both axes against their reference.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.sensors.loop import Candidate
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats

Blocks = NDArray[np.int64]

MOST_BLOCKS: Final = 160
COARSE: Final = 24
"""Windows of a switch begin and end at so many places in the first scan."""

SWITCH_SEARCHED: Final = 3
"""Two times among some ten thousand windows: more than two parameters of a BIC pay for."""

MOST_GROSS: Final = 0.01
"""Share of the rows above which they are no gross errors but how the record is."""

GROSS: Final = 8.0
"""Single readings that leave their neighbours by so many robust sigma are gross errors."""

SYMMETRIC: Final = ("xx", "yy", "xy", "xz", "yz")
_SHAPES: Final = np.array(
    [
        [[1, 0, 0], [0, 0, 0], [0, 0, -1]],
        [[0, 0, 0], [0, 1, 0], [0, 0, -1]],
        [[0, 1, 0], [1, 0, 0], [0, 0, 0]],
        [[0, 0, 1], [0, 0, 0], [1, 0, 0]],
        [[0, 0, 0], [0, 0, 1], [0, 1, 0]],
    ],
    dtype=np.float64,
)
"""Symmetric matrices of trace zero."""


@dataclass(frozen=True, slots=True)
class SensorRecord:
    """A log as the loop takes it.

    Parameters
    ----------
    subject : str
        compass | tilt.
    unit : str
    time : ndarray, shape (m,)
        Of the rows that are used [s].
    block : ndarray of int, shape (m,)
        Block of each row.
    rows : ndarray, shape (m, d)
        Observations row by row.
    base_rows : ndarray, shape (m, d, p)
    observed : ndarray, shape (n, d)
        Block means.
    base : ndarray, shape (n, d, p)
    candidates : tuple of Candidate
    step_rows : ndarray, shape (m, d, k), or None
        What a switch adds while it is on, row by row.
    gross : tuple of (row, size)
        Rows of the log that were left out as gross errors, and by how much they are off.
    mode : str
        vector | size | axes.
    matrices : ndarray, shape (m, 3, 3), or None
        Reference attitudes, body to level.
    mag : ndarray, shape (m, 3), or None
    scale : float
        F of ``|m|^2 / 2F``, else 1.
    """

    subject: str
    unit: str
    time: Floats
    block: Blocks
    rows: Floats
    base_rows: Floats
    observed: Floats
    base: Floats
    candidates: tuple[Candidate, ...]
    step_rows: Floats | None = None
    gross: tuple[tuple[int, float], ...] = ()
    mode: str = "axes"
    matrices: Floats | None = None
    mag: Floats | None = None
    scale: float = 1.0


def block_means(values: Floats, block: Blocks) -> Floats:
    """Means of the rows of each block, shape (n, ...)."""
    count = np.bincount(block)
    flat = values.reshape(len(values), -1)
    sums = np.stack([np.bincount(block, weights=column) for column in flat.T], axis=1)
    return np.asarray((sums / count[:, None]).reshape(count.size, *values.shape[1:]))


def blocks_of(rows: int, most: int = MOST_BLOCKS) -> Blocks:
    """Numbers of contiguous blocks of equal size."""
    return np.arange(rows) * min(most, rows) // rows


def rotation_matrices(q: Floats) -> Floats:
    """Rotation matrices, body to level frame, of quaternions with w first, shape (n, 3, 3)."""
    w, x, y, z = (q / np.linalg.norm(q, axis=1)[:, None]).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def gross_rows(residual: Floats) -> list[tuple[int, float]]:
    """Single rows that leave both their neighbours, with the size by which they do.

    A switch leaves its neighbours on one side only: its second difference is as large in the next
    row, that of a single wrong reading half as large.
    """
    if len(residual) < 8:
        return []
    second = residual[1:-1] - 0.5 * (residual[:-2] + residual[2:])
    spread = 1.4826 * np.median(np.abs(second - np.median(second, axis=0)), axis=0)
    if np.any(spread <= 0.0):
        return []
    size = np.sqrt(np.sum((second / spread) ** 2, axis=1))
    around = np.maximum(np.concatenate([[0.0], size[:-1]]), np.concatenate([size[1:], [0.0]]))
    limit = GROSS * math.sqrt(residual.shape[1])
    places = np.flatnonzero((size > limit) & (size > 1.5 * around))
    if len(places) > max(MOST_GROSS * len(residual), 3.0):
        return []
    return [(int(i) + 1, float(np.linalg.norm(second[i]))) for i in places]


def compass_record(log: SensorLog) -> SensorRecord:
    """Record of a compass log; the vector where a reference attitude stands beside it."""
    q = log.quaternion()
    return _vector_record(log, rotation_matrices(q)) if q is not None else _size_record(log)


def _mag(log: SensorLog) -> Floats:
    return np.column_stack([log.columns[f"mag_{axis}_uT"] for axis in "xyz"])


def _vector_record(log: SensorLog, matrices: Floats) -> SensorRecord:
    mag = _mag(log)
    base_rows = np.swapaxes(matrices, 1, 2)  # body = R' level
    n = len(mag)
    with_iron = np.concatenate([base_rows, np.tile(np.eye(3), (n, 1, 1))], axis=2)
    solution = np.linalg.lstsq(with_iron.reshape(3 * n, 6), mag.ravel(), rcond=1e-9)[0]
    level = solution[:3]
    gross = gross_rows(mag - base_rows @ level)
    kept = np.ones(n, dtype=bool)
    kept[[row for row, _ in gross]] = False
    body = (base_rows @ level)[kept]
    block = blocks_of(int(kept.sum()))
    eye = np.tile(np.eye(3), (len(body), 1, 1))
    shapes = np.stack([body @ shape for shape in _SHAPES], axis=2)
    turns = np.stack([np.cross(np.eye(3)[k], body) for k in range(3)], axis=2)
    rows = {"hard_iron": eye, "soft_iron": shapes, "misalignment": turns}
    theta = log.columns.get("temperature_c")
    if theta is not None and np.all(np.isfinite(theta)) and np.ptp(theta[kept]) > 0.0:
        part = theta[kept] - theta[kept].mean()
        rows["temperature"] = part[:, None, None] * eye
    place = log.vector("ref_p")
    if place is not None and np.all(np.isfinite(place)):
        at = (place - place.mean(axis=0))[kept]
        gradient = np.stack([at @ shape for shape in _SHAPES], axis=2)
        rows["field_gradient"] = base_rows[kept] @ gradient
    names = {
        "hard_iron": (("hard_iron_x", "hard_iron_y", "hard_iron_z"), "uT", 1.0),
        "soft_iron": (tuple(f"soft_iron_{s}" for s in SYMMETRIC), "1", 1.0),
        "misalignment": (tuple(f"misalignment_{a}" for a in "xyz"), "deg", math.degrees(1.0)),
        "temperature": (tuple(f"temperature_{a}" for a in "xyz"), "uT/K", 1.0),
        "field_gradient": (tuple(f"gradient_{s}" for s in SYMMETRIC), "uT/m", 1.0),
    }
    candidates = [_plain(i, block_means(r, block), names[i]) for i, r in rows.items()]
    used = log.columns["time_s"][kept]
    candidates.append(_switch(used, block, eye, ("step_x", "step_y", "step_z"), base_rows[kept]))
    return SensorRecord(
        "compass", "uT", used, block, mag[kept], base_rows[kept],
        block_means(mag[kept], block), block_means(base_rows[kept], block), tuple(candidates),
        eye, tuple(gross), "vector", matrices[kept], mag[kept],
    )  # fmt: skip


def _size_record(log: SensorLog) -> SensorRecord:
    mag = _mag(log)
    gross = gross_rows(np.linalg.norm(mag, axis=1)[:, None])
    kept = np.ones(len(mag), dtype=bool)
    kept[[row for row, _ in gross]] = False
    used = mag[kept]
    scale = float(np.mean(np.linalg.norm(used, axis=1)))
    y = (np.sum(used**2, axis=1) / (2.0 * scale))[:, None]
    block = blocks_of(len(used))
    one = np.ones((len(used), 1, 1))
    m = (used / scale)[:, None, :]
    quadratic = np.stack(
        [-np.einsum("ni,ij,nj->n", used, shape, used) / scale for shape in _SHAPES], axis=1
    )[:, None, :]
    rows = {"hard_iron": m, "soft_iron": quadratic}
    theta = log.columns.get("temperature_c")
    if theta is not None and np.all(np.isfinite(theta)) and np.ptp(theta[kept]) > 0.0:
        warmer = (theta[kept] - theta[kept].mean())[:, None, None]
        rows["temperature"] = np.concatenate([warmer * m, warmer**2], axis=2)
    place = log.vector("ref_p")
    if place is not None and np.all(np.isfinite(place)):
        at = (place - place.mean(axis=0))[kept] / 1.0
        squares = np.column_stack([at, at**2, at[:, [0]] * at[:, [1]], at[:, [0]] * at[:, [2]],
                                   at[:, [1]] * at[:, [2]]])  # fmt: skip
        rows["field_gradient"] = squares[:, None, :]
    names = {
        "hard_iron": (("hard_iron_x", "hard_iron_y", "hard_iron_z"), "uT", 1.0),
        "soft_iron": (tuple(f"soft_iron_{s}" for s in SYMMETRIC), "1", 1.0),
        "temperature": ((*(f"temperature_{a}" for a in "xyz"), "temperature_square"), "uT/K", 1.0),
        "field_gradient": (
            tuple(f"gradient_{s}" for s in ("x", "y", "z", "xx", "yy", "zz", "xy", "xz", "yz")),
            "uT/m", 1.0,
        ),
    }  # fmt: skip
    candidates = [_plain(i, block_means(r, block), names[i]) for i, r in rows.items()]
    time = log.columns["time_s"][kept]
    step = np.concatenate([m, one], axis=2)
    step_names = ("step_x", "step_y", "step_z", "step_size")
    candidates.append(_switch(time, block, step, step_names, one))
    return SensorRecord(
        "compass", "uT", time, block, y, one, block_means(y, block), block_means(one, block),
        tuple(candidates), step, tuple(gross), "size", None, used, scale,
    )  # fmt: skip


def tilt_record(log: SensorLog) -> SensorRecord:
    """Record of a two-axis tilt log: zero and scale of each axis are the base."""
    axes = ("along", "across")
    reading = np.column_stack([log.columns[f"tilt_{a}_arcsec"] for a in axes])
    own = np.column_stack([log.columns[f"ref_{a}_arcsec"] for a in axes])
    n = log.size
    base = np.zeros((n, 2, 4))
    for i in range(2):
        base[:, i, i], base[:, i, 2 + i] = 1.0, own[:, i]
    fit = np.linalg.lstsq(base.reshape(2 * n, 4), reading.ravel(), rcond=1e-12)[0]
    gross = _outliers(reading - base @ fit)
    kept = np.ones(n, dtype=bool)
    kept[[row for row, _ in gross]] = False
    time = log.columns["time_s"] if log.has("time_s") else np.arange(n, dtype=np.float64)

    def both(values: Floats) -> Floats:
        design = np.zeros((n, 2, 2))
        design[:, 0, 0], design[:, 1, 1] = values[:, 0], values[:, 1]
        return design[kept]

    span = np.max(np.abs(own), axis=0)
    rows = {
        "cross_axis": (both(own[:, ::-1]), ("cross_along", "cross_across"), "1"),
        "scale_nonlinearity": (
            both((own / np.where(span > 0.0, span, 1.0)) ** 3),
            ("cubic_along", "cubic_across"),
            "arcsec",
        ),
    }
    theta = log.columns.get("temperature_c")
    if theta is not None and np.all(np.isfinite(theta)) and float(np.ptp(theta)) > 0.0:
        part = np.repeat((theta - theta.mean())[:, None], 2, axis=1)
        rows["temperature"] = (both(part), ("temperature_along", "temperature_across"), "arcsec/K")
    block = blocks_of(int(kept.sum()), 400)
    candidates = [
        _plain(i, block_means(d, block), (names, unit, 1.0)) for i, (d, names, unit) in rows.items()
    ]
    candidates.append(_warm_up(time[kept], block))
    return SensorRecord(
        "tilt", "arcsec", time[kept], block, reading[kept], base[kept],
        block_means(reading[kept], block), block_means(base[kept], block), tuple(candidates),
        None, tuple(gross), "axes",
    )  # fmt: skip


def _outliers(residual: Floats) -> list[tuple[int, float]]:
    """Rows of a table whose residual is beyond all bounds, robustly, one axis or the other."""
    spread = 1.4826 * np.median(np.abs(residual - np.median(residual, axis=0)), axis=0)
    if np.any(spread <= 0.0):
        return []
    size = np.abs(residual - np.median(residual, axis=0)) / spread
    limit = max(5.5, 4.0 * float(np.quantile(size, 0.9)))
    rows = np.flatnonzero(np.max(size, axis=1) > limit)
    if len(rows) > max(len(residual) // 20, 1):
        return []
    return [(int(r), float(residual[r, int(np.argmax(size[r]))])) for r in rows]


Designs = Callable[[Floats], Sequence[tuple[dict[str, float], Floats]]]


def _plain(identity: str, design: Floats, named: tuple[tuple[str, ...], str, float]) -> Candidate:
    names, unit, scale = named

    def designs(residual: Floats) -> Sequence[tuple[dict[str, float], Floats]]:
        del residual
        return [({}, design)]

    return Candidate(identity, designs, names, unit, 0, scale)


def _warm_up(time: Floats, block: Blocks) -> Candidate:
    span = float(time[-1] - time[0]) or 1.0

    def designs(residual: Floats) -> Sequence[tuple[dict[str, float], Floats]]:
        del residual
        found = []
        for share in (0.03, 0.06, 0.12, 0.2, 0.3):
            decay = np.exp(-(time - time[0]) / (share * span))
            design = np.zeros((time.size, 2, 2))
            design[:, 0, 0] = design[:, 1, 1] = decay
            found.append(({"tau_s": share * span}, block_means(design, block)))
        return found

    names = ("warm_up_along", "warm_up_across")
    return Candidate("warm_up", designs, names, "arcsec", 1)


def switched(time: Floats, on: float, off: float) -> Floats:
    """1 while on, from ``on`` up to ``off`` [s], else 0."""
    return ((time >= on) & (time < off)).astype(np.float64)


def _switch(
    time: Floats, block: Blocks, step: Floats, names: tuple[str, ...], base_rows: Floats
) -> Candidate:
    """Something that is switched on and off: every window of a coarse scan, then finer ones.

    It is switched on inside the record: on from the start and off later is a constant iron and
    the opposite switch.
    """
    base = block_means(base_rows, block)
    n, d = base.shape[:2]
    # a constant iron is projected out of the scan, so that it cannot hide a switched one
    both = np.concatenate([base, block_means(step, block)], axis=2).reshape(n * d, -1)
    u, singular, _ = np.linalg.svd(both, full_matrices=False)
    q = u[:, singular > 1e-9 * singular[0]]
    edges = np.concatenate([time[np.searchsorted(block, np.arange(n))], [np.inf]])

    def window(on: float, off: float) -> Floats:
        return block_means(step * switched(time, on, off)[:, None, None], block)

    def gain(residual: Floats, i: int, j: int) -> float:
        z = window(float(edges[i]), float(edges[j])).reshape(n * d, -1)
        z = z - q @ (q.T @ z)
        y = residual.ravel()
        solution, rest, rank, _ = np.linalg.lstsq(z, y, rcond=1e-9)
        del solution
        return float(y @ y - rest[0]) if rest.size and rank == z.shape[1] else 0.0

    def designs(residual: Floats) -> Sequence[tuple[dict[str, float], Floats]]:
        places = np.unique(np.linspace(0, n, COARSE + 1).astype(int))
        scored = [
            (gain(residual, int(i), int(j)), int(i), int(j))
            for a, i in enumerate(places[:-1])
            for j in places[a + 1 :]
            if i > 0 and j - i >= 3
        ]
        best = max(scored, default=(0.0, n // 4, n // 2))
        width = max(n // COARSE // 2, 1)
        while True:
            _, i, j = best
            around = [
                (gain(residual, a, b), a, b)
                for a in {max(i - width, 1), i, i + width}
                for b in {j - width, j, min(j + width, n)}
                if b - a >= 3
            ]
            better = max(around, default=best)
            if better[0] <= best[0]:
                if width == 1:
                    break
                width = max(width // 2, 1)
            else:
                best = better
        on, off = float(edges[best[1]]), float(edges[best[2]])
        return [({"on_s": on, "off_s": off}, window(on, off))]

    return Candidate("interference_step", designs, names, "uT", SWITCH_SEARCHED)
