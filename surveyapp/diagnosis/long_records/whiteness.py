"""Whether neighbouring block means are still correlated.

Von Neumann's ratio of what is left beside the neighbours on both sides, so that a drift, a step or
any other slow change that an effect may explain is not taken for correlation. The null is simulated
through the same model and the same comparison, never taken from a table. Wandering that is slower
than the neighbourhood is not judged here: the stochastic rivals of the diagnosis are for that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surveyapp_models.arrays import Floats

REACH = 5
"""Neighbours on either side with which a block mean is compared."""
BENT = 15
"""Places over which a bend of the record, which leaves the same everywhere near, is taken out."""
LEFT_OUT = 3.0
"""Standard deviations beyond which what is left does not count: there is a step or a slip."""
MAD_TO_SIGMA = 1.4826
"""Standard deviation of a normal distribution in units of its median absolute deviation."""
DRAWS = 1000
LEVEL = 0.05


@dataclass(frozen=True, slots=True)
class Whiteness:
    """The test at one number of blocks.

    Parameters
    ----------
    blocks : int
    ratio : float
        Of von Neumann, small where neighbours agree.
    p : float
        Share of white records with a ratio as small.
    """

    blocks: int
    ratio: float
    p: float

    @property
    def white(self) -> bool:
        """Whether independence is not refuted."""
        return self.p > LEVEL


def whiteness(values: Floats, design: Floats, root: Floats, seed: int) -> Whiteness:
    """Test block means for correlation of neighbours.

    Parameters
    ----------
    values : ndarray, shape (m,)
        In their order [SI].
    design : ndarray, shape (m, p)
        What the model that stands may explain, not weighted.
    root : ndarray, shape (m,)
        Root weights.
    seed : int

    Returns
    -------
    Whiteness

    Notes
    -----
    Source: Fishman 1978, Grouping observations in digital simulation, Management Science 24: means
    of ever longer batches until von Neumann's ratio no longer refutes their independence.
    """
    weighted = design * root[:, None]
    norms = np.sqrt((weighted**2).sum(axis=0))
    u, s, _ = np.linalg.svd(weighted / np.where(norms > 0.0, norms, 1.0), full_matrices=False)
    q = u[:, s > 1e-9 * s[0]]
    draws = np.random.default_rng(seed).standard_normal((DRAWS, values.size))
    null = _ratio(draws, q, root)
    seen = float(_ratio((values * root)[None, :], q, root)[0])
    return Whiteness(values.size, seen, (1.0 + float((null <= seen).sum())) / (DRAWS + 1.0))


def _ratio(sample: Floats, q: Floats, root: Floats) -> Floats:
    """Von Neumann's ratio of each row (d, m), beside the model and its neighbours."""
    residual = (sample - (sample @ q) @ q.T) / root
    rest = beside_neighbours(residual) * root[REACH:-REACH]
    middle = np.median(np.abs(rest), axis=1, keepdims=True)
    spread = np.sqrt((rest**2).mean(axis=1, keepdims=True))
    limit = LEFT_OUT * np.where(middle > 0.0, MAD_TO_SIGMA * middle, spread)
    rest = np.where(np.abs(rest) <= limit, rest, 0.0)
    total = np.maximum((rest**2).sum(axis=1), 1e-300)
    return np.asarray((np.diff(rest, axis=1) ** 2).sum(axis=1) / total)


def beside_neighbours(rows: Floats) -> Floats:
    """Each value less the median of the means of pairs of neighbours, shape (d, m - 2 REACH).

    Both of a pair are equally far away, so that a straight line leaves nothing. A bend leaves a
    slowly changing value, which its running median takes out; a step is left in few places.
    """
    count = rows.shape[1]
    pairs = [
        0.5 * (rows[:, REACH - j : count - REACH - j] + rows[:, REACH + j : count - REACH + j])
        for j in range(1, REACH + 1)
    ]
    rest = rows[:, REACH:-REACH] - np.median(pairs, axis=0)
    views = np.lib.stride_tricks.sliding_window_view(rest, BENT, axis=1)
    near = np.clip(np.arange(rest.shape[1]) - BENT // 2, 0, rest.shape[1] - BENT)
    return np.asarray(rest - np.median(views, axis=2)[:, near])
