"""How a magnetometer sits in its body, where a reference attitude was recorded beside it.

An ellipsoid leaves the rotation of the sensor open: what turns all readings alike keeps them on it.
With the attitude R of the body (body to a level frame whose azimuth is free) the corrected field u
must satisfy R Q u = h, h constant, Q the rotation from sensor to body. The turn w is signed as the
effect ``misalignment`` of the catalogue: the sensor reads exp(w) times the field of its body.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.sensors.compass_models import BETTER, FORESEEN, TENTHS, block_rows, gains
from surveyapp.core.sensors.heading_gate import HEADINGS
from surveyapp.core.sensors.linear import alternate_blocks, correlation_inflation
from surveyapp.domain.calibration import Calibration, CalibrationModel, SensorParameter
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.heading import level_field
from surveyapp_models.rate.quaternions import from_rotation_vector, to_matrix

Mask = NDArray[np.bool_]

NAMES: Final = tuple(f"misalignment_{axis}" for axis in "xyz")
MOST_ROWS: Final = 20_000
"""Of a longer record every k-th row: the turn of a mounting is known long before."""

FEWEST_ROWS: Final = 40
ROUNDS: Final = 8


@dataclass(frozen=True, slots=True)
class _Turn:
    """w [rad], its covariance, h [uT], and the residuals, shape (n, 3) [uT]."""

    vector: Floats
    covariance: Floats
    level: Floats
    residual: Floats


def turned_back(field: Floats, vector: Floats) -> Floats:
    """Field in the axes of the body from that of a sensor turned by ``vector`` [rad]."""
    return np.asarray(field @ to_matrix(from_rotation_vector(-vector)).T)


def with_attitude(found: Calibration, log: SensorLog, *, limit: float) -> Calibration:
    """The calibration with the misalignment of the sensor, where held-out blocks ask for it.

    Parameters
    ----------
    found : Calibration
        Of the ellipsoid.
    log : SensorLog
        With ``ref_q*``; without, the calibration is returned as it is.
    limit : float
        Largest sigma of a level heading that is accepted [rad].
    """
    q = log.quaternion()
    if q is None:
        return found
    if found.geometry.verdict == "refused":
        return _undetermined(found, None)
    data = _data(found, log, q)
    if data is None:
        return _undetermined(found, "the reference attitude is not recorded throughout")
    field, matrices, block = data
    turn = _fit(field, matrices)
    if turn is None:
        return _undetermined(found, "the attitudes do not determine the turn of the sensor")
    sigma = _heading_sigma(turn, math.radians(float(found.extra.get("dip_deg", 65.0))))
    before, after = (_held_out(field, matrices, block, turned=turned) for turned in (False, True))
    better = gains(_means(before, block) - _means(after, block), BETTER) and gains(
        _tenths(field, matrices, turned=False) - _tenths(field, matrices, turned=True), FORESEEN
    )
    plain = _plain(field, matrices)
    told = {
        "rms_before": _rms(plain),
        "rms_after": _rms(turn.residual),
        "held_out_before": float(np.sqrt(np.mean(before))),
        "held_out_after": float(np.sqrt(np.mean(after))),
        "unit": "uT",
        "of": "vector of the corrected field against the reference attitude",
    }
    if better and sigma > limit:
        text = "the attitudes vary too little to determine the turn of the sensor: tilt it more"
        return _undetermined(found, text, attitude=told)
    return _result(found, turn, (sigma, limit), attitude=told, chosen=better)


def _data(found: Calibration, log: SensorLog, q: Floats) -> tuple[Floats, Floats, int] | None:
    """Corrected field, attitudes and rows of a block; None where rows lack their attitude."""
    every = max(log.size // MOST_ROWS, 1)
    q = q[::every]
    length = np.linalg.norm(q, axis=1)
    usable: Mask = np.isfinite(length) & (length > 0.0)
    if np.count_nonzero(usable) < FEWEST_ROWS:
        return None
    w = np.array(
        [
            [found.constants[f"used_soft_iron_{''.join(sorted(a + b))}"] for b in "xyz"]
            for a in "xyz"
        ]
    )
    hard = np.array([found.constants[f"used_hard_iron_{a}"] for a in "xyz"])
    points = np.column_stack([log.columns[f"mag_{a}_uT"][::every] for a in "xyz"])
    field = (points[usable] - hard) @ w
    matrices = to_matrix(q[usable] / length[usable, None])
    return field, matrices, max(block_rows(log) // every, 1)


def _plain(field: Floats, matrices: Floats) -> Floats:
    """Residuals about a constant level field, shape (n, 3), in the level frame."""
    level = np.einsum("nij,nj->ni", matrices, field)
    return np.asarray(level - level.mean(axis=0))


def _fit(field: Floats, matrices: Floats) -> _Turn | None:
    """Gauss-Newton for the turn from sensor to body, and h; None where it has a rank defect."""
    q = np.eye(3)
    back = -np.swapaxes(matrices, 1, 2)
    level = np.einsum("nij,nj->i", matrices, field) / len(field)
    design = np.empty((len(field), 3, 6))
    design[:, :, 3:] = back
    for _ in range(ROUNDS):
        body = field @ q.T
        design[:, :, :3] = np.stack([np.cross(axis, body) for axis in np.eye(3)], axis=2)
        rest = body + np.einsum("nij,j->ni", back, level)
        solution, _, rank, _ = np.linalg.lstsq(design.reshape(-1, 6), -rest.ravel(), rcond=1e-9)
        if rank < 6:
            return None
        q = to_matrix(from_rotation_vector(solution[:3])) @ q
        level = level + solution[3:]
        if float(np.max(np.abs(solution[:3]))) < 1e-10:
            break
    body = field @ q.T
    rest = body + np.einsum("nij,j->ni", back, level)
    normal = np.einsum("nki,nkj->ij", design, design)
    wide = max(correlation_inflation(rest[:, axis]) for axis in range(3))
    variance = float(np.sum(rest**2)) / max(rest.size - 6, 1) * wide**2
    covariance = np.linalg.inv(normal)[:3, :3] * variance
    angle = math.acos(float(np.clip((np.trace(q) - 1.0) / 2.0, -1.0, 1.0)))
    axial = np.array([q[2, 1] - q[1, 2], q[0, 2] - q[2, 0], q[1, 0] - q[0, 1]])
    size = float(np.linalg.norm(axial))
    vector = axial / size * angle if size > 0.0 else np.zeros(3)
    return _Turn(-vector, covariance, level, rest)


def _predicted(
    field: Floats, matrices: Floats, used: Mask, held: Mask, *, turned: bool
) -> Floats | None:
    """Squares of the residuals of held rows by the turn and level field of the used ones."""
    if not turned:
        level = np.einsum("nij,nj->ni", matrices, field)
        return np.asarray(np.sum((level[held] - level[used].mean(axis=0)) ** 2, axis=1))
    turn = _fit(field[used], matrices[used])
    if turn is None:
        return None
    body = turned_back(field[held], turn.vector)
    expected = np.einsum("nji,j->ni", matrices[held], turn.level)
    return np.asarray(np.sum((body - expected) ** 2, axis=1))


def _held_out(field: Floats, matrices: Floats, block: int, *, turned: bool) -> Floats:
    """Squares of the residuals of rows that had no part in the fit, shape (n,) [uT^2]."""
    squares = np.full(len(field), np.inf)
    for used, held in alternate_blocks(len(field), block):
        predicted = _predicted(field, matrices, used, held, turned=turned)
        if predicted is not None:
            squares[held] = predicted
    return squares


def _tenths(field: Floats, matrices: Floats, *, turned: bool) -> Floats:
    """Mean squares of contiguous tenths, each predicted from the other nine, shape (10,)."""
    number = np.arange(len(field)) * TENTHS // len(field)
    squares = np.full(TENTHS, np.inf)
    for tenth in range(TENTHS):
        held = number == tenth
        predicted = _predicted(field, matrices, ~held, held, turned=turned)
        if predicted is not None:
            squares[tenth] = float(np.mean(predicted))
    return squares


def _means(squares: Floats, block: int) -> Floats:
    """Of each block of so many rows."""
    number = np.arange(len(squares)) // block
    return np.asarray(np.bincount(number, weights=squares) / np.bincount(number))


def _rms(residual: Floats) -> float:
    return float(np.sqrt(np.mean(np.sum(residual**2, axis=1))))


def _heading_sigma(turn: _Turn, dip: float) -> float:
    """Largest sigma of a level heading from the covariance of the turn alone [rad]."""
    psi = np.linspace(0.0, 2.0 * np.pi, HEADINGS, endpoint=False)
    b = level_field(psi, size=1.0, dip=dip)
    level = b[:, 0] ** 2 + b[:, 1] ** 2
    derivative = np.empty((HEADINGS, 3))
    for k, axis in enumerate(np.eye(3)):
        change = np.cross(axis, b)
        derivative[:, k] = (b[:, 0] * change[:, 1] - b[:, 1] * change[:, 0]) / level
    variance = np.sum((derivative @ turn.covariance) * derivative, axis=1)
    return float(np.sqrt(np.max(variance)))


def _undetermined(
    found: Calibration, why: str | None, *, attitude: Mapping[str, object] | None = None
) -> Calibration:
    """The calibration with a turn that is not known."""
    reason = "refused" if found.geometry.verdict == "refused" else "attitude"
    rows = tuple(SensorParameter(name, None, None, "deg", reason) for name in NAMES)
    geometry = replace(found.geometry, undetermined=(*found.geometry.undetermined, *NAMES))
    warnings = found.warnings
    if why is not None:
        warnings = (*warnings, ResultWarning("misalignment", why))
    models = (*found.models, _model(attitude, chosen=False))
    return replace(
        found,
        parameters=(*found.parameters, *rows),
        geometry=geometry,
        models=models,
        warnings=warnings,
        extra={**found.extra, "attitude": attitude},
    )


def _model(attitude: Mapping[str, object] | None, *, chosen: bool) -> CalibrationModel:
    values = attitude or {}
    rms, held = values.get("rms_after"), values.get("held_out_after")
    before = values.get("rms_before")
    return CalibrationModel(
        "misalignment",
        rms if isinstance(rms, float) else None,
        held if isinstance(held, float) and math.isfinite(held) else None,
        chosen,
        "uT",
        said("vector of the field in the level frame")
        if before is None
        else said(
            "vector of the field in the level frame; {before:.4g} without the turn", before=before
        ),
    )


def _result(
    found: Calibration,
    turn: _Turn,
    gate: tuple[float, float],
    *,
    attitude: Mapping[str, object],
    chosen: bool,
) -> Calibration:
    sigma = np.sqrt(np.diag(turn.covariance))
    rows = tuple(
        SensorParameter(
            name,
            math.degrees(turn.vector[i]) if chosen else 0.0,
            math.degrees(sigma[i]) if chosen else None,
            "deg",
        )
        for i, name in enumerate(NAMES)
    )
    models: Sequence[CalibrationModel] = found.models
    constants, geometry = dict(found.constants), found.geometry
    if chosen:
        models = [replace(item, chosen=False) for item in models]
        for name, value in zip(NAMES, np.degrees(turn.vector), strict=True):
            constants[f"used_{name}"] = float(value)
        whole = math.hypot(constants["heading_sigma_deg"], math.degrees(gate[0]))
        constants["heading_sigma_deg"] = whole
        geometry = replace(geometry, heading_sigma_deg=whole)
    return replace(
        found,
        parameters=(*found.parameters, *rows),
        geometry=geometry,
        models=(*models, _model(attitude, chosen=chosen)),
        constants=constants,
        extra={**found.extra, "attitude": attitude},
    )
