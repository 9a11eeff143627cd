"""Rotations as unit quaternions, w first, body to a navigation frame; arrays of shape (..., 4).

Pure algebra. Which frame is meant, and what turns, is said in ``attitude`` and ``turntable``.
"""

from __future__ import annotations

import math

import numpy as np

from surveyapp_models.arrays import Floats

_SMALL = 1e-8


def multiply(a: Floats, b: Floats) -> Floats:
    """Hamilton product a (x) b: first b, then a, for rotations of vectors; shapes broadcast."""
    w, x, y, z = _components(a)
    p, q, r, s = _components(b)
    return np.stack(
        [
            w * p - x * q - y * r - z * s,
            w * q + x * p + y * s - z * r,
            w * r - x * s + y * p + z * q,
            w * s + x * r - y * q + z * p,
        ],
        axis=-1,
    )


def _components(q: Floats) -> tuple[Floats, ...]:
    """The four components of quaternions, each of shape (...)."""
    values = np.asarray(q, dtype=np.float64)
    return tuple(values[..., k] for k in range(4))


def conjugate(q: Floats) -> Floats:
    """The reverse rotation of unit quaternions, shape (..., 4)."""
    return np.asarray(np.asarray(q) * np.array([1.0, -1.0, -1.0, -1.0]))


def from_rotation_vector(vector: Floats) -> Floats:
    """Quaternion of a rotation about ``vector`` by its length [rad], right-handed.

    Parameters
    ----------
    vector : ndarray, shape (..., 3)

    Returns
    -------
    ndarray, shape (..., 4)
    """
    v = np.asarray(vector, dtype=np.float64)
    half = 0.5 * np.sqrt(np.sum(v * v, axis=-1))
    ratio = np.where(half < _SMALL, 0.5 - half**2 / 12.0, 0.0)
    safe = np.where(half < _SMALL, 1.0, half)
    ratio = np.where(half < _SMALL, ratio, 0.5 * np.sin(safe) / safe)
    return np.concatenate([np.cos(half)[..., None], ratio[..., None] * v], axis=-1)


def rotation_vector(q: Floats) -> Floats:
    """Rotation vector [rad] of the shorter way, shape (..., 3)."""
    q = np.asarray(q, dtype=np.float64)
    q = np.where(q[..., :1] < 0.0, -q, q)
    size = np.sqrt(np.sum(q[..., 1:] ** 2, axis=-1))
    angle = 2.0 * np.arctan2(size, q[..., 0])
    factor = np.where(size < _SMALL, 2.0, angle / np.where(size < _SMALL, 1.0, size))
    return np.asarray(factor[..., None] * q[..., 1:])


def to_matrix(q: Floats) -> Floats:
    """Direction-cosine matrix, shape (..., 3, 3): navigation vector = matrix @ body vector."""
    w, x, y, z = _components(q)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def from_matrix(matrix: Floats) -> Floats:
    """Unit quaternion with w >= 0 of one direction-cosine matrix, shape (4,).

    Source: Shepperd 1978: the largest of the four components is formed first.
    """
    m = np.asarray(matrix, dtype=np.float64)
    trace = float(np.trace(m))
    k = int(np.argmax([trace, m[0, 0], m[1, 1], m[2, 2]]))
    if k == 0:
        w = math.sqrt(1.0 + trace) / 2.0
        vector = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
        q = np.concatenate([[w], vector / (4.0 * w)])
    else:
        i = k - 1
        j, l = (i + 1) % 3, (i + 2) % 3
        largest = math.sqrt(1.0 + m[i, i] - m[j, j] - m[l, l]) / 2.0
        q = np.zeros(4)
        q[0] = (m[l, j] - m[j, l]) / (4.0 * largest)
        q[1 + i] = largest
        q[1 + j] = (m[j, i] + m[i, j]) / (4.0 * largest)
        q[1 + l] = (m[l, i] + m[i, l]) / (4.0 * largest)
    q = q / math.sqrt(float(q @ q))
    return np.asarray(-q if q[0] < 0.0 else q)


