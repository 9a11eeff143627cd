"""What tilt log and compass of a session said: levelling of the line, aiming before the run."""

from __future__ import annotations

import math
from typing import Final

from surveyapp.domain.session_result import SessionResult
from surveyapp.domain.session_sensors import LogLevelling, PreOrientation
from surveyapp.languages import joined, said, said_each
from surveyapp.report.blocks import Block, Table
from surveyapp.report.numbers import NOTHING, direction, plain, seconds
from surveyapp_models.angles import AngleUnit

ENOUGH_ARCMIN: Final = {"tracking": 60.0, "transit": 10.0}
"""How near to north a method asks the alidade before the run (coal-mine surveying regulation)."""

Row = tuple[str, str, str, str]


def blocks(item: SessionResult, unit: AngleUnit) -> tuple[Block, ...]:
    """Levelling and pre-orientation of a session; none where it has neither.

    Parameters
    ----------
    item : SessionResult
    unit : AngleUnit
        Of the project.
    """
    rows = levelling_rows(item) + pre_orientation_rows(item.pre_orientation, unit)
    if not rows:
        return ()
    head = said_each("levelling and pre-orientation", "value", "±", "where it comes from")
    return (Table(head, tuple(rows), "lrrl"),)


def levelling_rows(item: SessionResult) -> list[Row]:
    """Tilt of the vertical axis as the log told it, and what it moved in each sight."""
    rows = [] if item.levelling is None else _log_rows(item.levelling)
    for target in item.targets:
        if target.levelling_correction is not None:
            name = said("levelling of the sights of {target}", target=target.target)
            value = f'{seconds(target.levelling_correction, sign=True)}"'
            rows.append((name, value, "", said("inside the line reading")))
    return rows


def _log_rows(log: LogLevelling) -> list[Row]:
    source = said("tilt log {log}, card {card}", log=log.log, card=log.card)
    if log.run is None:
        why = joined("; ", log.refusals) or said("no sample during the run")
        return [(said("tilt during the run"), NOTHING, "", joined(": ", (source, why)))]
    sigma = seconds(log.run.sigma)
    return [
        (said("tilt along the sight"), f'{seconds(log.run.along, sign=True)}"', sigma, source),
        (
            said("tilt across the sight"),
            f'{seconds(log.run.across, sign=True)}"',
            sigma,
            said("{count} samples", count=log.run.samples),
        ),
    ]


def pre_orientation_rows(aimed: PreOrientation | None, unit: AngleUnit) -> list[Row]:
    """Where the alidade pointed by the compass, how sure that is, and where to turn it."""
    if aimed is None:
        return []
    source = said("compass log {log}, card {card}", log=aimed.log, card=aimed.card)
    if aimed.heading is None:
        why = joined("; ", aimed.refusals)
        return [(said("magnetic heading of the alidade"), NOTHING, "", joined(": ", (source, why)))]
    rows = [
        (said("magnetic heading of the alidade"), direction(aimed.heading, unit), "", source),
        (
            said("declination, east positive"),
            _minutes(aimed.declination),
            _minutes(aimed.declination_sigma, sign=False),
            said("stated") if aimed.declination is not None else said("not stated"),
        ),
    ]
    if aimed.offset is None:
        return rows
    rows.append(
        (
            said("alidade from north"),
            _minutes(aimed.offset),
            _minutes(aimed.sigma, sign=False),
            _enough(aimed),
        )
    )
    rows.append((said("turn the alidade by"), _minutes(-aimed.offset), "", ""))
    if aimed.turn_to is not None:
        rows.append((said("to the circle reading"), direction(aimed.turn_to, unit), "", ""))
    return rows


def _minutes(angle: float | None, *, sign: bool = True) -> str:
    """An angle [rad] in arc-minutes."""
    return NOTHING if angle is None else f"{plain(math.degrees(angle) * 60.0, 1, sign=sign)}'"


def _enough(aimed: PreOrientation) -> str:
    """Offset and its 95 % interval together against what each method asks."""
    if aimed.offset is None or aimed.interval95 is None:
        return ""
    worst = math.degrees(abs(aimed.offset) + aimed.interval95) * 60.0
    words = [
        said("within {limit:g}' ({method})", limit=limit, method=method)
        if worst <= limit
        else said("not within {limit:g}' ({method})", limit=limit, method=method)
        for method, limit in ENOUGH_ARCMIN.items()
    ]
    return said("with its 95 % interval {worst:.1f}': ", worst=worst) + ", ".join(words)
