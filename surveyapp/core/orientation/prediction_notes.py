"""The lines whose constant is wanted, and what the reader of a predicted constant must know."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from surveyapp.core.orientation.circumstances import Circumstances
from surveyapp.core.orientation.instrument_constant import InstrumentConstant
from surveyapp.core.uncertain import Uncertain
from surveyapp.domain.station_line import StationLine
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import counted, joined, listed, said
from surveyapp_models.angles import RHO_ARCSEC

ONE_TEMPERATURE_K = 3.0
"""Beyond the range of the determinations, from which an extrapolation is told."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """A line whose constant is wanted: sessions with their weights.

    Parameters
    ----------
    line : StationLine
    visits : tuple of (float, Circumstances)
        Weight (sum 1) and circumstances of each session.
    """

    line: StationLine
    visits: tuple[tuple[float, Circumstances], ...]


def told_of(
    instrument: str,
    wanted: Sequence[Wanted],
    known: Sequence[Circumstances],
    gaps: frozenset[str],
) -> list[ResultWarning]:
    """What the reader of a predicted constant must know."""
    warnings = []
    time = counted_in(known)
    for line in wanted:
        subject = Subject.line(line.line.station, line.line.target, instrument)
        missing = sorted(
            name for name in gaps if any(_lacks(visit, name, time) for _, visit in line.visits)
        )
        if missing:
            text = said(
                "line {line}: {missing} not told: the constant is predicted for all that "
                "it may have been, and its interval is wider for it",
                line=line.line,
                missing=joined(", ", missing),
            )
            warnings.append(ResultWarning("covariate_missing", text, subject))
        beyond = _beyond(line, known)
        if beyond:
            text = said(
                "line {line}: {beyond}: the constant of {instrument} is extrapolated, and "
                "its interval is wider for it",
                line=line.line,
                beyond=listed(beyond),
                instrument=instrument,
            )
            warnings.append(ResultWarning("prediction_extrapolated", text, subject))
    return warnings


def one_block(instrument: str, known: Sequence[Circumstances], wanted: bool) -> list[ResultWarning]:
    """Tell that all determinations belong together."""
    blocks = {item.name("block") for item in known}
    one = len(blocks) == 1 and known[0].number("elapsed_days") is not None
    if not one or not wanted:
        return []
    text = said(
        "instrument {instrument}: all determinations were made in one block of "
        "work: what changes from day to day is not seen in them",
        instrument=instrument,
    )
    return [ResultWarning("one_block", text)]


def too_few(constant: InstrumentConstant) -> list[ResultWarning]:
    """Tell that a constant rests on too few determinations to show what changes it.

    Nothing is told where it rests on something else: a constant known beforehand, what the archive
    of the instrument has taught; and where the prediction that was asked for tells it already.
    """
    instrument, count = constant.instrument, len(constant.calibrations)
    choice = instrument.constant_choice
    archived = instrument.priors is not None and instrument.priors.scatter
    if not count or archived or (choice is not None and choice.kind in ("known", "predicted")):
        return []
    text = counted(
        "instrument {id}: its constant rests on {count} determination and its stated sigma; what "
        "changes it between then and the line (transport, temperature, time) is not in the "
        "interval: four determinations or more show it",
        "instrument {id}: its constant rests on {count} determinations and their stated sigmas; "
        "what changes it between them and the line (transport, temperature, time) is not in the "
        "interval: four determinations or more show it",
        count=count,
        id=instrument.id,
    )
    return [ResultWarning("few_determinations", text, Subject.of("instrument", instrument.id))]


def counted_in(known: Sequence[Circumstances]) -> Literal["days", "order"]:
    """What the time of a prediction counts: days where every determination has one.

    The lines have no say in it: one of them without a date must not take the days from the others.
    """
    dated = all(item.number("elapsed_days") is not None for item in known)
    return "days" if dated else "order"


def _lacks(visit: Circumstances, name: str, time: str) -> bool:
    if name == "elapsed_days" and time == "order":
        return visit.order is None
    return name not in visit.told


def _beyond(line: Wanted, known: Sequence[Circumstances]) -> list[str]:
    """In what a line lies outside the circumstances of the determinations."""
    found = []
    visited = [visit for _, visit in line.visits]
    thetas, own = _told(known, "temperature_c"), _told(visited, "temperature_c")
    if thetas and own:
        low, high = min(thetas) - ONE_TEMPERATURE_K, max(thetas) + ONE_TEMPERATURE_K
        far = max(own, key=lambda theta: max(low - theta, theta - high))
        if not low <= far <= high:
            found.append(
                said(
                    "its temperature of {far:.1f} C lies outside the {thetas:.1f} to "
                    "{thetas2:.1f} C of the determinations",
                    far=far,
                    thetas=min(thetas),
                    thetas2=max(thetas),
                )
            )
    away = far_in_time(line, known)
    if away is not None:
        found.append(
            said(
                "it was observed {gap:.0f} days from the nearest determination, and they "
                "span {span:.0f} days",
                gap=away[0],
                span=away[1],
            )
        )
    return found


def far_in_time(line: Wanted, known: Sequence[Circumstances]) -> tuple[float, float] | None:
    """Days from the nearest determination and days that they span, where the first is longer."""
    visited = [visit for _, visit in line.visits]
    days, visits = _told(known, "elapsed_days"), _told(visited, "elapsed_days")
    if len(days) != len(known) or not visits:
        return None
    span = max(days) - min(days)
    gap = max(max(visits) - max(days), min(days) - min(visits))
    return (gap, span) if gap > max(span, 1.0) else None


def _told(items: Sequence[Circumstances], column: str) -> list[float]:
    return [value for item in items if (value := item.number(column)) is not None]


def leaves_out(choice: str, chosen: Uncertain, predicted: Uncertain, where: str) -> ResultWarning:
    """What another choice of the constant leaves out, beside the prediction."""
    text = said(
        "{where}: constant_choice {choice} leaves out that the constant may have "
        'changed with time, temperature or place: it says {value:.1f}" +- '
        '{interval95:.1f}", the average over what may be at work {value2:.1f}" +- '
        '{interval952:.1f}" (95 %)',
        where=where,
        choice=choice,
        value=chosen.value * RHO_ARCSEC,
        interval95=chosen.interval95 * RHO_ARCSEC,
        value2=predicted.value * RHO_ARCSEC,
        interval952=predicted.interval95 * RHO_ARCSEC,
    )
    return ResultWarning("choice_leaves_out", text)