def rotate(q: Floats, vector: Floats) -> Floats:
    """Vectors of the body in the navigation frame, shape (..., 3)."""
    v = np.asarray(vector, dtype=np.float64)
    w, u = np.asarray(q)[..., :1], np.asarray(q)[..., 1:]
    t = 2.0 * np.cross(u, v)
    return np.asarray(v + w * t + np.cross(u, t))


def rotate_back(q: Floats, vector: Floats) -> Floats:
    """Vectors of the navigation frame in the body, shape (..., 3)."""
    return rotate(conjugate(q), vector)


def integrate(rates: Floats, *, interval_s: float, start: Floats | None = None) -> Floats:
    """Attitude after each interval from rates that are constant within it.

    q(k+1) = q(k) (x) exp(w dt / 2), exact for a constant rate; equation (4), (5) of the on-line
    rotation patent in closed form. The products of blocks are formed side by side, so that a
    million samples need some two thousand steps of whole arrays and not a million of single ones.

    Parameters
    ----------
    rates : ndarray, shape (n, 3)
        Body rates against the navigation frame [rad/s].
    interval_s : float
    start : ndarray, shape (4,), optional
        Attitude before the first interval; default no rotation.

    Returns
    -------
    ndarray, shape (n + 1, 4)
        Normalised; the first row is ``start``.
    """
    first = np.array([1.0, 0.0, 0.0, 0.0]) if start is None else np.asarray(start, np.float64)
    count = rates.shape[0]
    if count == 0:
        return first[None, :].copy()
    length = max(1, math.isqrt(count))
    blocks = -(-count // length)
    steps = np.zeros((blocks * length, 4))
    steps[:, 0] = 1.0
    steps[:count] = from_rotation_vector(np.asarray(rates) * interval_s)
    grid = np.ascontiguousarray(np.moveaxis(steps.reshape(blocks, length, 4), -1, 0))
    for k in range(1, length):
        _multiply_into(grid[:, :, k - 1], grid[:, :, k])
    begins = _chained(first, grid[:, :, -1])
    full = multiply(begins[:, None, :], np.moveaxis(grid, 0, -1)).reshape(-1, 4)[:count]
    full /= np.sqrt(np.sum(full**2, axis=1))[:, None]
    return np.vstack([first[None, :], full])


def _chained(first: Floats, steps: Floats) -> Floats:
    """Products of ``first`` and the steps (4, m) before each of them, normalised, shape (m, 4).

    One quaternion after the other: plain numbers are faster than arrays of four.
    """
    w, x, y, z = first.tolist()
    found = [(w, x, y, z)]
    for p, q, r, s in steps.T[:-1].tolist():
        w, x, y, z = (
            w * p - x * q - y * r - z * s,
            w * q + x * p + y * s - z * r,
            w * r - x * s + y * p + z * q,
            w * s + x * r - y * q + z * p,
        )
        size = math.sqrt(w * w + x * x + y * y + z * z)
        w, x, y, z = w / size, x / size, y / size, z / size
        found.append((w, x, y, z))
    return np.array(found)


def _multiply_into(a: Floats, b: Floats) -> None:
    """Replace b by a (x) b; component first, shape (4, m)."""
    w, x, y, z = a
    p, q, r, s = b.copy()
    b[0] = w * p - x * q - y * r - z * s
    b[1] = w * q + x * p + y * s - z * r
    b[2] = w * r - x * s + y * p + z * q
    b[3] = w * s + x * r - y * q + z * p


def body_rates(q: Floats, *, interval_s: float) -> Floats:
    """Mean body rates between successive attitudes, shape (n - 1, 3) [rad/s]."""
    return rotation_vector(multiply(conjugate(q[:-1]), q[1:])) / interval_s
