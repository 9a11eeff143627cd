"""Sensor logs as records of the loop: block means, base model, and the designs of the effects.

Compass with a reference attitude: the field vector in the body; without: |m|^2 / 2F, which is
exactly linear in hard and soft iron. Tilt: both axes against their reference.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.candidates import missing_columns
from surveyapp.diagnosis.sensors.field_size import possible_iron, size_candidates
from surveyapp.diagnosis.sensors.loop import Candidate, Data
from surveyapp.diagnosis.sensors.noise import along, whiteners
from surveyapp.diagnosis.sensors.room import room_columns
from surveyapp.diagnosis.sensors.turn import turn
from surveyapp.diagnosis.sensors.windows import Blocks, block_means, blocks_of, switch
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Effect

Mask = NDArray[np.bool_]

SPECIAL: Final = frozenset({"interference_step", "misalignment"})
"""Effects that are searched for in ways of their own: to the row, and about the turn found."""

MOST_GROSS: Final = 0.01
"""Share of the rows above which they are no gross errors but how the record is."""

GROSS: Final = 8.0
"""Single readings that leave their neighbours by so many robust sigma are gross errors."""


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
    missing : tuple of (str, str)
        Effects of the catalogue that the record cannot show, and what it lacks.
    own : tuple of Effect
        The user's.
    room : callable or None
        Makes the fields that a room may have along the path, shape (n, d, k); None without a path.
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
    missing: tuple[tuple[str, str], ...] = ()
    own: tuple[Effect, ...] = ()
    room: Callable[[], Floats] | None = None

    @property
    def data(self) -> Data:
        """What the loop fits."""
        rivals = whiteners(len(self.observed))
        if self.mode == "size" and self.mag is not None:
            mean = block_means(self.mag, self.block)
            length = np.linalg.norm(mean, axis=1)
            rivals += along(mean / np.maximum(length, 1e-9)[:, None])
        return Data(self.observed, self.base, rivals)


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

    Its neighbours agree with each other, as across a switch they do not. Two wrong readings in a
    row are looked for as a pair.
    """
    if len(residual) < 8:
        return []
    second = residual[1:-1] - 0.5 * (residual[:-2] + residual[2:])
    spread = 1.4826 * np.median(np.abs(second - np.median(second, axis=0)), axis=0)
    if np.any(spread <= 0.0):
        return []
    size = np.sqrt(np.sum((second / spread) ** 2, axis=1))
    across = np.sqrt(np.sum(((residual[2:] - residual[:-2]) / spread) ** 2, axis=1))
    limit = GROSS * math.sqrt(residual.shape[1])
    places = np.flatnonzero((size > limit) & (across < 0.5 * size))
    found = {int(i) + 1: float(np.linalg.norm(second[i])) for i in places}
    # a good reading between two wrong ones that are alike leaves both of them as well
    found = {row: s for row, s in found.items() if not {row - 1, row + 1} <= found.keys()}
    found |= _gross_pairs(residual, spread, limit, taken=found)
    if len(found) > max(MOST_GROSS * len(residual), 3.0):
        return []
    return sorted(found.items())


def _gross_pairs(
    residual: Floats, spread: Floats, limit: float, *, taken: Mapping[int, float]
) -> dict[int, float]:
    """Two wrong readings in a row: both leave the line between their neighbours, which agree."""
    before, after = residual[:-3], residual[3:]
    first = residual[1:-2] - (2.0 * before + after) / 3.0
    second = residual[2:-1] - (before + 2.0 * after) / 3.0
    across, one, other = (
        np.sqrt(np.sum((d / spread) ** 2, axis=1)) for d in (after - before, first, second)
    )
    least = np.minimum(one, other)
    found: dict[int, float] = {}
    for i in np.flatnonzero((least > limit) & (across < 0.5 * least)).tolist():
        if not {i, i + 1, i + 2, i + 3} & (set(taken) | set(found)):
            found[i + 1] = float(np.linalg.norm(first[i]))
            found[i + 2] = float(np.linalg.norm(second[i]))
    return found


