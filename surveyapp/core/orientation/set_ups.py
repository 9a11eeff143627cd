"""Determinations on several lines from one set-up are one determination.

The gyro found north once: its error is in every line that was sighted, and two sights do not know
more of the constant than one. They enter a campaign as their weighted mean, with what they share
counted once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from surveyapp.core.orientation.campaign_columns import LABELLED
from surveyapp.core.orientation.circumstances import Circumstances
from surveyapp.core.orientation.instrument_constant import Calibration
from surveyapp.core.statistics.repeated import weighted_mean
from surveyapp.core.uncertain import aligned

Facts = Mapping[tuple[str, str], Circumstances]


def one_a_set_up(
    calibrations: Sequence[Calibration], facts: Facts
) -> list[tuple[Calibration, Circumstances]]:
    """The determinations of each set-up as one, with its circumstances.

    Parameters
    ----------
    calibrations : sequence of Calibration
    facts : mapping of (session, target) to Circumstances

    Returns
    -------
    list
        In the order of the first target of each session. What differs between its targets (the
        circle reading) is not told of a set-up with several; its line is all of them together.
    """
    sessions: dict[str, list[Calibration]] = {}
    for item in calibrations:
        sessions.setdefault(item.session, []).append(item)
    return [_joined(own, facts) for own in sessions.values()]


def _joined(own: Sequence[Calibration], facts: Facts) -> tuple[Calibration, Circumstances]:
    told = [facts[item.session, item.target] for item in own]
    if len(own) == 1:
        return own[0], told[0]
    return replace(own[0], value=weighted_mean(aligned([i.value for i in own]))), _common(told)


def _common(told: Sequence[Circumstances]) -> Circumstances:
    """What all targets of a set-up have in common."""
    columns = dict(told[0].told)
    for name in told[0].told:
        values = [item.told.get(name) for item in told]
        if all(value == values[0] for value in values):
            continue
        if name in LABELLED:
            columns[name] = " + ".join(sorted(str(value) for value in values))
        else:
            del columns[name]
    return Circumstances(told[0].order, columns)
