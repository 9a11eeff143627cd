"""What is to be asked about a typed reading before it is written: each kind by its own rule.

The rules stand in ``surveyapp.core.observing.doubts``; here stands what of the book each is told.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from surveyapp.core.observing.doubts import (
    Question,
    doubt_clamp,
    doubt_passage,
    doubt_round,
    doubt_scale,
    doubt_scale_point,
    doubt_sight,
    doubt_turning_point,
    doubt_zenith,
)
from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.range_doubts import (
    doubt_half_swing,
    doubt_level,
    doubt_moment,
    doubt_supply,
    doubt_temperature,
    doubt_zenith_range,
)
from surveyapp.core.observing.retyped import Placed, seconds_between
from surveyapp.core.observing.steps import Expected
from surveyapp.core.observing.zero_forecast import forecast_zero
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.readings import Reading, ReadingKind
from surveyapp.io.fieldbook.clock import Stamp
from surveyapp.observation.session import SessionDesk
from surveyapp_models.angles import ARCSEC, wrap_two_pi

TURNING: Final = (ReadingKind.REVERSAL, ReadingKind.SCALE_REVERSAL)
STAMP_STEP_S: Final = 0.001
"""Elapsed seconds stand in the book to the millisecond."""
ROUNDS: Final = (ReadingKind.AZIMUTH, ReadingKind.NORTH)


@dataclass(frozen=True, slots=True)
class Typed:
    """A reading as it would be written.

    Parameters
    ----------
    value : float
        [rad], on the scale [div], or in ``unit``.
    unit : str
    stamp : Stamp or None
        None where it is written without a moment.
    placed : Placed or None
        Of a turning point or passage: where in the swing it would stand.
    """

    value: float
    unit: str = ""
    stamp: Stamp | None = None
    placed: Placed | None = None


def questions_about(
    observation: SessionDesk, typed: Typed, what: Expected, progress: Progress | None
) -> tuple[Question, ...]:
    """Doubts about a reading and its moment.

    Parameters
    ----------
    observation : SessionDesk
    typed : Typed
    what : Expected
    progress : Progress or None
        As computed last; used where it is of the book as it stands.
    """
    return (
        *_about_value(observation, typed, what, progress),
        *_about_moment(observation, typed, what.kind),
    )


def _about_value(
    observation: SessionDesk, typed: Typed, what: Expected, progress: Progress | None
) -> tuple[Question, ...]:
    kind, value = what.kind, typed.value
    if kind in TURNING:
        if typed.placed is not None and typed.placed.struck is not None:
            return ()  # what it says was judged when its side gave it the struck one's place
        return _about_point(observation, value, what, progress)
    if what.face is not None:
        return _about_sight(observation, value, what)
    valid = _card(observation).valid
    if kind is ReadingKind.TEMPERATURE:
        return doubt_temperature(value, valid)
    if kind in (ReadingKind.LEVEL_ALONG, ReadingKind.LEVEL_ACROSS):
        return doubt_level(value * ARCSEC, valid)
    rows = [row for row in observation.rows(what.step) if row.kind is kind]
    if kind is ReadingKind.TAPE_ZERO:
        return _about_zero(value, rows, _card(observation))
    if kind is ReadingKind.SUPPLY:
        same = [row for row in rows if row.unit == typed.unit]
        return doubt_supply(value, typed.unit, _values(same), valid)
    earlier = _values(rows)
    if kind is ReadingKind.CLAMP:
        return doubt_clamp(value, earlier)
    if kind in ROUNDS:
        return doubt_round(value, earlier, card_sigma=_card(observation).sigma.azimuth)
    return doubt_passage(value, earlier) if kind is ReadingKind.TRANSIT else ()


def _about_moment(
    observation: SessionDesk, typed: Typed, kind: ReadingKind
) -> tuple[Question, ...]:
    """Doubt a moment before the last row; of a turning point, one that no half swing explains."""
    if typed.stamp is None:
        return ()
    placed = typed.placed
    if kind not in TURNING or placed is None:
        if kind is ReadingKind.TRANSIT:
            return ()  # their order and their moments are judged by the forecast of the passages
        latest = observation.latest_elapsed_s()
        return () if latest is None else doubt_moment(latest - typed.stamp.elapsed_s - STAMP_STEP_S)
    if placed.before is None:
        return ()
    new = replace(placed.before, time=typed.stamp.time, elapsed_s=round(typed.stamp.elapsed_s, 3))
    apart = seconds_between(placed.before, new)
    if apart is None or apart <= 0.0:
        return ()  # refused in words when it is written
    return doubt_half_swing(apart, placed.turns, half_swing_s=observation.half_swing_s())


def _card(observation: SessionDesk) -> InstrumentCard:
    return observation.project.instrument(observation.session.instrument).card


def _values(rows: Sequence[Reading]) -> list[float]:
    return [row.value for row in rows if row.value is not None]


def _about_sight(observation: SessionDesk, value: float, what: Expected) -> tuple[Question, ...]:
    here = set(observation.rows(what.step))
    assert what.face is not None
    if what.kind is ReadingKind.ZENITH:
        sights = sights_of(observation, what.target, ReadingKind.ZENITH)
        apart = doubt_zenith(value, what.face, [row for row in sights if row in here])
        return apart or doubt_zenith_range(value, what.face, _card(observation).valid)
    sights = sights_of(observation, what.target)
    return doubt_sight(
        value,
        what.face,
        series=[row for row in sights if row in here],
        earlier=[row for row in sights if row not in here],
    )


def _about_zero(
    value: float, rows: Sequence[Reading], card: InstrumentCard
) -> tuple[Question, ...]:
    off = doubt_scale(value, _values(rows))
    found = forecast_zero(rows, card_sigma=card.sigma.scale_div)
    if off or found is None:
        return off
    return doubt_scale_point(
        value,
        middle=found.middle,
        predicted=found.reading,
        half_width=found.half_width,
        side=found.side,
    )


def _about_point(
    observation: SessionDesk, value: float, what: Expected, progress: Progress | None
) -> tuple[Question, ...]:
    rows = list(observation.book.of_kind(what.kind))
    scale = what.kind is ReadingKind.SCALE_REVERSAL
    off = doubt_scale(value, _values(rows)) if scale else ()
    progress = of_this_book(progress, rows)
    if off or progress is None or progress.next is None:
        return off
    middle = progress.middle
    if not scale and middle is not None:
        middle = wrap_two_pi(progress.origin + middle)
    rule = doubt_scale_point if scale else doubt_turning_point
    return rule(
        value,
        middle=middle,
        predicted=progress.next_reading,
        half_width=progress.next.half_width,
        side=what.side,
    )


def of_this_book(progress: Progress | None, points: list[Reading]) -> Progress | None:
    """The judgement if it is of the turning points that stand in the book now, else None.

    It is computed beside the typing: for a moment after each reading it is one reading old.
    """
    if progress is None:
        return None
    judged = [(point.seq, point.reading) for point in progress.points]
    return progress if judged == [(row.seq, row.value) for row in points] else None


def sights_of(
    observation: SessionDesk, target: str, kind: ReadingKind = ReadingKind.BACKSIGHT
) -> tuple[Reading, ...]:
    """Live sights of one target, in the order of the book."""
    own = observation.session.target or ""
    rows = observation.book.of_kind(kind)
    return tuple(row for row in rows if (row.target or own) == (target or own))
