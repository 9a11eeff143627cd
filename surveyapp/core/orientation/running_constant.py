"""The running constant: the mean of the last determinations before and the first after a survey.

Source: VSN 160-69 and Russian practice, as cited in the issue: the instrument's correction is the
mean of the five determinations nearest in time on either side.
"""

from __future__ import annotations

from surveyapp.core.orientation.instrument_constant import (
    Calibration,
    InstrumentConstant,
    with_disagreement,
)
from surveyapp.core.statistics.repeated import weighted_mean
from surveyapp.core.uncertain import Uncertain


def running_constant(constant: InstrumentConstant, count: int, *, block: int) -> Uncertain | None:
    """Mean of the nearest determinations before and after a survey session.

    Parameters
    ----------
    constant : InstrumentConstant
    count : int
        How many on either side.
    block : int
        Number of survey sessions before this one.
    """
    if not constant.calibrations:
        return None
    ordered = sorted(constant.calibrations, key=_place)
    before = [item.value for item in ordered if item.block <= block][-count:]
    after = [item.value for item in ordered if item.block > block][:count]
    mean = weighted_mean([*before, *after])
    lines, epochs = constant.line_agreement, constant.phase_agreement
    return with_disagreement(mean, constant.instrument.id, lines, epochs)


def _place(item: Calibration) -> tuple[int, float]:
    return item.block, item.moment if item.moment is not None else 0.0
