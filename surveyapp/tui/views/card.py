"""What is known of an instrument, in a line."""

from __future__ import annotations

from surveyapp.core.observing.owner_values import missing_values
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.report.numbers import plain, seconds
from surveyapp.tui import texts
from surveyapp_models.angles import AngleUnit, format_angle


def card_known(card: InstrumentCard) -> str:
    """The values of a card that a surveyor asks for first."""
    parts = []
    if card.sigma.reversal is not None:
        parts.append(texts.CARD_SIGMA.format(value=seconds(card.sigma.reversal, 1)))
    if card.sigma.azimuth is not None:
        parts.append(texts.CARD_AZIMUTH.format(value=seconds(card.sigma.azimuth, 1)))
    periods = card.periods
    if periods is not None and periods.tracking_s is not None:
        latitude = format_angle(periods.latitude, AngleUnit.DEG, 0).split(".")[0]
        value = plain(periods.tracking_s)
        parts.append(texts.CARD_PERIOD.format(value=value, latitude=latitude))
    if card.scale_value is not None:
        parts.append(texts.CARD_SCALE.format(value=seconds(card.scale_value, 1)))
    known = ", ".join(parts) if parts else texts.CARD_NOTHING
    return texts.CARD_KNOWN.format(title=card.title, known=known)


def owner_values(card: InstrumentCard) -> str:
    """What the owner must enter of it, and what does not work without; empty where nothing."""
    absent = missing_values(card)
    if not absent:
        return ""
    without = dict.fromkeys(texts.CARD_WITHOUT[value] for value in absent)
    return texts.CARD_OWNER.format(values=", ".join(absent), without=" and ".join(without))