def compass_record(log: SensorLog, own: tuple[Effect, ...] = ()) -> SensorRecord:
    """Record of a compass log; the vector where a reference attitude stands beside it.

    Parameters
    ----------
    log : SensorLog
    own : tuple of Effect
        The user's, for the subject ``compass``.
    """
    q = log.quaternion()
    effects = (*of_subject("compass"), *own)
    if q is not None:
        return replace(_vector_record(log, rotation_matrices(q), effects), own=own)
    return replace(_size_record(log, effects), own=own)


def _mag(log: SensorLog) -> Floats:
    return np.column_stack([log.columns[f"mag_{axis}_uT"] for axis in "xyz"])


def _axis_columns(log: SensorLog, kept: Mask, field: Floats) -> dict[str, Floats]:
    """Columns of the catalogue, three rows a time; ``field`` (n, 3) is the undisturbed one."""
    count = field.shape[0]
    columns: dict[str, Floats] = {
        "axis": np.tile(np.arange(3.0), count),
        "time_s": np.repeat(log.columns["time_s"][kept], 3),
        **{f"field_{a}": np.repeat(field[:, i], 3) for i, a in enumerate("xyz")},
    }
    theta = log.columns.get("temperature_c")
    if theta is not None:
        columns["temperature_c"] = np.repeat(theta[kept], 3)
    place = log.vector("ref_p")
    if place is not None:
        at = (place - place.mean(axis=0))[kept]
        columns |= {f"place_{a}": np.repeat(at[:, i], 3) for i, a in enumerate("xyz")}
    for name, values in log.columns.items():
        columns.setdefault(name, np.repeat(values[kept], 3))
    return columns


def _catalogued(
    effects: Sequence[Effect], columns: Mapping[str, Floats], block: Blocks, along: Floats | None
) -> tuple[list[Candidate], list[tuple[str, str]]]:
    """Candidates of the catalogue, and what others lack.

    Parameters
    ----------
    effects : sequence of Effect
    columns : mapping
        d rows a time.
    block : ndarray of int, shape (n,)
    along : ndarray, shape (n, d), or None
        Direction on which the rows of a time are projected; None = each row by itself.
    """
    found, missing = [], []
    for effect in effects:
        if effect.acts_on == "observation" or effect.id in SPECIAL:
            continue
        lacking = missing_columns(effect, columns)
        if lacking:
            missing.append((effect.id, lacking))
            continue
        found.append(_candidate(effect, columns, block, along))
    return found, missing


def _candidate(
    effect: Effect, columns: Mapping[str, Floats], block: Blocks, along: Floats | None
) -> Candidate:
    made: list[tuple[dict[str, float], Floats]] = []

    def rows(point: Mapping[str, float]) -> Floats:
        basis = effect.basis(columns, **point)
        whole = basis.reshape(block.size, -1, basis.shape[1])
        if along is None:
            return np.asarray(whole)
        return np.asarray(np.einsum("nd,ndk->nk", along, whole)[:, None, :])

    def designs(residual: Floats) -> Sequence[tuple[dict[str, float], Floats]]:
        del residual
        if not made:
            points = effect.grid_points(columns)
            made.extend((point, block_means(rows(point), block)) for point in points)
        return made

    return Candidate(
        effect.id,
        designs,
        tuple(c.name for c in effect.coefficients),
        effect.coefficients[0].unit,
        len(effect.grid),
        1.0 / effect.coefficients[0].scale,
        rows,
    )


