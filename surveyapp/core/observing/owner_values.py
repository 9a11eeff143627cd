"""What only the owner of a suspended gyro can know: its period, scale value and torsion ratio.

A maker's card states them seldom, and those of another instrument are worth nothing. They are asked
for when the instrument is added, and told at the step of the observation that needs them.
"""

from __future__ import annotations

from enum import StrEnum

from surveyapp.core.observing.steps import Step
from surveyapp.core.swing.card_physics import card_at
from surveyapp.core.swing.tape_zero import tape_zero_coefficient
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import Method


class OwnerValue(StrEnum):
    """A value that the owner determines; the value is its word."""

    PERIOD = "period"
    SCALE = "scale value"
    TORSION = "torsion ratio"


def missing_values(card: InstrumentCard) -> tuple[OwnerValue, ...]:
    """Values of a suspended gyro that its card does not state; none of other instruments."""
    if card.kind != "suspended":
        return ()
    here = card_at(card, None)
    absent = {
        OwnerValue.PERIOD: here.tracking_s is None,
        OwnerValue.SCALE: card.scale_value is None,
        OwnerValue.TORSION: here.torsion_ratio is None,
    }
    return tuple(value for value, missing in absent.items() if missing)


def missing_at(card: InstrumentCard, method: Method, step: Step) -> tuple[OwnerValue, ...]:
    """Missing values without which a step of the observation cannot be used, or not be checked.

    Parameters
    ----------
    card : InstrumentCard
        With what the project overrides.
    method : {"tracking", "amplitude", "transit", "automatic"}
    step : Step

    Returns
    -------
    tuple of OwnerValue
        The tape zero needs scale value and torsion ratio, or the card's correction per division; so
        does a clamped swing, a transit without a transit constant too; tracked turning points are
        checked by the period.
    """
    absent = missing_values(card)
    middle = tuple(value for value in absent if value is not OwnerValue.PERIOD)
    if step in (Step.ZERO_BEFORE, Step.ZERO_AFTER):
        return middle if tape_zero_coefficient(card, None) is None else ()
    if step is not Step.SWING:
        return ()
    if method == "tracking":
        return tuple(value for value in absent if value is OwnerValue.PERIOD)
    if method == "transit" and (card.transit_c is not None or card_at(card, None).transit_c):
        return ()
    return middle
