"""Whether a record determines the heading: its sigma over level headings, and held-out halves.

A condition number says nothing about the heading, and the covariance of a nearly level circle
understates itself; so two halves of the record, fitted alone, must give the same headings too.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from surveyapp.core.sensors.ellipsoid import _PLACES, Ellipsoid, matrix_of
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.heading import level_field

HEADINGS: Final = 36
"""Level headings at which the sigma is taken, every 10 degrees."""


def level_points(fit: Ellipsoid, dip: float) -> Floats:
    """What the sensor of a fit would read at level headings, shape (36, 3) [uT]."""
    psi: Floats = np.linspace(0.0, 2.0 * np.pi, HEADINGS, endpoint=False)
    field = level_field(psi, size=1.0, dip=dip)
    return np.asarray(np.linalg.solve(fit.matrix, field.T).T + fit.offset)


def heading_derivatives(theta: Floats, points: Floats) -> Floats:
    """Derivative of the level heading of readings with respect to theta, shape (n, 9) [rad]."""
    matrix = matrix_of(theta)
    d = points - theta[:3]
    u = d @ matrix
    level = u[:, 0] ** 2 + u[:, 1] ** 2
    derivative = np.empty((points.shape[0], 9))
    for k in range(9):
        if k < 3:
            dx, dy = np.full(len(d), -matrix[k, 0]), np.full(len(d), -matrix[k, 1])
        else:
            i, j = _PLACES[k - 3]
            du = np.zeros_like(d)
            du[:, i] += d[:, j]
            if i != j:
                du[:, j] += d[:, i]
            dx, dy = du[:, 0], du[:, 1]
        derivative[:, k] = (u[:, 0] * dy - u[:, 1] * dx) / level
    return derivative


def heading_sigma(fit: Ellipsoid, dip: float) -> float:
    """Largest sigma of a level heading from the covariance of a fit [rad]; inf where undefined."""
    if not fit.converged or not np.all(np.isfinite(fit.covariance)):
        return math.inf
    points = level_points(fit, dip)
    derivative = heading_derivatives(fit.theta, points)
    variance = np.sum((derivative @ fit.covariance) * derivative, axis=1)
    return float(np.sqrt(np.max(np.maximum(variance, 0.0))))


def level_headings(fit: Ellipsoid, points: Floats) -> Floats:
    """Level headings of readings, shape (n,) [rad]."""
    u = (points - fit.offset) @ fit.matrix
    return np.asarray(np.arctan2(u[:, 1], u[:, 0]))


def heading_difference(first: Ellipsoid, second: Ellipsoid, points: Floats) -> float:
    """Root mean square difference of the level headings of two fits [rad]; inf where undefined."""
    if not (first.converged and second.converged):
        return math.inf
    difference = level_headings(first, points) - level_headings(second, points)
    wrapped = (difference + np.pi) % (2.0 * np.pi) - np.pi
    return float(np.sqrt(np.mean(wrapped**2)))
