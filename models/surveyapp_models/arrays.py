"""The one name of an array of numbers, for every room above."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
"""Array of double-precision numbers; its shape stands in the docstring that uses it."""
