"""Ellipsoid through magnetic field vectors: hard and soft iron by orthogonal distance.

Corrected field u = W (m - b), |u| = field, W symmetric with determinant 1. What is minimised is
the distance of each point from the surface to first order (Sampson 1982): r = (s - 1) / |grad s|
with s = |A (m - b)| and A = W / field. Minimising s - 1 itself lets the radius run away on a
record that covers a band only. Which model serves, and whether the record can tell, is decided
elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp_models.arrays import Floats

MODELS: Final = ("none", "centre", "scales", "full")
"""Increasing models: size of the field alone; hard iron; a scale for each axis; symmetric W."""

SOFT: Final = ("xx", "yy", "zz", "xy", "xz", "yz")
_PLACES: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))

ROUNDS: Final = 40
CONVERGED: Final = 1e-9
"""Relative change of the sum of squares at which the fit ends."""


@dataclass(frozen=True, slots=True)
class Ellipsoid:
    """A fitted ellipsoid.

    Parameters
    ----------
    model : str
        One of ``MODELS``.
    theta : ndarray, shape (9,)
        b [uT], then A_xx, yy, zz, xy, xz, yz [1/uT].
    active : ndarray, shape (9, p)
        How theta follows from the p parameters of the model: theta = theta0 + active @ x.
    covariance : ndarray, shape (9, 9)
        Of theta, from the residuals.
    residual : ndarray, shape (n,)
        Distance of each point from the surface [uT].
    sigma0 : float
        sqrt(v'v / dof) [uT].
    condition : float
        Of the design with its columns scaled to unit length.
    converged : bool
        Also False where A is not positive definite: the surface is no ellipsoid.
    """

    model: str
    theta: Floats
    active: Floats
    covariance: Floats
    residual: Floats
    sigma0: float
    condition: float
    converged: bool

    @property
    def matrix(self) -> Floats:
        """A, shape (3, 3) [1/uT]."""
        return matrix_of(self.theta)

    @property
    def field(self) -> float:
        """Size of the field [uT]: det(A)^(-1/3)."""
        determinant = float(np.linalg.det(self.matrix))
        return determinant ** (-1.0 / 3.0) if determinant > 0.0 else float("nan")

    @property
    def offset(self) -> Floats:
        """Hard iron b, shape (3,) [uT]."""
        return self.theta[:3]

    @property
    def soft(self) -> Floats:
        """W, shape (3, 3), determinant 1."""
        return self.matrix * self.field

    @property
    def rms(self) -> float:
        """Root mean square distance [uT]."""
        return float(np.sqrt(np.mean(self.residual**2)))

    def corrected(self, points: Floats) -> Floats:
        """W (m - b), shape (n, 3) [uT]."""
        return (points - self.offset) @ self.soft.T


def matrix_of(theta: Floats) -> Floats:
    """A of the nine parameters, shape (3, 3)."""
    xx, yy, zz, xy, xz, yz = theta[3:]
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _length(vectors: Floats) -> Floats:
    return np.asarray(np.sqrt(np.einsum("ni,ni->n", vectors, vectors)))


def distances(points: Floats, theta: Floats) -> Floats:
    """Sampson distance of points from the surface, shape (n,) [uT]."""
    matrix = matrix_of(theta)
    u = (points - theta[:3]) @ matrix
    s = _length(u)
    g = _length(u @ matrix) / s
    return np.asarray((s - 1.0) / g)


_FIRST: Final = np.array([i for i, _ in _PLACES])
_SECOND: Final = np.array([j for _, j in _PLACES])
_SHARE: Final = np.where(_FIRST == _SECOND, 0.5, 1.0)


def _symmetric(a: Floats, b: Floats) -> Floats:
    """Derivatives of a A b with respect to the six terms of a symmetric A, shape (n, 6)."""
    return np.asarray(_SHARE * (a[:, _FIRST] * b[:, _SECOND] + a[:, _SECOND] * b[:, _FIRST]))


def _linearised(points: Floats, theta: Floats) -> tuple[Floats, Floats]:
    """Distances and their derivatives with respect to theta, shapes (n,) and (n, 9).

    With n = u / s, w = A n, g = |w|: ds = n du, dg = (w dA n + (A w) (du - n ds) / s) / g.
    """
    matrix = matrix_of(theta)
    d = points - theta[:3]
    u = d @ matrix
    s = _length(u)
    n = u / s[:, None]
    w = n @ matrix
    g = _length(w)
    r = (s - 1.0) / g
    wm = w @ matrix
    ds = np.concatenate([-w, _symmetric(n, d)], axis=1)
    turned = np.concatenate([-(wm @ matrix), _symmetric(wm, d)], axis=1)
    dg = (turned - (g**2)[:, None] * ds) / s[:, None]
    dg[:, 3:] += _symmetric(w, n)
    return r, np.asarray((ds - (r / g)[:, None] * dg) / g[:, None])


def _active(model: str) -> Floats:
    """Columns of theta that a model moves."""
    if model == "none":
        return np.array([[0.0] * 3 + [1.0] * 3 + [0.0] * 3]).T
    eye = np.eye(9)
    if model == "centre":
        return np.column_stack([eye[:, :3], eye[:, 3:6].sum(axis=1)])
    return eye[:, :6] if model == "scales" else eye


def _start(points: Floats, model: str) -> Floats:
    """Sphere by linear least squares: |m|^2 = 2 b m + c; none: the mean size."""
    theta = np.zeros(9)
    if model == "none":
        theta[3:6] = 1.0 / np.mean(np.linalg.norm(points, axis=1))
        return theta
    middle = points.mean(axis=0)
    q = points - middle
    design = np.column_stack([2.0 * q, np.ones(len(q))])
    solution = np.linalg.lstsq(design, np.sum(q**2, axis=1), rcond=1e-8)[0]
    radius = float(np.sqrt(max(solution[3] + solution[:3] @ solution[:3], 1e-6)))
    theta[:3] = middle + solution[:3]
    theta[3:6] = 1.0 / radius
    return theta


def fit_ellipsoid(points: Floats, model: str, *, start: Floats | None = None) -> Ellipsoid:
    """Fit a model by Levenberg-Marquardt on the distances.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        [uT]; more of them than the model has parameters.
    model : str
        One of ``MODELS``.
    start : ndarray, shape (9,), optional

    Returns
    -------
    Ellipsoid
    """
    active = _active(model)
    theta = _start(points, model) if start is None else start.copy()
    r, jacobian = _linearised(points, theta)
    total, damping, converged = float(r @ r), 1e-3, False
    for _ in range(ROUNDS):
        design = jacobian @ active
        scale = np.sqrt(np.sum(design**2, axis=0)) + 1e-300
        scaled = design / scale
        normal = scaled.T @ scaled
        gradient = scaled.T @ r
        step = np.linalg.solve(normal + damping * np.eye(len(scale)), -gradient) / scale
        trial = theta + active @ step
        usable = bool(np.all(np.isfinite(trial))) and float(np.linalg.det(matrix_of(trial))) > 0.0
        trial_total = float("inf")
        if usable:
            distance = distances(points, trial)
            trial_total = float(distance @ distance)
        if trial_total <= total * (1.0 + 1e-14):
            small = total - trial_total <= CONVERGED * max(total, 1e-300)
            theta, total = trial, trial_total
            r, jacobian = _linearised(points, theta)
            damping = max(damping * 0.2, 1e-12)
            if small:
                converged = True
                break
        else:
            damping *= 8.0
            if damping > 1e12:
                converged = True
                break
    return _finished(points, model, theta, (active, r, jacobian), converged=converged)


def _finished(
    points: Floats,
    model: str,
    theta: Floats,
    state: tuple[Floats, Floats, Floats],
    *,
    converged: bool,
) -> Ellipsoid:
    active, r, jacobian = state
    design = jacobian @ active
    scale = np.sqrt(np.sum(design**2, axis=0)) + 1e-300
    singular = np.linalg.svd(np.linalg.qr(design / scale, mode="r"), compute_uv=False)
    p = design.shape[1]
    dof = max(points.shape[0] - p, 1)
    sigma0 = float(np.sqrt(r @ r / dof))
    condition = float(singular[0] / singular[-1]) if singular[-1] > 0.0 else float("inf")
    if condition < 1e12:
        inverse = np.linalg.inv((design / scale).T @ (design / scale))
        covariance = sigma0**2 * inverse / np.outer(scale, scale)
    else:
        covariance = np.full((p, p), np.inf)
    with np.errstate(invalid="ignore"):
        whole = active @ covariance @ active.T
    definite = bool(np.all(np.linalg.eigvalsh(matrix_of(theta)) > 0.0))
    return Ellipsoid(model, theta, active, whole, r, sigma0, condition, converged and definite)
