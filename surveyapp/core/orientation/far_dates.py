"""What a line far in time from the determinations must know: if the instrument drifts, +- X."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surveyapp.core.orientation.circumstances import Circumstances
from surveyapp.core.orientation.prediction_notes import Wanted, far_in_time
from surveyapp.core.prediction.drifting import drift_share, half_width_about, if_it_drifts
from surveyapp.core.statistics.repeated import SHARED
from surveyapp.core.uncertain import Uncertain
from surveyapp.domain.priors import Priors
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC
from surveyapp_models.arrays import Floats


def if_drifting(
    wanted: Sequence[Wanted],
    known: Sequence[Circumstances],
    lines: Sequence[Uncertain],
    *,
    values: Floats,
    sigmas: Floats | None,
    priors: Priors,
) -> tuple[float | None, ...]:
    """Half-width of the 95 % interval of each line's constant if the instrument drifts [rad].

    Parameters
    ----------
    wanted : sequence of Wanted
    known : sequence of Circumstances
        Of the determinations.
    lines : sequence of Uncertain
        The predicted constants.
    values, sigmas : ndarray, shape (n,)
        Determinations and stated standard deviations [rad].
    priors : Priors

    Returns
    -------
    tuple of (float or None)
        None where determinations are not farther from the line in time than from each other, and
        where the drift was named and taken out.
    """
    far = [far_in_time(line, known) for line in wanted]
    if drift_share(priors) <= 0.0 or all(item is None for item in far):
        return (None,) * len(wanted)
    days = np.array([item.number("elapsed_days") for item in known], dtype=np.float64)
    later = np.array([_day(line) for line in wanted])
    found = if_it_drifts(values, sigmas, days, later, priors=priors)
    return tuple(
        None if item is None else half_width_about(at, value.value, value.only(*SHARED).variance)
        for item, at, value in zip(far, found, lines, strict=True)
    )


def _day(line: Wanted) -> float:
    """When a line was observed, weighted; of no use where it does not tell."""
    days = [(w, visit.number("elapsed_days")) for w, visit in line.visits]
    told = [(w, day) for w, day in days if day is not None]
    total = sum(w for w, _ in told)
    return sum(w * day for w, day in told) / total if total > 0.0 else 0.0


def drift_notes(
    instrument: str,
    wanted: Sequence[Wanted],
    lines: Sequence[Uncertain],
    drifting: Sequence[float | None],
    *,
    priors: Priors,
) -> list[ResultWarning]:
    """Tell what the constant of a line may be if its instrument drifts."""
    found = []
    for line, value, half in zip(wanted, lines, drifting, strict=True):
        if half is None or half <= value.interval95:
            continue
        text = said(
            "line {line}: far in time from the determinations of {instrument}. One instrument in "
            '{odds} drifts; if it does, its constant here is {value:.1f}" +- {half:.0f}" (95 %) '
            'instead of +- {interval95:.1f}". A determination near this date would tell',
            line=line.line,
            instrument=instrument,
            odds=round(1.0 / drift_share(priors)),
            value=value.value * RHO_ARCSEC,
            half=half * RHO_ARCSEC,
            interval95=value.interval95 * RHO_ARCSEC,
        )
        subject = Subject.line(line.line.station, line.line.target, instrument)
        found.append(ResultWarning("if_it_drifts", text, subject))
    return found
