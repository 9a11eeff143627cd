"""Deviation of a compass against the heading: the classical coefficients A to E.

known minus shown = A + B sin psi + C cos psi + D sin 2psi + E cos 2psi, psi the known magnetic
heading. A: index error; B, C: hard iron; D, E: soft iron. Source: Archibald Smith 1843, Admiralty
Manual for the Deviations of the Compass, with the sign of a correction.
"""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats

COEFFICIENTS = ("A", "B", "C", "D", "E")


def deviation_basis(psi: Floats) -> Floats:
    """Design of the five coefficients, shape (n, 5), of headings [rad]."""
    return np.column_stack(
        [np.ones(psi.size), np.sin(psi), np.cos(psi), np.sin(2.0 * psi), np.cos(2.0 * psi)]
    )


def undeviated(shown: Floats, coefficients: Floats) -> Floats:
    """Known heading from a shown one: psi = shown + deviation(psi), solved by iteration.

    Parameters
    ----------
    shown : ndarray, shape (n,)
        [rad]
    coefficients : ndarray, shape (5,)
        A to E [rad]; the iteration contracts while |B| + |C| + 2|D| + 2|E| < 1.

    Returns
    -------
    ndarray, shape (n,)
        In [0, 2 pi) [rad].
    """
    psi = np.array(shown, dtype=np.float64)
    for _ in range(100):
        new = shown + deviation_basis(psi) @ coefficients
        done = float(np.max(np.abs(new - psi), initial=0.0)) < 1e-13
        psi = new
        if done:
            break
    return np.asarray(psi % (2.0 * np.pi))