def _vector_record(log: SensorLog, matrices: Floats, effects: tuple[Effect, ...]) -> SensorRecord:
    mag = _mag(log)
    base_rows = np.swapaxes(matrices, 1, 2)  # body = R' level
    n = len(mag)
    with_iron = np.concatenate([base_rows, np.tile(np.eye(3), (n, 1, 1))], axis=2)
    solution = np.linalg.lstsq(with_iron.reshape(3 * n, 6), mag.ravel(), rcond=1e-9)[0]
    level = solution[:3]
    gross = gross_rows(mag - base_rows @ level)
    kept = np.ones(n, dtype=bool)
    kept[[row for row, _ in gross]] = False
    block = blocks_of(int(kept.sum()))
    columns = _axis_columns(log, kept, (base_rows @ level)[kept])
    columns |= {f"level_{a}": base_rows[kept][:, :, j].ravel() for j, a in enumerate("xyz")}
    candidates, missing = _catalogued(effects, columns, block, None)
    candidates.append(turn((base_rows @ level)[kept], base_rows[kept], block))
    used, place = log.columns["time_s"][kept], log.vector("ref_p")
    eye = np.tile(np.eye(3), (used.size, 1, 1))
    candidates.append(
        switch(used, block, eye, ("step_x", "step_y", "step_z"), base_rows=base_rows[kept])
    )
    return SensorRecord(
        "compass", "uT", used, block, mag[kept], base_rows[kept],
        block_means(mag[kept], block), block_means(base_rows[kept], block), tuple(candidates),
        eye, tuple(gross), "vector", matrices[kept], mag[kept], missing=tuple(missing),
        room=None if place is None else partial(room_columns, place[kept], matrices[kept], block),
    )  # fmt: skip


def _size_record(log: SensorLog, effects: tuple[Effect, ...]) -> SensorRecord:
    """Half the square of the field's size over its mean: linear in what is added along the field.

    What a switch and a temperature add is seen with its own square, the gradient of a place as any
    quadratic function of the place.
    """
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
    columns = _axis_columns(log, kept, used)
    # the attitude is not known: no turn against it, and the gradient has a form of its own
    unseen = [e for e in effects if e.id not in ("misalignment", "field_gradient", "temperature")]
    candidates, missing = _catalogued(unseen, columns, block, used / scale)
    candidates = [
        replace(c, possible=possible_iron) if c.id == "soft_iron" else c for c in candidates
    ]
    missing.append(("misalignment", said("no reference attitude (ref_q)")))
    candidates += size_candidates(columns, missing, m, block)
    time = log.columns["time_s"][kept]
    step = np.concatenate([m, one], axis=2)
    step_names = ("step_x", "step_y", "step_z", "step_size")
    candidates.append(switch(time, block, step, step_names, base_rows=one))
    return SensorRecord(
        "compass", "uT", time, block, y, one, block_means(y, block), block_means(one, block),
        tuple(candidates), step, tuple(gross), "size", None, used, scale, tuple(missing),
    )  # fmt: skip


def tilt_record(log: SensorLog, own: tuple[Effect, ...] = ()) -> SensorRecord:
    """Record of a two-axis tilt log: zero and scale of each axis are the base.

    Parameters
    ----------
    log : SensorLog
    own : tuple of Effect
        The user's, for the subject ``tilt``.
    """
    axes = ("along", "across")
    reading = np.column_stack([log.columns[f"tilt_{a}_arcsec"] for a in axes])
    true = np.column_stack([log.columns[f"ref_{a}_arcsec"] for a in axes])
    n = log.size
    base = np.zeros((n, 2, 4))
    for i in range(2):
        base[:, i, i], base[:, i, 2 + i] = 1.0, true[:, i]
    fit = np.linalg.lstsq(base.reshape(2 * n, 4), reading.ravel(), rcond=1e-12)[0]
    gross = _outliers(reading - base @ fit)
    kept = np.ones(n, dtype=bool)
    kept[[row for row, _ in gross]] = False
    time = log.columns["time_s"] if log.has("time_s") else np.arange(n, dtype=np.float64)
    columns: dict[str, Floats] = {
        "axis": np.tile(np.arange(2.0), int(kept.sum())),
        "time_s": np.repeat(time[kept], 2),
        "reference": true[kept].ravel(),
        "other_reference": true[kept][:, ::-1].ravel(),
    }
    for name, values in log.columns.items():
        columns.setdefault(name, np.repeat(values[kept], 2))
    block = blocks_of(int(kept.sum()), 400)
    candidates, missing = _catalogued((*of_subject("tilt"), *own), columns, block, None)
    return SensorRecord(
        "tilt", "arcsec", time[kept], block, reading[kept], base[kept],
        block_means(reading[kept], block), block_means(base[kept], block), tuple(candidates),
        None, tuple(gross), "axes", missing=tuple(missing), own=own,
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
