"""Whether a clamped swing breaks the model: readings of the scale, and timed passages with them.

The same search as for a tracked run: every trouble at every place, the largest judged against its
own null distribution. Source: physics.md section 4 (signatures in the two channels).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surveyapp.core.observing.run_alert import Alert, Candidates, Trouble, find_trouble, search
from surveyapp.core.swing.clamped import NumberedRows
from surveyapp.core.swing.gyrofit import DampedFit
from surveyapp.core.swing.swingfit import ClampedFit, ClampedSwing, estimate_period, fit_clamped
from surveyapp.domain.readings import Reading
from surveyapp_models.arrays import Floats

MIN_OBSERVATIONS = 8
"""Five unknowns and one more leave two degrees of freedom."""


def alert_of_readings(
    rows: NumberedRows, swing: ClampedSwing, fit: DampedFit | None, rng: np.random.Generator
) -> Alert | None:
    """Alarm of the turning points on the scale alone."""
    if fit is None:
        return None
    found = find_trouble(fit, swing.index, swing.sides, sigma=swing.sigma_div)
    if found is None:
        return None
    trouble, place, p, share = found
    return Alert(trouble, rows.readings[place][1].seq, int(swing.index[place]), p, share)


def alert_of_swing(
    rows: NumberedRows,
    timed: Sequence[Reading],
    swing: ClampedSwing,
    rng: np.random.Generator,
    *,
    period: float | None,
) -> Alert | None:
    """Alarm of readings and passages together, None where they are too few to tell.

    Parameters
    ----------
    rows : NumberedRows
    timed : sequence of Reading
        The passages that have a moment.
    swing : ClampedSwing
        Of all readings and these passages.
    rng : numpy.random.Generator
    period : float or None
        First guess [s] where the passages tell none.
    """
    guess = estimate_period(swing) or period
    if swing.count < MIN_OBSERVATIONS or swing.readings.size < 2 or guess is None:
        return None
    if np.unique(swing.sides).size < 2 or swing.passages_s.size < 2:
        return None
    fit = fit_clamped(swing, period_s=guess)
    if not fit.converged:
        return None
    whitened = np.concatenate(
        [fit.reading_residuals / swing.sigma_div, fit.passage_residuals / swing.sigma_s]
    )
    found = search(whitened, fit.jacobian, _candidates(swing, fit), sigma=1.0)
    if found is None:
        return None
    trouble, place, p, share = found
    passage = place - swing.readings.size
    if passage >= 0 and trouble is Trouble.MISTIMED:
        return Alert(trouble, timed[passage].seq, passage, p, share)
    row = rows.readings[place][1]
    return Alert(trouble, row.seq, int(swing.index[place]), p, share)


def _candidates(swing: ClampedSwing, fit: ClampedFit) -> Candidates:
    """One reading, one passage, two middles, two decays; places count readings, then passages."""
    count = swing.readings.size
    position = np.concatenate([swing.index, swing.after + 0.5])
    columns: list[Floats] = []
    names: list[tuple[Trouble, int]] = []
    for place in range(swing.count):
        unit = np.zeros(swing.count)
        unit[place] = 1.0
        columns.append(unit)
        names.append((Trouble.GROSS_ERROR if place < count else Trouble.MISTIMED, place))
    for place in range(1, count - 1):
        behind = position >= swing.index[place]
        columns.append(fit.jacobian[:, 0] * behind)
        names.append((Trouble.STEP, place))
        lost = np.maximum(position - swing.index[place - 1], 0.0)
        columns.append(fit.jacobian[:, 1] * lost)
        names.append((Trouble.DAMPING, place))
    return np.column_stack(columns), names
