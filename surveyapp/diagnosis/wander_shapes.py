"""Covariances of noise that wanders, which every record's rivals are made of."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats


def walk_of(place: Floats) -> Floats:
    """Random walk of unit variance a step, begun one step before place 0, shape (n, n).

    Parameters
    ----------
    place : ndarray, shape (n,)
        Of each observation in steps, from 0.
    """
    return np.asarray(np.minimum.outer(place, place) + 1.0)


def decay_of(lag: Floats, correlation: float) -> Floats:
    """AR(1) of unit variance: the correlation of neighbours to the power of the steps between."""
    return np.asarray(correlation**lag)
