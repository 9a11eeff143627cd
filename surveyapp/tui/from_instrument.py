"""A reading of the instrument on the cable as a text of the entry line, and its mark in the book.

The surveyor confirms it by Enter like a typed one; a text that was changed is typed, not read.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from surveyapp.core.observing.steps import Expected
from surveyapp.domain.instrument_reading import FollowedTurn, InstrumentReading
from surveyapp.domain.readings import QUANTITY, Dimension, ReadingKind
from surveyapp.observation.session import NewRow
from surveyapp.tui import texts
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle


@dataclass(frozen=True, slots=True)
class Taken:
    """What the instrument put into the line, and what the book says about it."""

    text: str = ""
    note: str = ""


def taken(reading: InstrumentReading, what: Expected, unit: AngleUnit) -> tuple[Taken, str]:
    """Text for the line and what is told; an empty text where nothing of it is asked for.

    Parameters
    ----------
    reading : InstrumentReading
    what : Expected
        What is asked for.
    unit : AngleUnit
        Of the project.
    """
    if QUANTITY[what.kind] is not Dimension.ANGLE:
        return Taken(), texts.INSTRUMENT_NO_ANGLE
    if what.face is not None and reading.face and reading.face != str(what.face):
        told = texts.INSTRUMENT_FACE.format(read=reading.face, asked=what.face)
        return Taken(), told
    value = reading.v if what.kind is ReadingKind.ZENITH else reading.hz
    if value is None:
        return Taken(), texts.INSTRUMENT_NO_ZENITH
    zenith = "-" if reading.v is None else format_angle(reading.v, unit)
    length = "-" if reading.slope_distance is None else f"{reading.slope_distance:.4f} m"
    told = texts.INSTRUMENT_READ.format(
        source=reading.source, hz=format_angle(reading.hz, unit), v=zenith, length=length
    )
    note = f"read by the instrument, {reading.source}"
    return Taken(format_angle(value, unit), note), told


def taken_turn(turn: FollowedTurn, source: str, unit: AngleUnit) -> tuple[Taken, str]:
    """Text for the line and what is told of a turning point that was followed."""
    sigma = turn.sigma * RHO_ARCSEC
    told = texts.INSTRUMENT_TURN.format(readings=turn.readings, sigma=sigma)
    note = (
        f"read by the instrument, {source}: parabola of {turn.readings} readings, "
        f"sigma {sigma:.2f} arcsec"
    )
    return Taken(format_angle(turn.value, unit), note), told


def marked(row: NewRow, text: str, source: Taken) -> NewRow:
    """The row with the mark of the instrument, if its text is the one that was read."""
    if not source.text or text.strip() != source.text:
        return row
    return replace(row, note="; ".join(filter(None, (row.note, source.note))))
