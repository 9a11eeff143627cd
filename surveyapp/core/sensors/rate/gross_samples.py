"""Samples of steady turning that no noise makes: told, and left in the means.

A few samples move the mean of a position little and its sigma much. What to do about them is said
by ``diagnose``, which names the position.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surveyapp.core.sensors.rate.table_log import Turned
from surveyapp.core.sensors.rate.turning import about_turns
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

FAR_SIGMAS = 8.0
"""Standard deviations beyond which no sample of normal noise lies: one in 1e15."""
MOST_SHARE = 0.03
"""Of a stretch; more are no errors of single samples but another distribution."""
STEPS = 3.0
"""Steps of a rounded output within which a sample is no error."""


def gross_samples(
    log: SensorLog, turned: Sequence[Turned], columns: Sequence[str]
) -> list[ResultWarning]:
    """How many samples of which gyros lie far off, as a warning, or nothing.

    Parameters
    ----------
    log : SensorLog
    turned : sequence of Turned
        What is used.
    columns : sequence of str
        Of the gyros.
    """
    counts = {c: sum(_far(t, log.columns[c]) for t in turned) for c in columns}
    found = {c: count for c, count in counts.items() if count}
    if not found:
        return []
    text = said(
        "samples more than {sigmas:g} standard deviations off: {names}; they are in the means and "
        "in the sigmas, and `surveyapp diagnose` says whether a position suffers",
        sigmas=FAR_SIGMAS,
        names=", ".join(f"{column} {count}" for column, count in found.items()),
    )
    return [ResultWarning("gross_samples", text)]


def _far(turned: Turned, values: Floats) -> int:
    """Number of samples of a stretch far off its mean and what comes round."""
    rest = about_turns(turned.stretch, values)
    size = np.abs(rest - np.median(rest))
    far = size > FAR_SIGMAS * 1.4826 * float(np.median(size))
    if not 0 < int(far.sum()) <= MOST_SHARE * rest.size:
        return 0
    levels = np.unique(values[turned.stretch.start : turned.stretch.stop][~far])
    step = float(np.median(np.diff(levels))) if levels.size > 1 else float(size[far].max())
    return int((size[far] > STEPS * step).sum())
